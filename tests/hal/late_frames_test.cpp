// Frames that come late, in bunches or in pieces: each is counted once, none is taken for lost, no
// tick of the robot sees two commands, and the loop is back on time right behind it.

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "hal/bring_up.hpp"
#include "hal/control_cycle.hpp"
#include "hal/sim/device.hpp"
#include "hal/sim/virtual_link.hpp"
#include "oi/stream_budget.hpp"
#include "rt/unchecked.hpp"
#include "tests/hal/held_stream.hpp"

namespace cargobay::hal {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""ns;
using std::chrono_literals::operator""us;

using HandOver = std::function<rt::TimePoint(rt::TimePoint)>;

struct Driven {
  FrameCounters frames{};
  CycleEnd end = CycleEnd::asked;
  std::vector<CycleState> states{};
  std::vector<sim::DriveRecord> commands{};  // without those that end the drive
  std::uint64_t withheld = 0;
  std::uint64_t sent = 0;   // frames, while the cycle ran
  rt::WheelSpeeds truth{};  // on average over the last second
};

// Drives at 200 mm/s for so many frames; the delay begins with the cycle.
Driven drive(const HandOver& hand_over, std::uint64_t frames,
             sim::Remainder remainder = sim::Remainder::carried) {
  sim::Device device{{.remainder = remainder}};
  sim::VirtualLink link{device};
  test::HeldStream stream{link};
  Driven run;
  EXPECT_TRUE(bring_up(stream, {.packets = kReadingList}));
  EXPECT_FALSE(stream.set_wake_threshold(kFrameBytes));
  ControlCycle::Parameters parameters;
  parameters.loop.estimator.input_delay_s =
      rt::seconds(oi::wire_time(kFrameBytes + oi::kDriveDirectBytes, stream.baud()));
  const auto cycle = std::make_unique<ControlCycle>(stream, parameters);
  struct Driver {
    ControlCycle* cycle;
    const sim::Device* device;
    std::uint64_t last_tick;
    static rt::WheelSpeeds control(void* context, const CycleState& /*state*/,
                                   double /*seconds*/) noexcept CARGOBAY_NONBLOCKING {
      const auto& self = *static_cast<Driver*>(context);
      if (rt::unchecked([&self] { return self.device->ticks(); }) >= self.last_tick) {
        self.cycle->request_stop();
      };
      return {200.0, 200.0};
    }
  } driver{cycle.get(), &device, device.ticks() + frames};
  cycle->set_control({.function = &Driver::control, .context = &driver});
  constexpr std::uint64_t kSecond = 67;
  device.on_tick = [&run, &driver](const sim::Device& robot) {
    if (robot.ticks() + kSecond < driver.last_tick || robot.ticks() >= driver.last_tick) return;
    run.truth.left_mm_s += robot.truth().speeds.left_mm_s / kSecond;
    run.truth.right_mm_s += robot.truth().speeds.right_mm_s / kSecond;
  };
  device.on_drive = [&run](const sim::DriveRecord& record) { run.commands.push_back(record); };
  const std::uint64_t before = device.counters().frames_sent;
  stream.hand_over = hand_over;
  run.end = cycle->run();
  run.sent = device.counters().frames_sent - before;
  run.frames = cycle->frames();
  run.withheld = cycle->withheld_commands();
  CycleState state;
  while (cycle->next_state(state)) run.states.push_back(state);
  return run;
}

int most_commands_in_a_tick(const Driven& run) {
  std::map<std::uint64_t, int> in_tick;
  int most = 0;
  for (const sim::DriveRecord& record : run.commands) most = std::max(most, ++in_tick[record.tick]);
  return most;
}

// From the robot's tick to the arrival of a command.
rt::Duration offset(const sim::DriveRecord& record) {
  return (record.time - oi::kTick) % oi::kTick;
}
// What a frame that comes on time takes to be answered: both on the wire.
constexpr rt::Duration kOnTime = oi::wire_time(kFrameBytes + oi::kDriveDirectBytes, 57600) + 100us;

bool is_on_time_from(const Driven& run, std::uint64_t tick) {
  bool any = false;
  for (const sim::DriveRecord& record : run.commands) {
    if (record.tick < tick) continue;
    any = true;
    if (offset(record) > kOnTime) return false;
  }
  return any;
}

TEST(LateFrames, AreNoneWhereNothingDelays) {
  const Driven run = drive({}, 500);
  EXPECT_EQ(run.frames.late, 0U);
  EXPECT_EQ(run.frames.good, run.sent);
  EXPECT_EQ(most_commands_in_a_tick(run), 1);
  EXPECT_TRUE(is_on_time_from(run, 0));
}

// FTDI's latency timer, as it is set out of the box.
TEST(LateFrames, OfAnAdapterThatHandsOverEvery16MsAreNotLost) {
  for (const auto remainder : {sim::Remainder::carried, sim::Remainder::lost}) {
    const auto raster = [](rt::TimePoint arrival) {
      const rt::Duration time = arrival.time_since_epoch();
      return rt::TimePoint{(time + 16ms - 1ns) / 16ms * 16ms};
    };
    const Driven run = drive(raster, 4000, remainder);
    EXPECT_EQ(run.end, CycleEnd::asked);
    EXPECT_EQ(run.frames.lost, 0U);
    EXPECT_EQ(run.frames.bad, 0U);
    EXPECT_NEAR(static_cast<double>(run.frames.good), 4000.0, 3.0);
    EXPECT_LE(most_commands_in_a_tick(run), 1);
    EXPECT_NEAR(run.truth.left_mm_s, 200.0, 9.0);
    EXPECT_NEAR(run.truth.right_mm_s, 200.0, 9.0);
    EXPECT_LT(run.withheld, 400U);
  }
}

// Every third frame or so is late by a few milliseconds, some by more than a tick.
TEST(LateFrames, NeverGetARobotTwoCommandsInATick) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937 random{seed};
    std::exponential_distribution<double> jitter{1.0 / 6e6};  // ns
    std::int64_t frame = 0;
    rt::Duration delay{0};
    const auto late = [&](rt::TimePoint arrival) {
      const std::int64_t now = arrival.time_since_epoch() / oi::kTick;
      if (now != frame) {
        frame = now;
        const rt::Duration most = 40ms;
        const rt::Duration drawn{static_cast<std::int64_t>(jitter(random))};
        delay = random() % 3 == 0 ? std::min(drawn, most) : rt::Duration{0};
      }
      return arrival + delay;
    };
    const Driven run = drive(late, 2000);
    EXPECT_EQ(run.end, CycleEnd::asked);
    EXPECT_LE(most_commands_in_a_tick(run), 1) << seed;
    EXPECT_EQ(run.frames.bad, 0U) << seed;
    EXPECT_EQ(run.frames.lost, 0U) << seed;
    EXPECT_GT(run.withheld, 0U) << seed;
    EXPECT_LT(run.withheld, 200U) << seed;
    EXPECT_NEAR(run.truth.left_mm_s, 200.0, 10.0) << seed;
  }
}

// Everything that arrives in that time is handed over at its end.
HandOver stall(rt::Duration begin, rt::Duration length) {
  return [=](rt::TimePoint arrival) {
    const rt::Duration time = arrival.time_since_epoch();
    return time >= begin && time < begin + length ? rt::TimePoint{begin + length} : arrival;
  };
}

TEST(LateFrames, ThatComeInABunchAreAnsweredOnce) {
  for (rt::Duration length = 10ms; length <= 140ms; length += 7ms) {
    const Driven run = drive(stall(2000ms, length), 300);
    EXPECT_EQ(run.end, CycleEnd::asked);
    EXPECT_EQ(run.frames.good, run.sent) << length.count();
    EXPECT_EQ(run.frames.lost + run.frames.bad, 0U) << length.count();
    EXPECT_LE(most_commands_in_a_tick(run), 1) << length.count();
    EXPECT_TRUE(is_on_time_from(run, 150)) << length.count();
  }
}

// Stalls that begin in the middle of a frame, at each of its bytes.
TEST(LateFrames, ThatComeInPiecesDoNotDelayThoseBehindThem) {
  for (rt::Duration begin = 1995ms; begin < 2012ms; begin += 170us) {
    for (const rt::Duration length : {rt::Duration{4ms}, rt::Duration{9ms}, rt::Duration{14ms}}) {
      const Driven run = drive(stall(begin, length), 300);
      EXPECT_EQ(run.frames.good, run.sent) << begin.count() << ' ' << length.count();
      EXPECT_EQ(run.frames.lost + run.frames.bad, 0U) << begin.count() << ' ' << length.count();
      EXPECT_LE(most_commands_in_a_tick(run), 1) << begin.count() << ' ' << length.count();
      EXPECT_TRUE(is_on_time_from(run, 137)) << begin.count() << ' ' << length.count();
    }
  }
}

TEST(LateFrames, AreCountedOnceEach) {
  const Driven run = drive(stall(2009ms, 9ms), 300);
  EXPECT_EQ(run.frames.late, 1U);
}

}  // namespace
}  // namespace cargobay::hal
