// The velocity that the loop uses compared with the obvious one, distance divided by time between
// arrivals, on a line that delays frames by up to 6 ms, 3 ms on average, and holds all of them up
// for 80 ms now and then.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/random.hpp"
#include "hal/sim/robot/device.hpp"
#include "oi/dialect.hpp"
#include "oi/stream_budget.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/unchecked.hpp"
#include "tests/hal/damaged_stream.hpp"
#include "tests/hal/held_stream.hpp"

namespace cargobay::hal {
namespace {

using std::chrono_literals::operator""ms;

constexpr int kFramesOfADrive = 800;
constexpr int kFramesToSettle = 67;  // frames before anything is judged: a second
constexpr double kMostDelay = 6e6;   // ns
constexpr rt::Duration kGap = 80ms;
constexpr std::int64_t kGapEvery = 150;  // ticks, on the average

// When bytes that arrive at a given time are delivered. The same seed holds up the same ticks.
class Delays {
 public:
  explicit Delays(std::uint64_t seed) : random_{seed} {}
  rt::TimePoint hand_over(rt::TimePoint arrival) {
    const std::int64_t tick = arrival.time_since_epoch() / oi::kTick;
    if (tick != tick_) {
      tick_ = tick;
      delay_ = rt::Duration{static_cast<std::int64_t>(random_.uniform() * kMostDelay)};
      if (random_.below(kGapEvery) == 0 && arrival > gap_end_) gap_end_ = arrival + kGap;
    }
    return std::max(arrival + delay_, gap_end_);
  }

 private:
  hal::sim::Random random_;
  std::int64_t tick_ = 0;
  rt::Duration delay_{0};
  rt::TimePoint gap_end_{};
};

// Distance and angle divided by the time since the last arrival; simultaneous arrivals are merged.
class ByArrival {
 public:
  void take(std::span<const std::uint8_t> bytes, rt::TimePoint now) {
    double distance_mm = 0.0;
    double angle_deg = 0.0;
    bool any = false;
    for (const std::uint8_t byte : bytes) {
      if (decoder_.push(byte) != oi::StreamDecoder::Outcome::frame) continue;
      oi::SensorValues values;
      if (!oi::decode_frame(decoder_.frame(), values) || !values.has(oi::PacketId::distance))
        continue;
      any = true;
      distance_mm += values.distance().value;
      angle_deg += values.angle().value;
    }
    if (!any) return;
    const double seconds = rt::seconds(now - last_);
    last_ = now;
    const double mean_mm_s = distance_mm / seconds;
    const double half_turn_mm_s =
        angle_deg * std::numbers::pi / 180.0 * oi::kCreate.wheel_base_mm / 2.0 / seconds;
    speeds_ = {mean_mm_s - half_turn_mm_s, mean_mm_s + half_turn_mm_s};
  }
  const rt::WheelSpeeds& speeds() const { return speeds_; }

 private:
  oi::StreamDecoder decoder_{};
  rt::TimePoint last_{};
  rt::WheelSpeeds speeds_{};
};

enum class Reads { as_the_loop_wants, every_frame };

// Of both wheels, over one drive: sums of squares against the truth.
struct SpeedErrors {
  double estimate = 0.0;
  double by_arrival = 0.0;
  int count = 0;
};

class Drive {
 public:
  Drive(sim::Remainder kind, const rt::WheelSpeeds& target, std::uint64_t seed)
      : target_{target}, device_{{.remainder = kind, .seed = seed}}, delays_{seed} {
    held_.hand_over = [this](rt::TimePoint arrival) { return delays_.hand_over(arrival); };
    tap_.damage = [this](std::span<std::uint8_t> bytes) {
      by_arrival_.take(bytes, tap_.now());
      return bytes.size();
    };
    device_.on_tick = [this](const sim::Device& robot) { truth_ = robot.truth().speeds; };
  }

  SpeedErrors run(Reads reads) {
    EXPECT_TRUE(bring_up(tap_, {.packets = oi::kCreate.list(oi::FrameList::reading)}));
    EXPECT_FALSE(tap_.set_wake_threshold(oi::kCreate.frame_bytes));
    ControlCycle::Parameters parameters;
    parameters.loop.estimator.input_delay_s =
        rt::seconds(oi::wire_time(oi::kCreate.frame_bytes + oi::kDriveDirectBytes, tap_.baud()));
    if (reads == Reads::every_frame) {
      parameters.loop.estimator.remainder = rt::Remainder::carried;
      parameters.loop.schedule.recheck_carried_ticks = 1'000'000;
      parameters.loop.feedback = rt::WheelLoop::Feedback::open;
      parameters.on_implausible = OnImplausible::report;  // of a kind that it is not
    }
    const auto cycle = std::make_unique<ControlCycle>(tap_, parameters);
    cycle_ = cycle.get();
    cycle_->set_control({.function = &Drive::control, .context = this});
    EXPECT_EQ(cycle_->run(), CycleEnd::asked);
    EXPECT_EQ(cycle_->frames().bad + cycle_->frames().lost, 0U);
    return errors_;
  }

 private:
  static ControlAnswer control(void* context, const CycleState& state, double /*seconds*/)
      CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<Drive*>(context);
    self.judge(state.estimate);
    return self.target_;
  }
  void judge(const rt::WheelSpeeds& estimate) CARGOBAY_NONBLOCKING {
    if (++frames_ == kFramesOfADrive) cycle_->request_stop();
    if (frames_ < kFramesToSettle) return;
    errors_.estimate += square(estimate);
    errors_.by_arrival += square(by_arrival_.speeds());
    errors_.count += 2;
  }
  double square(const rt::WheelSpeeds& speeds) const CARGOBAY_NONBLOCKING {
    const double left_mm_s = speeds.left_mm_s - truth_.left_mm_s;
    const double right_mm_s = speeds.right_mm_s - truth_.right_mm_s;
    return left_mm_s * left_mm_s + right_mm_s * right_mm_s;
  }

  rt::WheelSpeeds target_;
  sim::Device device_;
  sim::VirtualLink link_{device_};
  test::HeldStream held_{link_};
  test::DamagedStream tap_{held_};  // damages nothing
  Delays delays_;
  ByArrival by_arrival_{};
  ControlCycle* cycle_ = nullptr;
  rt::WheelSpeeds truth_{};
  int frames_ = 0;
  SpeedErrors errors_{};
};

void compare(sim::Remainder kind) {
  double estimate = 0.0;
  double by_arrival = 0.0;
  int count = 0;
  for (int eighth = 1; eighth <= 8; ++eighth) {
    const double speed = 50.0 * eighth;
    for (const rt::WheelSpeeds& target :
         {rt::WheelSpeeds{speed, speed}, {-speed, -speed}, {-speed, speed}, {0.5 * speed, speed}}) {
      const auto seed = static_cast<std::uint64_t>(eighth);
      const SpeedErrors ours = Drive{kind, target, seed}.run(Reads::as_the_loop_wants);
      const SpeedErrors naive = Drive{kind, target, seed}.run(Reads::every_frame);
      estimate += ours.estimate / ours.count;
      by_arrival += naive.by_arrival / naive.count;
      ++count;
    }
  }
  const double estimate_mm_s = std::sqrt(estimate / count);
  const double by_arrival_mm_s = std::sqrt(by_arrival / count);
  std::printf("rms error of velocity: estimate %.1f mm/s, by arrival %.1f mm/s, ratio %.0f\n",
              estimate_mm_s, by_arrival_mm_s, by_arrival_mm_s / estimate_mm_s);
  EXPECT_GE(by_arrival_mm_s, 10.0 * estimate_mm_s);
}

TEST(VelocityError, IsATenthOfThatByArrivalWhereTheRemainderIsCarried) {
  compare(sim::Remainder::carried);
}

TEST(VelocityError, IsATenthOfThatByArrivalWhereTheRemainderIsLost) {
  compare(sim::Remainder::lost);
}

}  // namespace
}  // namespace cargobay::hal
