#include "hal/jitter/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace cargobay::hal::jitter {
namespace {

constexpr std::size_t kMostBatches = 64;

// Calls `see` with each value of the slice and with what was omitted after it.
template <typename See>
void see_corrected(const Slice& slice, std::uint64_t period_ns, float least, See see) {
  for (const float value : slice.headline_ns) {
    see(value);
    const std::uint64_t more = rt::Histogram::omitted(static_cast<std::uint64_t>(value), period_ns);
    for (std::uint64_t i = 1; i <= more; ++i) {
      const double omitted = static_cast<double>(value) - static_cast<double>(i * period_ns);
      see(std::max(static_cast<float>(omitted), least));
    }
  }
}

double square(double x) { return x * x; }

// The share at which the log odds of `share` are moved by `step`.
double moved(double share, double step) {
  return 1.0 / (1.0 + std::exp(-(std::log(share / (1.0 - share)) + step)));
}

}  // namespace

std::string_view name(Lack lack) {
  switch (lack) {
    case Lack::nothing: return "nothing";
    case Lack::slices: return "slices";
    case Lack::values: return "values";
    case Lack::steadiness: return "steadiness";
    case Lack::time: return "time";
    case Lack::unknown: return "unknown";
  }
  return "";
}

// The expansion of Cornish and Fisher (Abramowitz and Stegun, 26.7.5).
double student_t95(double freedom) {
  constexpr double kZ = 1.959963985;
  constexpr double kZ2 = kZ * kZ;
  const double n = std::max(freedom, 2.0);
  const double g1 = (kZ2 + 1.0) * kZ / 4.0;
  const double g2 = ((5.0 * kZ2 + 16.0) * kZ2 + 3.0) * kZ / 96.0;
  const double g3 = (((3.0 * kZ2 + 19.0) * kZ2 + 17.0) * kZ2 - 15.0) * kZ / 384.0;
  return kZ + g1 / n + g2 / (n * n) + g3 / (n * n * n);
}

struct Sample::Spread {
  double error = 0.0;        // standard error of the share
  double independent = 0.0;  // as many independent batches would be as certain
  double freedom = 1.0;      // degrees of freedom of `error`
  std::vector<double> off{};
};

Sample::Sample(std::span<const Slice> slices, std::uint64_t period_ns)
    : slices_{slices}, period_ns_{period_ns}, least_{std::numeric_limits<float>::max()} {
  for (const Slice& slice : slices_) {
    for (const float value : slice.headline_ns) least_ = std::min(least_, value);
  }
  for (const Slice& slice : slices_)
    see_corrected(slice, period_ns_, least_, [this](float value) { pool_.push_back(value); });
}

double Sample::percentile(double percent) {
  if (pool_.empty()) return 0.0;
  const auto all = static_cast<double>(pool_.size());
  // 99.9 % of 1000 is the 999th, whatever floating point makes of it.
  const double rank = std::ceil(percent / 100.0 * all - 1e-9 * all);
  const auto index = static_cast<std::ptrdiff_t>(std::clamp(rank, 1.0, all)) - 1;
  std::nth_element(pool_.begin(), pool_.begin() + index, pool_.end());
  return static_cast<double>(pool_[static_cast<std::size_t>(index)]);
}

// Slices that follow each other are alike, so their number says too much: the first-order
// autocorrelation says by how much. Where few batches hold most of what lies beyond, their variance
// is uncertain itself: their kurtosis says how much freedom is left.
Sample::Spread Sample::spread_beyond(double value) const {
  const std::size_t together = (slices_.size() + kMostBatches - 1) / kMostBatches;
  const std::size_t batches = slices_.size() / together;
  std::vector<double> beyond(batches);
  std::vector<double> size(batches);
  for (std::size_t i = 0; i < slices_.size(); ++i) {
    const std::size_t batch = std::min(i / together, batches - 1);
    see_corrected(slices_[i], period_ns_, least_, [&](float each) {
      size[batch] += 1.0;
      if (static_cast<double>(each) > value) beyond[batch] += 1.0;
    });
  }
  const auto count = static_cast<double>(batches);
  const double all = std::accumulate(size.begin(), size.end(), 0.0);
  const double share = std::accumulate(beyond.begin(), beyond.end(), 0.0) / all;
  double squares = 0.0;
  double fourths = 0.0;
  double neighbours = 0.0;
  Spread spread;
  for (std::size_t i = 0; i < batches; ++i) {
    const double off = (beyond[i] - share * size[i]) * count / all;
    squares += square(off);
    fourths += square(square(off));
    if (i > 0) neighbours += off * spread.off.back();
    spread.off.push_back(off);
  }
  if (squares == 0.0) return {.independent = count, .freedom = count - 1.0, .off = spread.off};
  double alike = neighbours / squares;
  alike += (1.0 + 3.0 * alike) / count;  // that estimate's own bias (M. Kendall, 1954)
  // Less could be chance, and correcting it would make intervals too wide.
  alike = alike < 1.5 / std::sqrt(count) ? 0.0 : std::min(alike, 0.95);
  const double inflation = (1.0 + alike) / (1.0 - alike);
  const double excess = std::max(count * fourths / square(squares) - 3.0, 0.0);
  spread.error = std::sqrt(squares / (count - 1.0) / count * inflation);
  spread.independent = count / inflation;
  spread.freedom = 2.0 / (excess / count + 2.0 / std::max(spread.independent - 1.0, 1.0));
  return spread;
}

Estimate Sample::estimate(double percent) {
  Estimate estimate{.value = percentile(percent)};
  if (slices_.size() < kLeastSlices) return estimate;
  estimate.lack = Lack::values;
  const double beyond = 1.0 - percent / 100.0;
  const auto all = static_cast<double>(pool_.size());
  if (std::min(beyond, 1.0 - beyond) * all < kLeastBeyond) return estimate;
  const Spread spread = spread_beyond(estimate.value);
  estimate.lack = Lack::steadiness;
  if (spread.independent < kLeastIndependent) return estimate;
  const double step =
      student_t95(spread.freedom) * spread.error / (beyond * (1.0 - beyond));  // in log odds
  estimate.interval = {.low = percentile(100.0 * (1.0 - moved(beyond, step))),
                       .high = percentile(100.0 * (1.0 - moved(beyond, -step)))};
  estimate.lack = Lack::nothing;
  estimate.off = spread.off;
  return estimate;
}

double correlation(const Estimate& a, const Estimate& b) {
  if (a.off.size() != b.off.size()) return 0.0;
  const double both = std::inner_product(a.off.begin(), a.off.end(), b.off.begin(), 0.0);
  const auto squares = [](const Estimate& of) {
    return std::inner_product(of.off.begin(), of.off.end(), of.off.begin(), 0.0);
  };
  const double size = std::sqrt(squares(a) * squares(b));
  return size == 0.0 ? 0.0 : both / size;
}

// On logarithms, by G. Zou and A. Donner (2008): each side of the interval is as far off as the two
// that add up to it.
Estimate ratio(const Estimate& a, const Estimate& b, double together) {
  if (b.value <= 0.0) return {};
  Estimate estimate{.value = a.value / b.value};
  estimate.lack = a.interval ? b.lack : a.lack;
  if (!a.interval || !b.interval || a.value <= 0.0) return estimate;
  const auto above = [](const Estimate& of) { return std::log(of.interval->high / of.value); };
  const auto below = [](const Estimate& of) {
    return std::log(of.value / std::max(of.interval->low, 1.0));
  };
  const auto sum = [together](double x, double y) {
    return std::sqrt(std::max(0.0, square(x) + square(y) - 2.0 * together * x * y));
  };
  estimate.interval = {.low = estimate.value * std::exp(-sum(below(a), above(b))),
                       .high = estimate.value * std::exp(sum(above(a), below(b)))};
  return estimate;
}

}  // namespace cargobay::hal::jitter
