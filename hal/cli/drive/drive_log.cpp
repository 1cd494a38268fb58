#include "hal/cli/drive/drive_log.hpp"

#include <algorithm>
#include <cmath>

#include "oi/limits.hpp"

namespace cargobay::cli {
namespace {

constexpr double kSettled = 1.0;  // seconds

using Member = double rt::WheelSpeeds::*;

double speed(const DriveSample& sample, Member wheel) {
  return sample.truth.value_or(sample.estimate).*wheel;
}

class Mean {
 public:
  void add(double value) {
    sum_ += value;
    ++count_;
  }
  double value() const { return count_ == 0 ? 0.0 : sum_ / count_; }
  bool empty() const { return count_ == 0; }

 private:
  double sum_ = 0.0;
  int count_ = 0;
};

// Stretches of one set speed, each judged by its mean error once the speed has settled.
Mean steady_squares(const std::vector<DriveSample>& samples, Member wheel) {
  Mean squares;
  Mean stretch;
  double since_s = 0.0;
  const auto close = [&] {
    if (!stretch.empty()) squares.add(stretch.value() * stretch.value());
    stretch = {};
  };
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (i == 0 || samples[i].set != samples[i - 1].set) {
      close();
      since_s = samples[i].time_s;
    }
    if (samples[i].time_s - since_s >= kSettled)
      stretch.add(speed(samples[i], wheel) - samples[i].set.*wheel);
  }
  close();
  return squares;
}

WheelFigures wheel_figures(const std::vector<DriveSample>& samples, Member wheel) {
  Mean set;
  Mean estimate;
  Mean truth;
  Mean tracking;
  Mean estimating;
  for (const DriveSample& sample : samples) {
    set.add(sample.set.*wheel);
    estimate.add(sample.estimate.*wheel);
    truth.add(speed(sample, wheel));
    tracking.add(std::pow(speed(sample, wheel) - sample.set.*wheel, 2));
    if (sample.time_s >= kSettled)
      estimating.add(std::pow(sample.estimate.*wheel - speed(sample, wheel), 2));
  }
  return {.mean_set_mm_s = set.value(),
          .mean_estimate_mm_s = estimate.value(),
          .mean_truth_mm_s = truth.value(),
          .steady_error_mm_s = std::sqrt(steady_squares(samples, wheel).value()),
          .tracking_rmse_mm_s = std::sqrt(tracking.value()),
          .estimate_rmse_mm_s = std::sqrt(estimating.value())};
}

}  // namespace

std::vector<DriveSample> join(const std::vector<hal::CycleState>& states,
                              const std::vector<hal::sim::TruthSample>& truth) {
  std::vector<DriveSample> samples;
  samples.reserve(states.size());
  std::size_t next = 0;
  rt::TimePoint former{};
  if (!states.empty()) former = states.front().arrival - oi::kTick;
  for (const hal::CycleState& state : states) {
    while (next < truth.size() && truth[next].time <= state.arrival) ++next;
    DriveSample sample{.time_s = static_cast<double>(state.tick) * 0.015,
                       .interval_ms = 1e3 * rt::seconds(state.arrival - former),
                       .set = state.set,
                       .estimate = state.estimate,
                       .command = state.command};
    former = state.arrival;
    if (next > 0) sample.truth = truth[next - 1].speeds;
    samples.push_back(sample);
  }
  return samples;
}

DriveFigures figures(const std::vector<DriveSample>& samples) {
  const auto has_truth = [](const DriveSample& sample) { return sample.truth.has_value(); };
  return {.left = wheel_figures(samples, &rt::WheelSpeeds::left_mm_s),
          .right = wheel_figures(samples, &rt::WheelSpeeds::right_mm_s),
          .has_truth = !samples.empty() && std::all_of(samples.begin(), samples.end(), has_truth),
          .has_steady = !steady_squares(samples, &rt::WheelSpeeds::left_mm_s).empty()};
}

}  // namespace cargobay::cli
