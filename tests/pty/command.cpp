#include "command.hpp"

#include <fcntl.h>
#include <grp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>

namespace cargobay::test {
namespace {

constexpr std::chrono::seconds kPatience{30};
constexpr uid_t kNobody = 65534;  // the same number everywhere, and no /etc/passwd needed
constexpr int kNotStarted = 125;

struct Ends {
  int ours = -1;
  int theirs = -1;
};

Ends make_pipe() {
  std::array<int, 2> ends{-1, -1};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return {};
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  return {.ours = ends[0], .theirs = ends[1]};
}

Ends make_terminal() {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  std::array<char, 64> path{};
  if (master < 0 || grantpt(master) != 0 || unlockpt(master) != 0 ||
      ptsname_r(master, path.data(), path.size()) != 0) {
    return {};
  }
  const int slave = open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  struct termios settings{};
  tcgetattr(slave, &settings);
  settings.c_oflag &= ~static_cast<tcflag_t>(OPOST);  // no \r that the command did not print
  settings.c_lflag &= ~static_cast<tcflag_t>(ECHO);
  tcsetattr(slave, TCSANOW, &settings);
  return {.ours = master, .theirs = slave};
}

Ends make_output(Command::Setup::Output output) {
  using Output = Command::Setup::Output;
  if (output == Output::terminal) return make_terminal();
  if (output == Output::full) return {.theirs = open("/dev/full", O_WRONLY | O_CLOEXEC)};
  return make_pipe();
}

// Between fork and exec: nothing here allocates or locks.
bool give_up_rights() {
  const rlimit none{.rlim_cur = 0, .rlim_max = 0};
  if (setrlimit(RLIMIT_RTPRIO, &none) != 0 || setrlimit(RLIMIT_MEMLOCK, &none) != 0) return false;
  if (geteuid() != 0) return true;
  return setgroups(0, nullptr) == 0 && setresgid(kNobody, kNobody, kNobody) == 0 &&
         setresuid(kNobody, kNobody, kNobody) == 0;
}

[[noreturn]] void become(int binary, char** arguments, const Ends& out, const Ends& err,
                         const Command::Setup& setup) {
  using Setup = Command::Setup;
  if (out.theirs < 0 || err.theirs < 0) _exit(kNotStarted);
  sigset_t none{};
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, nullptr);
  setsid();
  if (setup.output == Setup::Output::terminal) {
    ioctl(out.theirs, TIOCSCTTY, 0);
    dup2(out.theirs, STDIN_FILENO);
  }
  dup2(out.theirs, STDOUT_FILENO);
  dup2(err.theirs, STDERR_FILENO);
  for (std::size_t i = 0; i < setup.closed.size(); ++i) {
    if (setup.closed.at(i)) close(static_cast<int>(i));
  }
  if (setup.most_file_bytes > 0) {
    const rlimit most{.rlim_cur = setup.most_file_bytes, .rlim_max = setup.most_file_bytes};
    if (setrlimit(RLIMIT_FSIZE, &most) != 0) _exit(kNotStarted);
  }
  if (setup.user == Setup::User::nobody && !give_up_rights()) _exit(kNotStarted);
  prctl(PR_SET_PDEATHSIG, SIGKILL);     // if the tests are killed, no command is left running
  fexecve(binary, arguments, environ);  // by descriptor: user nobody may not see the folder
  _exit(kNotStarted);
}

void collect(int descriptor, std::string& text) {
  std::array<char, 4096> bytes{};
  while (descriptor >= 0) {
    const ssize_t count = read(descriptor, bytes.data(), bytes.size());
    if (count <= 0) return;
    text.append(bytes.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

Command::Command(std::vector<std::string> arguments, const Setup& setup)
    : unread_{setup.output == Setup::Output::unread} {
  arguments.insert(arguments.begin(), "cargobay");
  std::vector<char*> pointers;
  pointers.reserve(arguments.size() + 1);
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  const int binary = open(CARGOBAY_BINARY_DIR "/cargobay", O_PATH | O_CLOEXEC);
  const Ends out = make_output(setup.output);
  if (unread_) {
    const int bytes = fcntl(out.ours, F_SETPIPE_SZ, 1);  // the kernel makes it a page
    const std::string full(static_cast<std::size_t>(std::max(bytes, 0)), '\n');
    (void)!write(out.theirs, full.data(), full.size());
  }
  const Ends err = make_pipe();
  process_ = fork();  // NOLINT(cppcoreguidelines-prefer-member-initializer): the ends come first
  if (process_ == 0) become(binary, pointers.data(), out, err, setup);
  ended_ = process_ < 0;
  for (const int descriptor : {binary, out.theirs, err.theirs}) close(descriptor);
  out_descriptor_ = out.ours;
  err_descriptor_ = err.ours;
}

Command::~Command() {
  if (!ended_) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  close_terminal();
  close(err_descriptor_);
}

void Command::send(int signal) const {
  if (!ended_) kill(process_, signal);
}

void Command::type(std::string_view keys) const {
  (void)!write(out_descriptor_, keys.data(), keys.size());
}

void Command::close_terminal() {
  if (out_descriptor_ >= 0) close(out_descriptor_);
  out_descriptor_ = -1;
}

bool Command::running() {
  if (!ended_) ended_ = waitpid(process_, &status_, WNOHANG) == process_;
  if (!unread_) collect(out_descriptor_, out_);
  collect(err_descriptor_, err_);
  return !ended_;
}

int Command::exit_code() {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (running()) {
    if (std::chrono::steady_clock::now() > deadline) return kHangs;
    poll(nullptr, 0, 1);
  }
  if (process_ < 0) return kNotStarted;
  return WIFSIGNALED(status_) ? -WTERMSIG(status_) : WEXITSTATUS(status_);
}

}  // namespace cargobay::test
