#include "tests/guard/death.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <utility>

#include "hal/port/pty_transport.hpp"
#include "hal/robot/robot.hpp"
#include "oi/dialect.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::test {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPatience{10'000};
constexpr milliseconds kRest{600};         // from full speed to rest, by the wheels' lag
constexpr std::uint64_t kMostFrames = 33;  // half a second
// A robot's own processor is not delayed by a loop that spins at priority 80.
constexpr int kRobotPriority = 95;
constexpr double kMoving = 20.0;  // mm/s
constexpr double kAtRest = 2.0;

void sleep(rt::Duration duration) {
  const timespec pause{.tv_sec = duration.count() / 1'000'000'000,
                       .tv_nsec = duration.count() % 1'000'000'000};
  nanosleep(&pause, nullptr);
}

bool eventually(const std::function<bool()>& holds) {
  const rt::TimePoint limit = rt::Clock::now() + kPatience;
  while (!holds()) {
    if (rt::Clock::now() >= limit) return false;
    sleep(milliseconds{2});
  }
  return true;
}

// A process that reports on a pipe when it dies or hangs.
class Victim {
 public:
  Victim(Way way, const std::string& port, std::uint64_t frames, rt::Duration deadline) {
    std::array<int, 2> ends{};
    if (pipe2(ends.data(), O_CLOEXEC) != 0) return;
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
    std::vector<std::string> words{"guard_campaign",       "--victim",
                                   std::string{name(way)}, port,
                                   std::to_string(frames), std::to_string(deadline.count())};
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawn(&process_, "/proc/self/exe", &files, nullptr, arguments.data(), environ) != 0) {
      process_ = -1;
    }
    posix_spawn_file_actions_destroy(&files);
    close(ends[1]);
    said_ = ends[0];
  }
  ~Victim() {
    send(SIGKILL);
    (void)collect();
    if (said_ >= 0) close(said_);
  }
  Victim(const Victim&) = delete;
  Victim& operator=(const Victim&) = delete;

  void send(int signal) const {
    if (process_ > 0) kill(process_, signal);
  }
  // Waits for its end; returns its status.
  int collect() {
    int status = 0;
    if (process_ > 0) waitpid(process_, &status, 0);
    process_ = -1;
    return status;
  }
  // When it died or hung, by its own report; nothing if it made none.
  std::optional<rt::TimePoint> deed() const {
    pollfd end{.fd = said_, .events = POLLIN, .revents = 0};
    if (poll(&end, 1, static_cast<int>(kPatience.count())) != 1) return std::nullopt;
    std::array<char, 32> text{};
    const ssize_t count = read(said_, text.data(), text.size());
    std::int64_t time_ns = 0;
    const char* const last = text.data() + std::max<ssize_t>(count, 0);
    if (std::from_chars(text.data(), last, time_ns).ec != std::errc{}) return std::nullopt;
    return rt::TimePoint{rt::Duration{time_ns}};
  }

 private:
  pid_t process_ = -1;
  int said_ = -1;
};

}  // namespace

std::string_view name(Way way) {
  switch (way) {
    case Way::kill: return "kill";
    case Way::segv: return "segv";
    case Way::abort: return "abort";
    case Way::stop: return "stop";
    case Way::endless: return "endless";
  }
  return "";
}

std::optional<Way> find_way(std::string_view wanted) {
  const auto* const way =
      std::ranges::find_if(kWays, [wanted](Way each) { return name(each) == wanted; });
  return way == kWays.end() ? std::nullopt : std::optional{*way};
}

bool is_hang(Way way) { return way == Way::stop || way == Way::endless; }

std::unique_ptr<DeathBed> DeathBed::make(std::uint64_t seed, rt::Duration deadline) {
  std::unique_ptr<DeathBed> bed{new DeathBed{seed, deadline}};
  auto server = hal::sim::Server::open(hal::sim::Parameters{}, {.priority = kRobotPriority});
  if (!server) {
    std::fprintf(stderr, "%s\n", server.failure().message.c_str());
    return nullptr;
  }
  bed->server_ = std::move(*server);
  bed->server_->with_device([it = bed.get()](hal::sim::Device& device) {
    device.on_drive = [it](const hal::sim::DriveRecord& record) {
      const std::lock_guard lock{it->mutex_};
      it->records_.push_back(record);
    };
  });
  if (bed->server_->start()) return nullptr;
  return bed;
}

std::uint64_t DeathBed::draw(std::uint64_t below) {
  chance_ = chance_ * 6364136223846793005U + 1442695040888963407U;  // Knuth's, for MMIX
  return (chance_ >> 33U) % below;
}

// The origin of the robot's own time.
rt::TimePoint DeathBed::power_on() const {
  rt::TimePoint zero;
  server_->with_device(
      [&zero](hal::sim::Device& device) { zero = rt::Clock::now() - device.now(); });
  return zero;
}

std::vector<hal::sim::DriveRecord> DeathBed::take_records() {
  const std::lock_guard lock{mutex_};
  return std::exchange(records_, {});
}

Death DeathBed::let_die(Way way) {
  Death death;
  (void)take_records();
  Victim victim{way, server_->path(), 20 + draw(kMostFrames), deadline_};
  rt::TimePoint deed;
  if (way == Way::kill) {
    death.drove =
        eventually([this] { return server_->snapshot().truth.speeds.left_mm_s > kMoving; });
    sleep(std::chrono::microseconds{draw(500'000)});
    deed = rt::Clock::now();
    victim.send(SIGKILL);
  } else {
    const auto said = victim.deed();
    death.drove = said.has_value();
    deed = said.value_or(rt::Clock::now());
  }
  if (!death.drove) return death;
  death.passive = eventually([this] { return server_->snapshot().mode == oi::Mode::passive; });
  // A suspended program wakes up, but must no longer have any effect.
  if (way == Way::stop) victim.send(SIGCONT);
  sleep(kRest);
  const rt::Duration since = deed - power_on();
  const hal::sim::Snapshot after = server_->snapshot();
  for (const hal::sim::DriveRecord& record : take_records()) {
    const bool is_stop = record.command == hal::sim::WheelSpeeds{};
    if (record.time < since || (!death.stopped && !is_stop)) continue;
    if (!death.stopped) death.to_stop = record.time - since;
    death.quiet = is_stop;
    death.stopped = true;
  }
  death.stopped = death.stopped && std::abs(after.truth.speeds.left_mm_s) < kAtRest &&
                  std::abs(after.truth.speeds.right_mm_s) < kAtRest;
  return death;
}

namespace {

struct Deed {
  Way way;
  int frames;  // frames left
};

void say_now() {
  std::array<char, 32> text{};
  const char* const end =
      std::to_chars(text.begin(), text.end(), rt::nanoseconds(rt::Clock::now())).ptr;
  (void)write(STDOUT_FILENO, text.data(), static_cast<std::size_t>(end - text.data()));
}

void commit(Way way) {
  if (way == Way::kill) return;  // sent from outside
  say_now();
  std::atomic<bool> forever{true};
  switch (way) {
    case Way::segv: raise(SIGSEGV); break;
    case Way::abort: std::abort();
    case Way::stop: raise(SIGSTOP); break;
    case Way::endless:
      while (forever.load(std::memory_order_relaxed)) {
      }
      break;
    case Way::kill: break;
  }
}

hal::ControlAnswer control(void* context, const hal::CycleState& /*state*/, double /*seconds*/)
    CARGOBAY_NONBLOCKING {
  auto& deed = *static_cast<Deed*>(context);
  if (--deed.frames == 0) rt::unchecked([&deed]() noexcept { commit(deed.way); });
  return rt::WheelSpeeds{300.0, 200.0};
}

}  // namespace

int be_victim(Way way, const std::string& path, int frames, rt::Duration deadline) {
  const rlimit no_core{.rlim_cur = 0, .rlim_max = 0};  // a dump takes time, and the deadline
  (void)setrlimit(RLIMIT_CORE, &no_core);
  auto stream = hal::open_pty(path, oi::kCreate.default_baud);
  if (!stream) {
    std::fprintf(stderr, "%s\n", stream.failure().message.c_str());
    return 1;
  }
  hal::RobotOptions options;
  options.guard.deadline = deadline;
  auto robot = hal::Robot::open(std::move(*stream), options);
  if (!robot) {
    std::fprintf(stderr, "%s\n", robot.failure().message.c_str());
    return 1;
  }
  Deed deed{.way = way, .frames = frames};
  const auto grant = (*robot)->start({.function = control, .context = &deed});
  if (!grant) {
    std::fprintf(stderr, "%s\n", grant.failure().message.c_str());
    return 1;
  }
  while (!(*robot)->ended()) sleep(milliseconds{10});
  return (*robot)->stop().end == hal::CycleEnd::guarded ? 0 : 1;
}

}  // namespace cargobay::test
