#include "hal/robot/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "oi/limits.hpp"
#include "rt/wheel_loop.hpp"

namespace cargobay::hal {
namespace {

constexpr double kTickSeconds = rt::seconds(oi::kTick);

constexpr double kLeastLag = 0.02;  // seconds
constexpr double kMostLag = 0.5;

std::string whole(double value) { return std::to_string(std::lround(value)); }

}  // namespace

void Calibration::prepare(CycleParameters& parameters) {
  constexpr double kAtOnce = 1e6;  // mm/s^2: the step is the robot's to answer
  parameters.loop.feedback = rt::WheelLoop::Feedback::open;
  parameters.on_implausible = OnImplausible::report;  // it says by itself what does not turn
  parameters.loop.limits = {.acceleration_mm_s2 = kAtOnce};
  parameters.loop.estimator.remainder.reset();  // so that there are series of readings and windows
  // Nothing depends on reading soon, and each reading of a robot that loses the remainder costs up
  // to a degree.
  parameters.loop.schedule.least_window_ticks = 20;
  parameters.loop.schedule.window_ticks = 200;
}

double Calibration::duration_s() CARGOBAY_NONBLOCKING { return begin_of(kLegs.size()); }

double Calibration::begin_of(std::size_t leg) CARGOBAY_NONBLOCKING {
  double begin_s = kSettle;
  for (std::size_t i = 0; i < leg; ++i) begin_s += kLegs[i].drive_s + kSettle;
  return begin_s;
}

rt::WheelSpeeds Calibration::at(double seconds) const CARGOBAY_NONBLOCKING {
  double begin_s = kSettle;
  for (const Leg& leg : kLegs) {
    if (seconds >= begin_s && seconds < begin_s + leg.drive_s)
      return {leg.left * speed_mm_s_, leg.right * speed_mm_s_};
    begin_s += leg.drive_s + kSettle;
  }
  return {};
}

void Calibration::see(const CycleState& state) {
  ticks_.push_back({.number = state.tick, .command = state.command, .reading = state.reading});
}

Calibration::Estimate Calibration::estimate(const rt::WheelEstimator::Parameters& parameters,
                                            Ways* ways) const {
  rt::WheelEstimator estimator{parameters};
  rt::WheelSpeeds command;
  Way way;
  std::int64_t last = ticks_.front().number - 1;
  for (const Tick& tick : ticks_) {
    for (; last + 1 < tick.number; ++last) estimator.step_lost(command, rt::kBothAxes);
    estimator.step(command, tick.reading);
    const rt::Travels travels = estimator.take_travels();
    const bool lost = parameters.remainder == rt::Remainder::lost;
    const rt::Travel& travel = lost ? travels.if_lost : travels.if_carried;
    way.distance_mm += travel.distance_mm;
    way.turn_rad += travel.turn_rad;
    if (ways != nullptr) ways->push_back(way);
    command = tick.command;
    last = tick.number;
  }
  return {.log_likelihood = estimator.log_likelihood(), .plant = estimator.plant()};
}

// By golden-section search: with all else fixed, the likelihood has a single maximum.
double Calibration::likeliest_lag(rt::WheelEstimator::Parameters parameters) const {
  constexpr int kSteps = 16;  // to 0.2 ms
  constexpr double kSection = 1.0 / std::numbers::phi;
  const auto likelihood = [&](double lag_s) {
    parameters.told->lag_s = lag_s;
    return estimate(parameters, nullptr).log_likelihood;
  };
  double low = kLeastLag;
  double high = kMostLag;
  double left = high - kSection * (high - low);
  double right = low + kSection * (high - low);
  double at_left = likelihood(left);
  double at_right = likelihood(right);
  for (int i = 0; i < kSteps; ++i) {
    if (at_left > at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - kSection * (high - low);
      at_left = likelihood(left);
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + kSection * (high - low);
      at_right = likelihood(right);
    }
  }
  return (low + high) / 2.0;
}

// The lag, beside whichever dead time and ramp go with it: one after the other, from none.
double Calibration::lag_of(rt::WheelEstimator::Parameters parameters,
                           const rt::PlantEstimate& plant) const {
  parameters.told = rt::PlantEstimate{.gain_left = plant.gain_left, .gain_right = plant.gain_right};
  parameters.told->lag_s = likeliest_lag(parameters);
  const auto choose = [&](double rt::PlantEstimate::* member, std::span<const double> values) {
    double most = -1e300;
    double best = 0.0;
    for (const double value : values) {
      (*parameters.told).*member = value;
      const double likelihood = estimate(parameters, nullptr).log_likelihood;
      if (likelihood <= most) continue;
      most = likelihood;
      best = value;
    }
    (*parameters.told).*member = best;
  };
  choose(&rt::PlantEstimate::dead_time_s, std::array{0.0, 0.015, 0.030, 0.045, 0.060, 0.075});
  choose(&rt::PlantEstimate::ramp_s2_mm,
         std::array{0.0, 1.0 / 1500.0, 1.0 / 1000.0, 1.0 / 600.0, 1.0 / 400.0, 1.0 / 275.0});
  return likeliest_lag(parameters);
}

Calibration::Way Calibration::between(const Ways& ways, double from_s, double to_s) const {
  const auto at = [&](double seconds) {
    const auto tick = std::ranges::find_if(ticks_, [seconds](const Tick& each) {
      return static_cast<double>(each.number) * kTickSeconds >= seconds;
    });
    const auto place = static_cast<std::size_t>(tick - ticks_.begin());
    return ways[std::min(place, ways.size() - 1)];
  };
  const Way from = at(from_s);
  const Way to = at(to_s);
  return {.distance_mm = to.distance_mm - from.distance_mm,
          .turn_rad = to.turn_rad - from.turn_rad};
}

Result<void> Calibration::measure_wheel_base(const Ways& ways, CalibrationResult& result) const {
  constexpr std::size_t kFirstTurn = 2;
  constexpr double kLeastTurn = 0.5;  // rad
  std::array<double, kLegs.size() - kFirstTurn> bases{};
  for (std::size_t i = 0; i < bases.size(); ++i) {
    const double begin_s = begin_of(kFirstTurn + i);
    const Way turn = between(ways, begin_s, begin_s + kTurn + 0.9 * kSettle);
    if (std::abs(turn.turn_rad) < kLeastTurn) {
      return Failure{"the robot hardly turned (" + whole(turn.turn_rad * 180.0 / std::numbers::pi) +
                     " degrees) when one wheel was driven; check that it is free to move"};
    }
    bases[i] = 2.0 * std::abs(turn.distance_mm / turn.turn_rad);
  }
  const auto [least, most] = std::ranges::minmax(bases);
  result.wheel_base_spread_mm = most - least;
  result.wheel_base_mm = 0.0;
  for (const double base : bases) result.wheel_base_mm += base / static_cast<double>(bases.size());
  return {};
}

// From the turns about each wheel, once the lag is over: the driven wheel goes twice as far as the
// robot.
Result<void> Calibration::measure_gain(const Ways& ways, CalibrationResult& result) const {
  constexpr double kLagOver = 2.0;  // seconds, even for the slowest
  double left_mm_s = 0.0;
  double right_mm_s = 0.0;
  for (std::size_t i = 0; i < kLegs.size(); ++i) {
    const Leg& leg = kLegs[i];
    if (leg.left * leg.right != 0.0) continue;
    const double begin_s = begin_of(i);
    const Way steady = between(ways, begin_s + kLagOver, begin_s + leg.drive_s);
    const double speed = 2.0 * std::abs(steady.distance_mm) / (leg.drive_s - kLagOver);
    if (speed < speed_mm_s_ / 4.0) {
      return Failure{"a wheel did " + whole(speed) + " mm/s where " + whole(speed_mm_s_) +
                     " were asked for; check that its wheels turn freely and its battery is full"};
    }
    (leg.left != 0.0 ? left_mm_s : right_mm_s) += speed / 2.0;  // to and fro
  }
  result.gain_left = left_mm_s / speed_mm_s_;
  result.gain_right = right_mm_s / speed_mm_s_;
  return {};
}

Result<CalibrationResult> Calibration::result(double delay_s,
                                              const std::optional<rt::LearntPlant>& prior) const {
  if (ticks_.empty() ||
      static_cast<double>(ticks_.back().number) * kTickSeconds < duration_s() - 0.5)
    return Failure{"the drive ended early; nothing was measured: try again"};
  rt::WheelEstimator::Parameters parameters{.input_delay_s = delay_s, .prior = prior};
  CalibrationResult result;
  // The wheel base converts degrees to millimetres, and so affects the rest.
  for (int round = 0; round < 2; ++round) {
    double most = -1e300;
    rt::PlantEstimate plant;
    for (const rt::Remainder kind : {rt::Remainder::carried, rt::Remainder::lost}) {
      rt::WheelEstimator::Parameters candidate = parameters;
      candidate.remainder = kind;
      const Estimate found = estimate(candidate, nullptr);
      if (found.log_likelihood <= most) continue;
      most = found.log_likelihood;
      parameters = candidate;
      plant = found.plant;
    }
    result.lag_s = lag_of(parameters, plant);
    Ways ways;
    (void)estimate(parameters, &ways);
    if (const auto done = measure_wheel_base(ways, result); !done) return done.failure();
    if (const auto done = measure_gain(ways, result); !done) return done.failure();
    parameters.wheel_base_mm = result.wheel_base_mm;
  }
  result.remainder = parameters.remainder == rt::Remainder::carried ? rt::RemainderBelief::carried
                                                                    : rt::RemainderBelief::lost;
  return result;
}

}  // namespace cargobay::hal
