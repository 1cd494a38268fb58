// How certain a percentile, or the ratio of two, is. Values close in time are alike, so single
// values must not be drawn; whole slices are ("block bootstrap", H. Künsch, 1989).
#pragma once

#include <cstdint>
#include <span>

#include "hal/jitter/channel.hpp"

namespace cargobay::hal::jitter {

// With 95 % between low and high; all 0 if there is no data.
struct Estimate {
  double value = 0.0;
  double low = 0.0;
  double high = 0.0;
};

// Of all values in all slices: the smallest that `percent` of them do not exceed. Allocates.
double percentile(std::span<const Slice> slices, double percent);

inline constexpr std::uint64_t kSeed = 1;
inline constexpr int kDraws = 400;

// Percentile of `a` over that of `b`. The same seed gives the same result. Allocates; each of the
// `draws` takes about as long as sorting all values.
Estimate ratio_of_percentiles(std::span<const Slice> a, std::span<const Slice> b, double percent,
                              std::uint64_t seed = kSeed, int draws = kDraws);

}  // namespace cargobay::hal::jitter
