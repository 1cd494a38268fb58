// Percentiles of what a channel measured, their ratios, and how certain they are.
// docs/statistics.md says what is estimated, by which method, and how often the intervals hold.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "hal/jitter/channel.hpp"

namespace cargobay::hal::jitter {

struct Interval {
  double low = 0.0;
  double high = 0.0;
};

// Why there is no interval: it would claim a certainty that the data do not hold.
enum class Lack : std::uint8_t {
  nothing,
  slices,      // fewer than kLeastSlices
  values,      // fewer than kLeastBeyond values on either side of the percentile
  steadiness,  // slices resemble their neighbours so much that fewer than kLeastIndependent count
  time,        // the user waits, and there are many values
  unknown,     // of a run whose file does not say
};
// One word each, as above. A static string.
std::string_view name(Lack lack);

inline constexpr std::size_t kLeastSlices = 30;
inline constexpr double kLeastBeyond = 200.0;
inline constexpr double kLeastIndependent = 10.0;

struct Estimate {
  double value = 0.0;                  // of a percentile, in nanoseconds; 0 if there are no data
  std::optional<Interval> interval{};  // 95 %; around `value`
  Lack lack = Lack::slices;            // nothing if there is an interval
  std::vector<double> off{};           // of each batch of slices: its share beyond, off the mean's
};

// All values of a channel, corrected for coordinated omission: what was omitted counts as
// Histogram::omitted() says, but never as less than the least that was measured. One thread.
class Sample {
 public:
  // Copies the values, 4 bytes each; `slices` outlive it. `period_ns` is not 0.
  Sample(std::span<const Slice> slices, std::uint64_t period_ns);

  std::size_t count() const { return pool_.size(); }
  // The smallest value that at least `percent` (0 to 100) of all do not exceed, in nanoseconds; 0
  // if there are none. Takes time in proportion to their number, as estimate() does.
  double percentile(double percent);
  // With its interval, if there is enough. `percent` is above 0 and below 100.
  Estimate estimate(double percent);

 private:
  struct Spread;  // of the share beyond a value, from batch to batch

  Spread spread_beyond(double value) const;

  std::span<const Slice> slices_;
  std::uint64_t period_ns_;
  float least_ = 0.0F;
  std::vector<float> pool_;  // reordered by each percentile
};

// How much both rise and fall together, -1 to 1: for channels that took turns in one run. 0 for
// different numbers of slices.
double correlation(const Estimate& a, const Estimate& b);

// `a` over `b`, with an interval if both have one; `together` is their correlation, and 0 for runs
// at different times. All 0 if `b` is 0.
Estimate ratio(const Estimate& a, const Estimate& b, double together = 0.0);

// Student's t: with `freedom` degrees of freedom, 2 or more, 95 % lie between -t and t. To 0.03
// from 3 degrees on.
double student_t95(double freedom);

}  // namespace cargobay::hal::jitter
