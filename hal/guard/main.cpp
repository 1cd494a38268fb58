// cargobay-guard: started by the library over a robot's port, not by hand (hal/guard/guard.hpp).
// Waits until the thread that drives is dead or hung; then stops the robot, once, and ends.

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <ctime>

#include "hal/guard/farewell.hpp"
#include "hal/guard/guard_block.hpp"
#include "hal/guard/guard_port.hpp"
#include "hal/port/tty_speed.hpp"
#include "hal/stream/spaced_stream.hpp"
#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

enum class GuardFinding : std::uint8_t {
  nothing,
  owner_died,
  owner_hung,
  handed_over,
  port_left_behind,  // by an owner that died after its robot was left
};

constexpr milliseconds kLongestLeave{3000};  // the owner's own takes 2 s at most
constexpr int kNotByHand = 2;
constexpr int kOtherVersion = 3;

// Sleeps until the next beat, until the owner wakes the guard, or until the owner is gone: dead, or
// replaced by another program.
bool owner_goes(const GuardBlock& block, milliseconds beat) {
  pollfd owner{.fd = GuardBlock::kOwner, .events = POLLIN, .revents = 0};
  const int woken = poll(&owner, 1, static_cast<int>(beat.count()));
  if (woken > 0 && owner.revents != POLLIN) return true;
  std::array<std::uint8_t, 16> calls{};
  while (woken > 0 && read(GuardBlock::kOwner, calls.data(), calls.size()) > 0) {
  }
  return getppid() != block.owner;
}

// Null if this program was not started by the library of its own version.
GuardBlock* map_block() {
  struct stat file{};
  if (fstat(GuardBlock::kBlock, &file) != 0 || file.st_size != sizeof(GuardBlock)) return nullptr;
  void* const memory =
      mmap(nullptr, sizeof(GuardBlock), PROT_READ | PROT_WRITE, MAP_SHARED, GuardBlock::kBlock, 0);
  if (memory == MAP_FAILED) return nullptr;
  auto* const block = static_cast<GuardBlock*>(memory);
  return block->version == GuardBlock::kVersion ? block : nullptr;
}

// More than the guard ever needs.
[[gnu::noinline]] void touch_stack() {
  constexpr std::size_t kBytes = std::size_t{64} * 1024;
  constexpr std::size_t kPage = 4096;
  std::array<volatile std::uint8_t, kBytes> pages{};
  for (std::size_t i = 0; i < pages.size(); i += kPage) pages[i] = 1;
}

// As far as permitted: without these rights it serves as well as the scheduler lets it.
void take_rights(const GuardBlock& block) {
  // Not MCL_FUTURE: only the stack still grows, and under a limit it then could not.
  touch_stack();
  (void)mlockall(MCL_CURRENT);
  cpu_set_t all;
  CPU_ZERO(&all);
  for (unsigned cpu = 0; cpu < CPU_SETSIZE; ++cpu) CPU_SET(cpu, &all);
  (void)sched_setaffinity(0, sizeof all, &all);  // the owner may be bound to a CPU that is taken
  sched_param parameters{};
  parameters.sched_priority = block.priority;
  if (block.priority > 0) (void)sched_setscheduler(0, SCHED_FIFO, &parameters);
  if (const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC); file >= 0) {
    (void)!write(file, "-1000", 5);  // only root may, and a child of a service that was put there
    close(file);
  }
}

// Returns the time.
std::int64_t beat(GuardBlock& block) {
  const std::int64_t now_ns = rt::nanoseconds(rt::Clock::now());
  block.guard_beat_ns.store(now_ns, std::memory_order_relaxed);
  return now_ns;
}

// Until the control thread is dead or hung, or has let go of its own accord (`nothing`).
GuardFinding watch(GuardBlock& block) {
  for (;;) {
    const std::int64_t next_beat_ns = beat(block) + rt::Duration{kGuardBeat}.count();
    const std::int64_t deadline_ns =
        block.beat_ns.load(std::memory_order_relaxed) + block.deadline_ns;
    const timespec limit = rt::as_timespec(rt::Duration{std::min(next_beat_ns, deadline_ns)});
    switch (pthread_mutex_clocklock(&block.alive, CLOCK_MONOTONIC, &limit)) {
      case 0: pthread_mutex_unlock(&block.alive); return GuardFinding::nothing;
      case EOWNERDEAD: return GuardFinding::owner_died;
      case ETIMEDOUT: break;
      default: (void)owner_goes(block, kGuardBeat);  // the beats continue
    }
    const rt::TimePoint beat{rt::Duration{block.beat_ns.load(std::memory_order_relaxed)}};
    if (rt::Clock::now() >= beat + rt::Duration{block.deadline_ns}) return GuardFinding::owner_hung;
  }
}

// Before and after the drive the owner is an ordinary program: check on it now and then.
GuardFinding wait_for_change(GuardBlock& block, GuardState state) {
  const rt::TimePoint limit = rt::Clock::now() + kLongestLeave;
  const bool idle = state == GuardState::standing_by || state == GuardState::left;
  const auto idle_beat = std::chrono::duration_cast<milliseconds>(rt::Duration{block.idle_beat_ns});
  while (block.state.load(std::memory_order_acquire) == state) {
    beat(block);
    if (owner_goes(block, idle ? idle_beat : kGuardBeat)) return GuardFinding::owner_died;
    const bool leaves = state == GuardState::leaving || state == GuardState::guard_lost;
    if (leaves && rt::Clock::now() >= limit) return GuardFinding::owner_hung;
  }
  return GuardFinding::nothing;
}

// Returns once the owner has released the robot, or has to be replaced.
GuardFinding guard(GuardBlock& block) {
  for (;;) {
    const GuardState state = block.state.load(std::memory_order_acquire);
    if (state == GuardState::released) return GuardFinding::nothing;
    const GuardFinding finding = state == GuardState::handed_over ? GuardFinding::handed_over
                                 : state == GuardState::driving   ? watch(block)
                                                                  : wait_for_change(block, state);
    if (finding == GuardFinding::nothing) {
      // The lock is free, but the thread that held it did not say farewell.
      GuardState expected = GuardState::driving;
      if (state == expected) block.state.compare_exchange_strong(expected, GuardState::leaving);
      continue;
    }
    if (state == GuardState::left) return GuardFinding::port_left_behind;
    // From here on the owner sends nothing, unless it has just left by itself.
    GuardState expected = state;
    if (block.state.compare_exchange_strong(expected, GuardState::taken)) return finding;
  }
}

void leave_port_as_found(const GuardBlock& block) {
  tcdrain(GuardBlock::kPort);
  tcsetattr(GuardBlock::kPort, TCSANOW, &block.found);
  if (block.found_baud != 0 && tty_speed(GuardBlock::kPort) != block.found_baud) {
    (void)set_tty_speed(GuardBlock::kPort, block.found_baud);  // nothing is left to report to
  }
  ioctl(GuardBlock::kPort, TIOCNXCL);
}

// If so much of what the loop sent is still queued in the port that the stop would come late, the
// backlog is dropped, which cuts one of the commands in it. Returns how many bytes may be missing.
std::size_t drop_backlog(std::size_t owed) {
  int waiting = 0;
  if (ioctl(GuardBlock::kPort, TIOCOUTQ, &waiting) != 0 || waiting <= kMostBacklog) return owed;
  tcflush(GuardBlock::kPort, TCOFLUSH);
  return oi::kLongestRest;
}

// During a bring-up the robot may be at another rate than the port.
Parting say_farewell(GuardBlock& block) {
  GuardPort terminal{block};
  SpacedStream port{terminal};
  Unfinished unfinished{.bytes = drop_backlog(block.in_writing.load(std::memory_order_acquire)),
                        .demo = block.demo.load(std::memory_order_acquire)};
  // What the program's SpacedStream had buffered is lost with it.
  if (oi::needs_spacing(port.baud())) unfinished.bytes = oi::kLongestRest;
  const Parting parting = farewell(port, unfinished);
  if (parting != Parting::unconfirmed || block.driven) return parting;
  for (const std::uint32_t baud :
       {block.wanted_baud, oi::kCreate.default_baud, oi::kCreate.brc_baud}) {
    if (baud == port.baud() || port.set_baud(baud)) continue;
    unfinished.bytes = oi::kLongestRest;
    if (farewell(port, unfinished) == Parting::standing) return Parting::standing;
  }
  return parting;
}

int run() {
  GuardBlock* const block = map_block();
  if (block == nullptr) {
    std::fputs(
        "cargobay-guard is started by the cargobay library, to stop a robot whose program died; it "
        "does nothing when run by hand\n",
        stderr);
    return fcntl(GuardBlock::kBlock, F_GETFD) < 0 ? kNotByHand : kOtherVersion;
  }
  take_rights(*block);
  beat(*block);
  block->ready.store(true, std::memory_order_release);
  const GuardFinding finding = guard(*block);
  if (finding == GuardFinding::nothing) return 0;
  if (finding == GuardFinding::port_left_behind) {
    leave_port_as_found(*block);
    return 0;
  }
  block->parting.store(say_farewell(*block), std::memory_order_relaxed);
  block->done.store(true, std::memory_order_release);
  // A living owner still has the port and closes it; if it dies first, that is left to us.
  const bool alive = finding != GuardFinding::owner_died &&
                     wait_for_change(*block, GuardState::taken) == GuardFinding::nothing;
  if (!alive) leave_port_as_found(*block);
  return 0;
}

}  // namespace
}  // namespace cargobay::hal

int main() { return cargobay::hal::run(); }
