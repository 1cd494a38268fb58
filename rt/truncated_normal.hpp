// A normal distribution of which only an interval is possible.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

// Its moments, and how likely the interval was.
struct TruncatedNormal {
  double mean;
  double variance;
  double probability;
};

inline double normal_density(double z) CARGOBAY_NONBLOCKING {
  return std::exp(-0.5 * z * z) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
}

// Probability between a and b, a < b, without cancellation in the tails.
inline double normal_between(double a, double b) CARGOBAY_NONBLOCKING {
  if (a > 0.0) return normal_between(-b, -a);
  return 0.5 * (std::erfc(-b / std::numbers::sqrt2) - std::erfc(-a / std::numbers::sqrt2));
}

// `variance` above 0, `low` below `high`.
inline TruncatedNormal truncate(double mean, double variance, double low, double high)
    CARGOBAY_NONBLOCKING {
  constexpr double kTooFar = 1e-9;
  const double sd = std::sqrt(variance);
  const double a = (low - mean) / sd;
  const double b = (high - mean) / sd;
  const double probability = normal_between(a, b);
  if (probability < kTooFar) {  // all the remaining mass is at the nearer edge
    const double width = high - low;
    const double edge = mean < low ? low + 0.1 * width : high - 0.1 * width;
    return {edge, 0.01 * width * width, probability};
  }
  const double density_a = normal_density(a);
  const double density_b = normal_density(b);
  const double shift = (density_a - density_b) / probability;
  const double shrink = 1.0 + (a * density_a - b * density_b) / probability - shift * shift;
  return {mean + sd * shift, variance * std::clamp(shrink, 1e-6, 1.0), probability};
}

}  // namespace cargobay::rt
