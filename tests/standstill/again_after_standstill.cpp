// Runs a test that runs in real time. If it fails, and the machine itself stood still for longer
// than any such test can bear, runs it again when the machine is calm, a few times at most.
//
//   again_after_standstill [--bear MS] COMMAND [ARGUMENT...]
//
// A virtual machine may lose a processor for tens of milliseconds, whatever runs on it at whatever
// priority; and a kernel whose processors are all busy may take a second to pass on what was
// written to a terminal, since its kworkers have no priority. Then a guard stops its robot, or a
// robot gets two commands in one tick, although nothing is wrong with what is tested. Threads above
// everything else, one on each processor and one on a separate terminal, show that it was so. A
// failure without a standstill counts, at the first run. Returns what the command returned last,
// 128 + N if signal N ended it.
//
// Each run has an empty $XDG_RUNTIME_DIR of its own, where it publishes feeds: they are named after
// ports, and a pseudo-terminal that one test closes is the next one's.
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <pty.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <latch>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;
using std::chrono::milliseconds;

// A third of a tick: the loop has the rest of it to answer a frame.
constexpr microseconds kBearable = milliseconds{5};
constexpr microseconds kBetweenLooks = milliseconds{2};
constexpr microseconds kCalm = milliseconds{300};
constexpr microseconds kLongestWait = std::chrono::seconds{10};
constexpr int kRuns = 6;

std::atomic<std::int64_t> longest_us{0};  // since it was last set to 0

void stood_still_since(Clock::time_point due) {
  const auto late = std::chrono::duration_cast<microseconds>(Clock::now() - due).count();
  std::int64_t longest = longest_us.load();
  while (late > longest && !longest_us.compare_exchange_weak(longest, late)) continue;
}

// Runs before everything else, if that is allowed.
void go_first() {
  const sched_param highest{.sched_priority = sched_get_priority_max(SCHED_FIFO)};
  (void)pthread_setschedparam(pthread_self(), SCHED_FIFO, &highest);
}

// How much later than requested a processor lets its first thread continue.
void watch_processor(unsigned processor, std::latch& watching) {
  cpu_set_t mine;
  CPU_ZERO(&mine);
  CPU_SET(processor, &mine);
  (void)pthread_setaffinity_np(pthread_self(), sizeof mine, &mine);  // a cpuset may forbid it
  go_first();
  for (bool first = true;; first = false) {
    const Clock::time_point due = Clock::now() + kBetweenLooks;
    if (first) watching.count_down();  // not looked at again: it lives no longer
    std::this_thread::sleep_until(due);
    stood_still_since(due);
  }
}

// How long a terminal takes to pass a byte on.
void watch_terminal(int master, int slave) {
  go_first();
  for (;;) {
    const Clock::time_point written = Clock::now();
    std::uint8_t byte = 0x55;
    if (write(master, &byte, 1) != 1) return;
    pollfd arrival{.fd = slave, .events = POLLIN, .revents = 0};
    while (poll(&arrival, 1, 1) == 0) stood_still_since(written);
    stood_still_since(written);
    if (read(slave, &byte, 1) != 1) return;
    std::this_thread::sleep_for(kBetweenLooks);
  }
}

// Returns once each processor is watched: what is run next may stop this program at once.
void start_watches() {
  const unsigned processors = std::max(1U, std::thread::hardware_concurrency());
  std::latch watching{static_cast<std::ptrdiff_t>(processors)};
  for (unsigned processor = 0; processor < processors; ++processor)
    std::thread{watch_processor, processor, std::ref(watching)}.detach();
  watching.wait();
  int master = -1;
  int slave = -1;
  termios raw{};
  cfmakeraw(&raw);
  if (openpty(&master, &slave, nullptr, &raw, nullptr) != 0) return;
  for (const int descriptor : {master, slave}) (void)fcntl(descriptor, F_SETFD, FD_CLOEXEC);
  std::thread{watch_terminal, master, slave}.detach();
}

class RuntimeFolder {
 public:
  RuntimeFolder() {
    if (mkdtemp(path_.data()) == nullptr) path_.clear();
    // NOLINTNEXTLINE(concurrency-mt-unsafe): the watches do not read it
    setenv("XDG_RUNTIME_DIR", path_.c_str(), 1);
  }
  ~RuntimeFolder() {
    std::error_code error;
    if (!path_.empty()) std::filesystem::remove_all(path_, error);
  }
  RuntimeFolder(const RuntimeFolder&) = delete;
  RuntimeFolder& operator=(const RuntimeFolder&) = delete;

 private:
  std::string path_ = "/tmp/cargobay-run-XXXXXX";
};

int run(char** command) {
  const RuntimeFolder folder;
  const pid_t process = fork();
  if (process == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    execv(command[0], command);
    std::fprintf(stderr, "%s: %s\n", command[0], std::generic_category().message(errno).c_str());
    _exit(127);
  }
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) continue;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

void wait_for_calm() {
  const Clock::time_point end = Clock::now() + kLongestWait;
  do {
    longest_us = 0;
    std::this_thread::sleep_for(kCalm);
  } while (longest_us.load() > kBearable.count() && Clock::now() < end);
}

}  // namespace

int main(int argc, char** argv) {
  char** command = argv + 1;
  microseconds bearable = kBearable;
  if (argc > 2 && std::string_view{argv[1]} == "--bear") {
    bearable = milliseconds{std::strtol(argv[2], nullptr, 10)};
    command = argv + 3;
  }
  if (argc < 2 || *command == nullptr) {
    std::fputs("usage: again_after_standstill [--bear MS] COMMAND [ARGUMENT...]\n", stderr);
    return 2;
  }
  start_watches();
  for (int time = 1;; ++time) {
    longest_us = 0;
    const int code = run(command);
    const microseconds longest{longest_us.load()};
    if (code == 0 || longest < bearable || time == kRuns) return code;
    std::printf("again:");
    for (char** word = command; *word != nullptr; ++word) std::printf(" %s", *word);
    std::printf(": run %d returned %d, and the machine stood still for %.1f ms\n", time, code,
                static_cast<double>(longest.count()) / 1000.0);
    std::fflush(stdout);
    wait_for_calm();
  }
}
