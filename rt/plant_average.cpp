// What the models of a bank say together.
#include <algorithm>
#include <cmath>
#include <utility>

#include "rt/plant_bank.hpp"

namespace cargobay::rt {
namespace {

// Whatever the readings say, no motor is as weak or as strong.
constexpr double kWeakestGain = 0.4;
constexpr double kStrongestGain = 1.4;
constexpr float kNegligible = 1e-4F;
constexpr std::size_t kParts = PlantModels::kParts;

}  // namespace

void PlantBank::conclude() CARGOBAY_NONBLOCKING {
  if (std::exchange(concluded_, true)) return;
  Lags of_lags{};
  float whole = 0.0F;
  double dead_time_s = 0.0;
  double ramp_s2_mm = 0.0;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    for (std::size_t part = 0; part < kParts; ++part) of_lags[part] += weight_[drive][part];
    whole += drive_weight_[drive];
    dead_time_s += drive_weight_[drive] * grid_.dead_time_of(drive * PlantModels::kLags);
    ramp_s2_mm += drive_weight_[drive] * grid_.ramp_of(drive * PlantModels::kLags);
  }
  for (Lags& lags : weight_) {
    for (Lanes& part : lags) part /= whole;
  }
  double lag_s = 0.0;
  double square = 0.0;
  for (std::size_t lag = 0; lag < PlantModels::kLags; ++lag) {
    const double weight = of_lags[lag / kLanes][lag % kLanes];
    lag_s += weight * grid_.lag_s[lag];
    square += weight * grid_.lag_s[lag] * grid_.lag_s[lag];
  }
  lag_s /= whole;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    drive_weight_[drive] /= whole;
    drive_weights_[drive / PlantModels::kRamps][drive % PlantModels::kRamps] = drive_weight_[drive];
  }
  estimate_.lag_s = lag_s;
  estimate_.lag_sd_s = std::sqrt(std::max(0.0, square / whole - lag_s * lag_s));
  estimate_.dead_time_s = dead_time_s / whole;
  estimate_.ramp_s2_mm = ramp_s2_mm / whole;
  average_gains();
}

void PlantBank::average_gains() CARGOBAY_NONBLOCKING {
  // Around what it was, so that little is lost to rounding.
  const auto was_left = static_cast<float>(estimate_.gain_left);
  const auto was_right = static_cast<float>(estimate_.gain_right);
  Lanes weights{};
  Lanes lefts{};
  Lanes rights{};
  Lanes left_left{};
  Lanes left_right{};
  Lanes right_right{};
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    if (drive_weight_[drive] < kNegligible) continue;
    for (std::size_t part = 0; part < kParts; ++part) {
      const Lanes weight = weight_[drive][part];
      const Lanes left = gain_[0][drive][part] - was_left;
      const Lanes right = gain_[1][drive][part] - was_right;
      weights += weight;
      lefts += weight * left;
      rights += weight * right;
      left_left += weight * (left * left + covariance_.left_left[drive][part]);
      left_right += weight * (left * right + covariance_.left_right[drive][part]);
      right_right += weight * (right * right + covariance_.right_right[drive][part]);
    }
  }
  const float whole = rt::sum(weights);
  const float left = rt::sum(lefts) / whole;
  const float right = rt::sum(rights) / whole;
  estimate_.gain_left =
      std::clamp(static_cast<double>(was_left + left), kWeakestGain, kStrongestGain);
  estimate_.gain_right =
      std::clamp(static_cast<double>(was_right + right), kWeakestGain, kStrongestGain);
  state_spread(rt::sum(left_left) / whole - left * left, rt::sum(left_right) / whole - left * right,
               rt::sum(right_right) / whole - right * right);
}

// Of both gains together, in proportion to their commands: in a straight line the difference
// between them is not known as well, but does not matter as much.
void PlantBank::state_spread(float left_left, float left_right, float right_right)
    CARGOBAY_NONBLOCKING {
  const auto sd = [&](float left, float right) CARGOBAY_NONBLOCKING {
    const float variance =
        left * left * left_left + 2.0F * left * right * left_right + right * right * right_right;
    return std::sqrt(static_cast<double>(std::max(variance, 0.0F)));
  };
  const auto& newest = models_.command();
  const float all = std::abs(newest[0]) + std::abs(newest[1]);
  const float left = all > 0.0F ? std::abs(newest[0]) / all : 0.5F;
  estimate_.gain_sd = sd(left, 1.0F - left);
  estimate_.gain_difference_sd = sd(-1.0F, 1.0F);
  estimate_.gain_left_sd = sd(1.0F, 0.0F);
  estimate_.gain_right_sd = sd(0.0F, 1.0F);
}

}  // namespace cargobay::rt
