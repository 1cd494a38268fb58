// In the steady state a cycle is one wait, one read and one write, with no heap, no lock and no
// page fault. Counted here, over a real pseudo-terminal and over many cycles in virtual time.

#include <linux/futex.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <new>
#include <thread>

#include <gtest/gtest.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/feed/feed_tap.hpp"
#include "hal/port/pty_transport.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_stream.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "tests/rtpath/call_counters.hpp"

namespace cargobay::hal {
namespace {

using cargobay::test::Calls;
using cargobay::test::Uncounted;

// Counts from frame `first` to frame `last`, then ends the cycle. Calls `also` in each frame
// between: a planted fault.
struct Counted {
  ControlCycle* cycle = nullptr;
  std::int64_t first = 0;
  std::int64_t last = 0;
  void (*also)() = nullptr;
  bool with_tripwire = false;
  std::int64_t frame = 0;
  bool guarded = false;
  Calls calls{};

  static ControlAnswer control(void* context, const CycleState& /*state*/, double seconds)
      CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<Counted*>(context);
    ++self.frame;
    if (self.frame == self.first) {
      if (self.with_tripwire) self.guarded = test::lay_tripwire();
      test::begin_counting();
    }
    if (self.frame == self.last) {
      self.calls = test::end_counting();
      self.cycle->request_stop();
    }
    if (self.also != nullptr && self.frame > self.first && self.frame < self.last) self.also();
    // Never at rest for long, so that every branch of the loop is taken.
    const bool fast = static_cast<std::int64_t>(seconds / 2.0) % 2 == 0;
    return fast ? rt::WheelSpeeds{300.0, 200.0} : rt::WheelSpeeds{-50.0, -80.0};
  }
};

// What the virtual Create itself does is not the cycle's.
class UncountedLink final : public ByteStream {
 public:
  explicit UncountedLink(sim::VirtualLink& link) : link_{link} {}
  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    const Uncounted uncounted;
    ++waits;
    CycleState state;  // taken as another thread would
    while (cycle != nullptr && cycle->next_state(state)) {
    }
    return link_.wait(deadline);
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    const Uncounted uncounted;
    return link_.read(bytes);
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    const Uncounted uncounted;
    return link_.write(bytes);
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return link_.now(); }
  std::uint32_t baud() const override { return link_.baud(); }
  std::error_code set_baud(std::uint32_t baud) override { return link_.set_baud(baud); }
  std::error_code set_wake_threshold(std::size_t bytes) override {
    return link_.set_wake_threshold(bytes);
  }
  void discard_input() override { link_.discard_input(); }
  bool drain(rt::Duration timeout) override { return link_.drain(timeout); }
  void sleep(rt::Duration duration) override { link_.sleep(duration); }

  std::int64_t waits = 0;
  ControlCycle* cycle = nullptr;

 private:
  sim::VirtualLink& link_;
};

// As hal::Robot calls its observers: the recorder, then the feed's.
struct Observers {
  FlightRecorder recorder{};
  FeedTap tap{};

  StateObserver observer() {
    StateObserver observer = recorder.observer();
    recorded = observer;
    told = tap.observer();
    observer.context = this;
    observer.function = [](void* context, const CycleState& state) CARGOBAY_NONBLOCKING {
      const auto& self = *static_cast<Observers*>(context);
      self.recorded.function(self.recorded.context, state);
      self.told.function(self.told.context, state);
    };
    observer.request = nullptr;
    observer.event = [](void* context, const Event& event) CARGOBAY_NONBLOCKING {
      const auto& self = *static_cast<Observers*>(context);
      self.told.event(self.told.context, event);
    };
    return observer;
  }

  StateObserver recorded{};
  StateObserver told{};
};

Calls run_in_virtual_time(sim::Remainder remainder, std::int64_t frames, void (*also)() = nullptr) {
  sim::Device device{sim::Parameters{.remainder = remainder}};
  sim::VirtualLink virtual_link{device};
  UncountedLink link{virtual_link};
  EXPECT_TRUE(bring_up(link, {.packets = oi::kCreate.list(oi::FrameList::reading)}));
  EXPECT_FALSE(link.set_wake_threshold(oi::kCreate.frame_bytes));
  // With its flight recorder, as for every robot, and others watching.
  const auto observers = std::make_unique<Observers>();
  RecordingStream recorded{link, observers->recorder};
  const auto cycle = std::make_unique<ControlCycle>(recorded, ControlCycle::Parameters{});
  cycle->set_observer(observers->observer());
  link.cycle = cycle.get();
  Counted counted{.cycle = cycle.get(), .first = 500, .last = 500 + frames, .also = also};
  cycle->set_control({.function = &Counted::control, .context = &counted});
  const std::int64_t waits_before = link.waits;
  EXPECT_EQ(cycle->run(), CycleEnd::asked);
  EXPECT_EQ(counted.frame, counted.last);
  EXPECT_LE(link.waits - waits_before, counted.frame + 1) << "one wait a frame";
  return counted.calls;
}

void expect_nothing(const Calls& calls) {
  EXPECT_EQ(calls.heap, 0U);
  EXPECT_EQ(calls.locks, 0U);
  EXPECT_EQ(calls.page_faults, 0U);
}

TEST(SteadyCycle, DoesNothingForbiddenInVirtualTime) {
  ASSERT_EQ(mlockall(MCL_CURRENT | MCL_FUTURE), 0) << "needs root or CAP_IPC_LOCK";
  for (const auto remainder : {sim::Remainder::carried, sim::Remainder::lost}) {
    expect_nothing(run_in_virtual_time(remainder, 500'000));
  }
  munlockall();
}

void touch_the_heap() {
  void* const memory = std::malloc(16);  // NOLINT(cppcoreguidelines-no-malloc): planted
  asm volatile("" ::"r"(memory) : "memory");
  std::free(memory);  // NOLINT(cppcoreguidelines-no-malloc): planted
}

std::mutex planted_mutex;  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): planted
void take_a_lock() { const std::lock_guard lock{planted_mutex}; }

struct alignas(64) CacheLine {
  int value = 0;
};
void touch_the_heap_aligned() {
  void* const memory = ::operator new(sizeof(CacheLine), std::align_val_t{alignof(CacheLine)});
  asm volatile("" ::"r"(memory) : "memory");
  ::operator delete(memory, std::align_val_t{alignof(CacheLine)});
}

std::atomic<int> planted_atomic{
    1};  // NOLINT(cppcoreguidelines-avoid-non-const-global-variables): planted
void ask_for_a_futex() {
  // Nothing waits; told that something may, the library asks the kernel.
  syscall(SYS_futex, &planted_atomic, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0);
}

void fault_a_page() {
  constexpr std::size_t kPage = 4096;
  void* const page =
      mmap(nullptr, kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  *static_cast<volatile char*>(page) = 1;
  munmap(page, kPage);
}

TEST(SteadyCycle, WouldBeCaughtUsingTheHeap) {
  EXPECT_GE(run_in_virtual_time(sim::Remainder::carried, 100, touch_the_heap).heap, 99U);
}
TEST(SteadyCycle, WouldBeCaughtTakingALock) {
  EXPECT_GE(run_in_virtual_time(sim::Remainder::carried, 100, take_a_lock).locks, 99U);
}
TEST(SteadyCycle, WouldBeCaughtUsingTheHeapAligned) {
  EXPECT_GE(run_in_virtual_time(sim::Remainder::carried, 100, touch_the_heap_aligned).heap, 99U);
}
TEST(SteadyCycle, WouldBeCaughtAskingForAFutex) {
  EXPECT_GE(run_in_virtual_time(sim::Remainder::carried, 100, ask_for_a_futex).locks, 99U);
}
TEST(SteadyCycle, WouldBeCaughtFaultingAPage) {
  EXPECT_GE(run_in_virtual_time(sim::Remainder::carried, 100, fault_a_page).page_faults, 99U);
}

struct PtyRun {
  Calls calls{};
  bool guarded = false;
  bool memory_locked = false;
  std::uint64_t withheld = 0;
};

// The real thing: its own thread, its own port, real time.
PtyRun run_over_pty(std::int64_t frames, void (*also)() = nullptr) {
  auto server = sim::Server::open(sim::Parameters{}, {.priority = 70});
  EXPECT_TRUE(server) << server.failure().message;
  EXPECT_FALSE((*server)->start());
  auto stream = open_pty((*server)->path(), 57600);
  EXPECT_TRUE(stream) << stream.failure().message;
  auto robot = Robot::open(std::move(*stream), {});
  EXPECT_TRUE(robot) << robot.failure().message;
  Counted counted{.cycle = &(*robot)->cycle(),
                  .first = 30,
                  .last = 30 + frames,
                  .also = also,
                  .with_tripwire = true};
  const auto grant = (*robot)->start({.function = &Counted::control, .context = &counted});
  EXPECT_TRUE(grant) << grant.failure().message;
  while (!(*robot)->ended()) poll(nullptr, 0, 10);
  // The tripwire still watches the thread, so its farewell must not make another call either.
  (void)(*robot)->stop();
  return {.calls = counted.calls,
          .guarded = counted.guarded,
          .memory_locked = grant->memory_locked,
          .withheld = (*robot)->cycle().withheld_commands()};
}

TEST(SteadyCycle, IsOneWaitOneReadOneWriteOverAPty) {
  constexpr std::uint64_t kFrames = 300;
  const PtyRun run = run_over_pty(kFrames);
  EXPECT_EQ(run.calls.heap, 0U);
  EXPECT_EQ(run.calls.locks, 0U);
  EXPECT_EQ(run.calls.other_calls, 0U);
  if (run.memory_locked) {
    EXPECT_EQ(run.calls.page_faults, 0U);
  }
  EXPECT_LE(run.calls.writes, kFrames);
  EXPECT_GE(run.calls.writes + run.withheld, kFrames);
  // If the machine delayed a frame, or a part of it, a wait timed out and was repeated.
  EXPECT_EQ(run.calls.waits, run.calls.reads);
  EXPECT_LE(run.calls.waits, kFrames + run.calls.time_outs);
  if (!run.memory_locked) GTEST_SKIP() << "memory could not be locked: page faults not counted";
  if (!run.guarded) GTEST_SKIP() << "no seccomp filters: other system calls not counted";
}

void yield() { std::this_thread::yield(); }

TEST(SteadyCycle, WouldBeCaughtMakingAnotherSystemCall) {
  const PtyRun run = run_over_pty(20, yield);
  if (!run.guarded) GTEST_SKIP() << "no seccomp filters";
  EXPECT_EQ(run.calls.other_calls, 19U);
}

}  // namespace
}  // namespace cargobay::hal
