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
  Models likely{};
  double whole = 0.0;
  for (std::size_t i = 0; i < PlantModels::kCount; ++i) {
    const double likelihood = expected_from(prior, i);
    PlantModels::set(likely, i, likelihood);
    whole += likelihood;
  }
  constexpr double kLeast = 1e-6;
  if (!(whole > kLeast)) return;  // no model is like that
  for (std::size_t i = 0; i < PlantModels::kCount; ++i) {
    const double trusted = kTrust * static_cast<double>(PlantModels::of(likely, i)) / whole;
    const double weight =
        trusted + (1.0 - kTrust) * static_cast<double>(PlantModels::of(prior_, i));
    PlantModels::set(weight_, i, weight);
    mix_gains(prior, i, trusted / weight);
  }
  sum_drives();
  concluded_ = false;
  conclude();
}

double PlantBank::expected_from(const LearntPlant& prior, std::size_t model) const
    CARGOBAY_NONBLOCKING {
  const double lag_sd = std::max(prior.lag_sd_s / prior.lag_s, kLeastLagSd);
  const double dead_time_sd_s = std::max(prior.dead_time_sd_s, kLeastDeadTimeSdS);
  const double ramp_sd_s2_mm = std::max(prior.ramp_sd_s2_mm, kLeastRampSdS2Mm);
  const double off = square(std::log(grid_.lag_of(model) / prior.lag_s) / lag_sd) +
                     square((grid_.dead_time_of(model) - prior.dead_time_s) / dead_time_sd_s) +
                     square((grid_.ramp_of(model) - prior.ramp_s2_mm) / ramp_sd_s2_mm);
  return std::exp(-0.5 * off);
}

// The prior has this share of the model's weight.
void PlantBank::mix_gains(const LearntPlant& prior, std::size_t model, double share)
    CARGOBAY_NONBLOCKING {
  const Mixed mixed{share};
  const double left_sd = std::max(prior.gain_left_sd, kLeastGainSd);
  const double right_sd = std::max(prior.gain_right_sd, kLeastGainSd);
  const auto left = static_cast<double>(PlantModels::of(gain_[0], model));
  const auto right = static_cast<double>(PlantModels::of(gain_[1], model));
  const double left_off = prior.gain_left - left;
  const double right_off = prior.gain_right - right;
  PlantModels::set(gain_[0], model, mixed.mean(prior.gain_left, left));
  PlantModels::set(gain_[1], model, mixed.mean(prior.gain_right, right));
  const auto mix = [&](Models& models, double of_prior, double between) CARGOBAY_NONBLOCKING {
    const auto value = static_cast<double>(PlantModels::of(models, model));
    PlantModels::set(models, model, mixed.covariance(of_prior, value) + mixed.between() * between);
  };
  mix(covariance_.left_left, square(left_sd), square(left_off));
  mix(covariance_.right_right, square(right_sd), square(right_off));
  mix(covariance_.left_right, kGainCorrelation * left_sd * right_sd, left_off * right_off);
}

LearntPlant PlantBank::learnt() const CARGOBAY_NONBLOCKING {
  double dead_time = 0.0;
  double ramp = 0.0;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    const auto weight = static_cast<double>(drive_weight_[drive]);
    const std::size_t model = drive * PlantModels::kLags;  // the lag does not matter
    dead_time += weight * square(grid_.dead_time_of(model) - estimate_.dead_time_s);
    ramp += weight * square(grid_.ramp_of(model) - estimate_.ramp_s2_mm);
  }
  return {.lag_s = estimate_.lag_s,
          .lag_sd_s = estimate_.lag_sd_s,
          .dead_time_s = estimate_.dead_time_s,
          .dead_time_sd_s = std::sqrt(dead_time),
          .ramp_s2_mm = estimate_.ramp_s2_mm,
          .ramp_sd_s2_mm = std::sqrt(ramp),
          .gain_left = estimate_.gain_left,
          .gain_left_sd = estimate_.gain_left_sd,
          .gain_right = estimate_.gain_right,
          .gain_right_sd = estimate_.gain_right_sd};
}

}  // namespace cargobay::rt
