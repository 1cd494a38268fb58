#include "hal/cli/serve/web_side.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "hal/machine/masked_thread.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr int kReadyDescriptor = 3;  // of the child
constexpr std::chrono::seconds kPatience{10};
constexpr std::chrono::seconds kFarewell{2};
constexpr std::chrono::milliseconds kLookEvery{20};
constexpr std::chrono::seconds kBeforeAgain{1};

std::string program() {
  std::error_code error;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", error);
  return error ? std::string{} : (here.parent_path() / "cargobay-web").string();
}

// The first line that comes; empty if none does in time.
std::string first_line(int descriptor) {
  std::string line;
  const auto until = rt::Clock::now() + kPatience;
  while (line.find('\n') == std::string::npos) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(until - rt::Clock::now());
    pollfd one{.fd = descriptor, .events = POLLIN, .revents = 0};
    const int ready = left.count() > 0 ? poll(&one, 1, static_cast<int>(left.count())) : 0;
    if (ready < 0 && errno == EINTR) continue;
    std::array<char, 512> bytes{};
    const ssize_t count = ready > 0 ? read(descriptor, bytes.data(), bytes.size()) : 0;
    if (count <= 0) return {};
    line.append(bytes.data(), static_cast<std::size_t>(count));
  }
  return line.substr(0, line.find('\n'));
}

// What is between the two in the line, or follows `begin`; empty if `begin` is not there.
std::string between(const std::string& line, std::string_view begin, char end) {
  const std::size_t at = line.find(begin);
  if (at == std::string::npos) return {};
  const std::string rest = line.substr(at + begin.size());
  return rest.substr(0, rest.find(end));
}

std::string in_words(int status) {
  if (WIFSIGNALED(status)) return fmt::format("signal {}", WTERMSIG(status));
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

// None of this process's signals are blocked or ignored in the child.
class SpawnAttributes {
 public:
  SpawnAttributes() {
    posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigset_t all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setflags(
        &attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSCHEDULER);
    posix_spawnattr_setsigmask(&attributes_, &none);
    posix_spawnattr_setsigdefault(&attributes_, &all);
    posix_spawnattr_setschedpolicy(&attributes_, SCHED_OTHER);
    const sched_param ordinary{};
    posix_spawnattr_setschedparam(&attributes_, &ordinary);
  }
  ~SpawnAttributes() { posix_spawnattr_destroy(&attributes_); }
  SpawnAttributes(const SpawnAttributes&) = delete;
  SpawnAttributes& operator=(const SpawnAttributes&) = delete;
  const posix_spawnattr_t* get() const { return &attributes_; }

 private:
  posix_spawnattr_t attributes_{};
};

}  // namespace

bool WebSide::is_installed() { return access(program().c_str(), X_OK) == 0; }

hal::Result<std::unique_ptr<WebSide>> WebSide::start(const WebOptions& options,
                                                     std::function<void(const std::string&)> tell) {
  std::unique_ptr<WebSide> side{new WebSide};
  side->arguments_ = {program(), "--feed", options.socket, "--ready-fd",
                      std::to_string(kReadyDescriptor)};
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) side->arguments_.insert(side->arguments_.end(), {option, value});
  };
  add("--http", options.http);
  add("--token-file", options.token_file);
  add("--cert", options.certificate);
  for (const std::string& name : options.names) add("--name", name);
  for (const std::string& origin : options.origins) add("--origin", origin);
  side->token_ = options.token;
  side->tell_ = std::move(tell);
  if (const auto spawned = side->spawn(); !spawned) return spawned.failure();
  side->ready_line_ = first_line(side->ready_.number());
  if (side->ready_line_.empty()) {
    return hal::Failure{.message =
                            "the web side does not start; its message is above. Without it: "
                            "--no-http"};
  }
  side->keep_address();
  if (const auto error = hal::start_masked(side->watcher_, [it = side.get()] { it->watch(); })) {
    return hal::Failure{.message = "no thread for the web side: " + error.message(), .code = error};
  }
  return side;
}

// Its next life is to be found where this one is, and by who has been let in.
void WebSide::keep_address() {
  const std::string host = between(ready_line_, "://", '/');
  const std::string port = host.substr(host.rfind(':') + 1);
  const auto http = std::ranges::find(arguments_, "--http");
  if (http == arguments_.end()) {
    arguments_.insert(arguments_.end(), {"--http", port});
  } else {
    std::string& address = *(http + 1);
    const std::size_t colon = address.rfind(':');
    address = colon == std::string::npos ? port : address.substr(0, colon + 1) + port;
  }
  if (token_.empty()) token_ = between(ready_line_, "#token=", ' ');
}

hal::Result<void> WebSide::spawn() {
  std::array<int, 2> pipe{-1, -1};
  const auto failed = [](int error) {
    return hal::Failure{
        .message = "cannot start cargobay-web: " + std::generic_category().message(error),
        .code = {error, std::generic_category()}};
  };
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) return failed(errno);
  ready_ = hal::Descriptor{pipe[0]};
  const hal::Descriptor writing{pipe[1]};
  std::vector<char*> arguments;
  arguments.reserve(arguments_.size() + 1);
  for (std::string& argument : arguments_) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  std::vector<char*> environment;
  for (char** variable = environ; *variable != nullptr; ++variable)
    environment.push_back(*variable);
  // Not as an argument: other users see those.
  std::string token = "CARGOBAY_TOKEN=" + token_;
  if (!token_.empty()) environment.insert(environment.begin(), token.data());
  environment.push_back(nullptr);
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, writing.number(), kReadyDescriptor);
  const SpawnAttributes attributes;
  pid_t process = -1;
  const int error = posix_spawn(&process, arguments[0], &actions, attributes.get(),
                                arguments.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return failed(error);
  process_ = process;
  return {};
}

// Until the end: starts it again when it has died. If it hangs, its clients lose their connection
// to it, and the feed goes on.
void WebSide::watch() {
  while (!stopping_.load()) {
    int status = 0;
    if (process_ > 0 && waitpid(process_, &status, WNOHANG) == 0) {
      std::this_thread::sleep_for(kLookEvery);
      continue;
    }
    process_ = -1;
    if (stopping_.load()) return;
    if (tell_) tell_("the web side has ended with " + in_words(status) + "; it is started again");
    const auto until = rt::Clock::now() + kBeforeAgain;
    while (!stopping_.load() && rt::Clock::now() < until) std::this_thread::sleep_for(kLookEvery);
    if (stopping_.load()) return;
    if (const auto spawned = spawn(); !spawned && tell_) tell_(spawned.failure().message);
  }
}

WebSide::~WebSide() {
  stopping_.store(true);
  if (watcher_.joinable()) watcher_.join();
  if (process_ < 0) return;
  kill(process_, SIGTERM);
  const auto until = rt::Clock::now() + kFarewell;
  int status = 0;
  while (waitpid(process_, &status, WNOHANG) == 0) {
    if (rt::Clock::now() >= until) kill(process_, SIGKILL);
    std::this_thread::sleep_for(kLookEvery);
  }
}

}  // namespace cargobay::cli
