// cargobay-guard: started by the library over a robot's port, not by hand (hal/guard.hpp). Waits
// until the thread that drives is dead or hung; then stops the robot, once, and ends.

#include <fcntl.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <ctime>

#include "hal/guard/stop_robot.hpp"
#include "hal/guard_block.hpp"
#include "hal/tty_speed.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

enum class GuardFinding : std::uint8_t { nothing, owner_died, owner_hung };

constexpr milliseconds kNap{20};
constexpr milliseconds kLongestLeave{3000};  // the owner's own takes 1 s at most
constexpr int kNotByHand = 2;
constexpr int kOtherVersion = 3;

bool owner_is_gone(const GuardBlock& block) { return getppid() != block.owner; }

void nap() {
  const timespec pause{.tv_sec = 0, .tv_nsec = rt::Duration{kNap}.count()};
  nanosleep(&pause, nullptr);
}

// Null where this program was not started by the library of its own version.
GuardBlock* map_block() {
  struct stat file{};
  if (fstat(GuardBlock::kBlock, &file) != 0 || file.st_size != sizeof(GuardBlock)) return nullptr;
  void* const memory =
      mmap(nullptr, sizeof(GuardBlock), PROT_READ | PROT_WRITE, MAP_SHARED, GuardBlock::kBlock, 0);
  if (memory == MAP_FAILED) return nullptr;
  auto* const block = static_cast<GuardBlock*>(memory);
  return block->version == GuardBlock::kVersion ? block : nullptr;
}

// As far as it may: without these it serves as well as the scheduler lets it.
void take_rights(const GuardBlock& block) {
  (void)mlockall(MCL_CURRENT | MCL_FUTURE);
  cpu_set_t all;
  CPU_ZERO(&all);
  for (unsigned cpu = 0; cpu < CPU_SETSIZE; ++cpu) CPU_SET(cpu, &all);
  (void)sched_setaffinity(0, sizeof all, &all);  // the owner may be bound to a CPU that is taken
  sched_param parameters{};
  parameters.sched_priority = block.priority;
  if (block.priority > 0) (void)sched_setscheduler(0, SCHED_FIFO, &parameters);
  if (const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); file >= 0) {
    (void)!write(file, "-1000", 5);  // only root may
    close(file);
  }
}

// Until the control thread is dead or hung, or has let go of its own accord (nothing).
GuardFinding watch(GuardBlock& block) {
  for (;;) {
    const std::int64_t limit_ns = block.beat_ns.load(std::memory_order_relaxed) + block.deadline_ns;
    const timespec limit{.tv_sec = static_cast<time_t>(limit_ns / 1'000'000'000),
                         .tv_nsec = static_cast<long>(limit_ns % 1'000'000'000)};
    switch (pthread_mutex_clocklock(&block.alive, CLOCK_MONOTONIC, &limit)) {
      case 0: pthread_mutex_unlock(&block.alive); return GuardFinding::nothing;
      case EOWNERDEAD: return GuardFinding::owner_died;
      case ETIMEDOUT: break;
      default: nap();  // the beats remain
    }
    const rt::TimePoint beat{rt::Duration{block.beat_ns.load(std::memory_order_relaxed)}};
    if (rt::Clock::now() >= beat + rt::Duration{block.deadline_ns}) return GuardFinding::owner_hung;
  }
}

// Before and behind the drive the owner is an ordinary program: looked at now and then.
GuardFinding wait_for_change(const GuardBlock& block, GuardState state) {
  const rt::TimePoint limit = rt::Clock::now() + kLongestLeave;
  while (block.state.load(std::memory_order_acquire) == state) {
    if (owner_is_gone(block)) return GuardFinding::owner_died;
    if (state == GuardState::leaving && rt::Clock::now() >= limit) return GuardFinding::owner_hung;
    nap();
  }
  return GuardFinding::nothing;
}

// Returns once the owner has released the robot, or has to be replaced.
GuardFinding guard(GuardBlock& block) {
  for (;;) {
    const GuardState state = block.state.load(std::memory_order_acquire);
    if (state == GuardState::released) return GuardFinding::nothing;
    const GuardFinding finding =
        state == GuardState::driving ? watch(block) : wait_for_change(block, state);
    if (finding == GuardFinding::nothing) {
      // The lock is free, and the thread that held it did not say farewell.
      GuardState expected = GuardState::driving;
      if (state == expected) block.state.compare_exchange_strong(expected, GuardState::leaving);
      continue;
    }
    // From here on the owner sends nothing, unless it has just left by itself.
    GuardState expected = state;
    if (block.state.compare_exchange_strong(expected, GuardState::taken)) return finding;
  }
}

void leave_port_as_found(const GuardBlock& block) {
  tcdrain(GuardBlock::kPort);
  tcsetattr(GuardBlock::kPort, TCSANOW, &block.found);
  if (block.found_baud != 0 && tty_speed(GuardBlock::kPort) != block.found_baud) {
    (void)set_tty_speed(GuardBlock::kPort, block.found_baud);  // nobody is left to be told
  }
  ioctl(GuardBlock::kPort, TIOCNXCL);
}

int run() {
  GuardBlock* const block = map_block();
  if (block == nullptr) {
    std::fputs(
        "cargobay-guard is started by the cargobay library, to stop a robot whose program died; "
        "it does nothing by hand\n",
        stderr);
    return fcntl(GuardBlock::kBlock, F_GETFD) < 0 ? kNotByHand : kOtherVersion;
  }
  take_rights(*block);
  block->ready.store(true, std::memory_order_release);
  const GuardFinding finding = guard(*block);
  if (finding == GuardFinding::nothing) return 0;
  const bool confirmed =
      stop_robot(GuardBlock::kPort, block->in_writing.load(std::memory_order_acquire));
  block->confirmed_passive.store(confirmed, std::memory_order_release);
  // A hung owner may wake, and still has the port.
  if (finding == GuardFinding::owner_died) leave_port_as_found(*block);
  return 0;
}

}  // namespace
}  // namespace cargobay::hal

int main() { return cargobay::hal::run(); }
