// What a bank of plants hands to the next drive, and takes from an earlier one.
#include <algorithm>
#include <cmath>

#include "rt/plant_bank.hpp"

namespace cargobay::rt {
namespace {

// How far an earlier drive is believed. The rest of the weight begins as if there had been none:
// enough for a robot with other wheels to be learnt as quickly as without (docs/control.md).
constexpr double kTrust = 0.3;
// At least as wide as the grid is coarse, and as a battery or a floor changes from day to day.
constexpr double kLeastLagSd = 0.3;  // of its logarithm
constexpr double kLeastDeadTimeSdS = 0.020;
constexpr double kLeastRampSdS2Mm = 0.0005;
constexpr double kLeastGainSd = 0.07;
constexpr double kGainCorrelation = 0.5;

double square(double value) CARGOBAY_NONBLOCKING { return value * value; }

// Two normal distributions as one, the first with `share` of the weight.
struct Mixed {
  double share;
  double between() const CARGOBAY_NONBLOCKING { return share * (1.0 - share); }
  double mean(double first, double second) const CARGOBAY_NONBLOCKING {
    return second + share * (first - second);
  }
  double covariance(double first, double second) const CARGOBAY_NONBLOCKING {
    return share * first + (1.0 - share) * second;
  }
};

}  // namespace

// Each model mixes what it began with and the prior, by the shares of its weight that come from
// either. Models far from the prior know nothing of it: if it is wrong, they have the weight within
// a few readings.
void PlantBank::begin_from(const LearntPlant& prior) CARGOBAY_NONBLOCKING {
  if (parameters_.told) return;
  const double lag_sd = std::max(prior.lag_sd_s / prior.lag_s, kLeastLagSd);
  const double dead_time_sd_s = std::max(prior.dead_time_sd_s, kLeastDeadTimeSdS);
  const double ramp_sd_s2_mm = std::max(prior.ramp_sd_s2_mm, kLeastRampSdS2Mm);
  Values likely{};
  double whole = 0.0;
  for (std::size_t i = 0; i < kModels; ++i) {
    const auto lag_s = static_cast<double>(grid_.lag_s[i]);
    const auto ramp_s2_mm = static_cast<double>(grid_.ramp_s2_mm[i]);
    const double off =
        square(std::log(lag_s / prior.lag_s) / lag_sd) +
        square((grid_.dead_time_s[i / kGroup] - prior.dead_time_s) / dead_time_sd_s) +
        square((ramp_s2_mm - prior.ramp_s2_mm) / ramp_sd_s2_mm);
    likely[i] = static_cast<float>(std::exp(-0.5 * off));
    whole += static_cast<double>(likely[i]);
  }
  constexpr double kLeast = 1e-6;
  if (!(whole > kLeast)) return;  // no model is like that
  const double left_sd = std::max(prior.gain_left_sd, kLeastGainSd);
  const double right_sd = std::max(prior.gain_right_sd, kLeastGainSd);
  for (std::size_t i = 0; i < kModels; ++i) {
    const double trusted = kTrust * static_cast<double>(likely[i]) / whole;
    const double weight = trusted + (1.0 - kTrust) * static_cast<double>(grid_.prior[i]);
    const Mixed mixed{trusted / weight};
    weight_[i] = static_cast<float>(weight);
    float& left = wheels_[0].gain[i];
    float& right = wheels_[1].gain[i];
    const double left_off = prior.gain_left - static_cast<double>(left);
    const double right_off = prior.gain_right - static_cast<double>(right);
    left = static_cast<float>(mixed.mean(prior.gain_left, static_cast<double>(left)));
    right = static_cast<float>(mixed.mean(prior.gain_right, static_cast<double>(right)));
    const auto mix = [&](float& value, double of_prior, double between) CARGOBAY_NONBLOCKING {
      value = static_cast<float>(mixed.covariance(of_prior, static_cast<double>(value)) +
                                 mixed.between() * between);
    };
    mix(covariance_.left_left[i], square(left_sd), square(left_off));
    mix(covariance_.right_right[i], square(right_sd), square(right_off));
    mix(covariance_.left_right[i], kGainCorrelation * left_sd * right_sd, left_off * right_off);
  }
  average();
}

LearntPlant PlantBank::learnt() const CARGOBAY_NONBLOCKING {
  double dead_time = 0.0;
  double ramp = 0.0;
  double left = 0.0;
  double right = 0.0;
  // The estimate's gains are within bounds; these are what the variances are about.
  double left_mean = 0.0;
  double right_mean = 0.0;
  for (std::size_t i = 0; i < kModels; ++i) {
    left_mean += static_cast<double>(weight_[i] * wheels_[0].gain[i]);
    right_mean += static_cast<double>(weight_[i] * wheels_[1].gain[i]);
  }
  for (std::size_t i = 0; i < kModels; ++i) {
    const auto weight = static_cast<double>(weight_[i]);
    dead_time += weight * square(grid_.dead_time_s[i / kGroup] - estimate_.dead_time_s);
    ramp += weight * square(static_cast<double>(grid_.ramp_s2_mm[i]) - estimate_.ramp_s2_mm);
    left += weight * (square(static_cast<double>(wheels_[0].gain[i]) - left_mean) +
                      static_cast<double>(covariance_.left_left[i]));
    right += weight * (square(static_cast<double>(wheels_[1].gain[i]) - right_mean) +
                       static_cast<double>(covariance_.right_right[i]));
  }
  return {.lag_s = estimate_.lag_s,
          .lag_sd_s = estimate_.lag_sd_s,
          .dead_time_s = estimate_.dead_time_s,
          .dead_time_sd_s = std::sqrt(dead_time),
          .ramp_s2_mm = estimate_.ramp_s2_mm,
          .ramp_sd_s2_mm = std::sqrt(ramp),
          .gain_left = estimate_.gain_left,
          .gain_left_sd = std::sqrt(std::max(left, 0.0)),
          .gain_right = estimate_.gain_right,
          .gain_right_sd = std::sqrt(std::max(right, 0.0))};
}

}  // namespace cargobay::rt
