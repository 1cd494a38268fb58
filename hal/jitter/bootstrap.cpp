#include "hal/jitter/bootstrap.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace cargobay::hal::jitter {
namespace {

// The requested percentile of all values in `pool`, which is reordered.
double percentile_of(std::vector<std::uint32_t>& pool, double percent) {
  if (pool.empty()) return 0.0;
  const auto count = static_cast<double>(pool.size());
  const double rank = std::ceil(percent / 100.0 * count - 1e-9 * count);
  const auto index = static_cast<std::ptrdiff_t>(std::clamp(rank, 1.0, count)) - 1;
  std::nth_element(pool.begin(), pool.begin() + index, pool.end());
  return static_cast<double>(pool[static_cast<std::size_t>(index)]);
}

// Draws as many slices as there are, with replacement.
class Draw {
 public:
  Draw(std::span<const Slice> slices, std::mt19937_64& random) : slices_{slices}, random_{random} {}

  double percentile(double percent) {
    std::uniform_int_distribution<std::size_t> any{0, slices_.size() - 1};
    pool_.clear();
    for (std::size_t i = 0; i < slices_.size(); ++i) {
      const std::vector<std::uint32_t>& slice = slices_[any(random_)].headline_ns;
      pool_.insert(pool_.end(), slice.begin(), slice.end());
    }
    return percentile_of(pool_, percent);
  }

 private:
  std::span<const Slice> slices_;
  std::mt19937_64& random_;
  std::vector<std::uint32_t> pool_;
};

}  // namespace

double percentile(std::span<const Slice> slices, double percent) {
  std::vector<std::uint32_t> pool;
  for (const Slice& slice : slices)
    pool.insert(pool.end(), slice.headline_ns.begin(), slice.headline_ns.end());
  return percentile_of(pool, percent);
}

Estimate ratio_of_percentiles(std::span<const Slice> a, std::span<const Slice> b, double percent,
                              std::uint64_t seed, int draws) {
  const double below = percentile(b, percent);
  if (a.empty() || b.empty() || below <= 0.0) return {};
  std::mt19937_64 random{seed};
  Draw of_a{a, random};
  Draw of_b{b, random};
  std::vector<double> ratios;
  for (int i = 0; i < draws; ++i) {
    const double over = of_a.percentile(percent);
    ratios.push_back(over / std::max(1.0, of_b.percentile(percent)));
  }
  std::sort(ratios.begin(), ratios.end());
  const auto at = [&ratios](double share) {
    return ratios[static_cast<std::size_t>(share * static_cast<double>(ratios.size() - 1))];
  };
  return {.value = percentile(a, percent) / below, .low = at(0.025), .high = at(0.975)};
}

}  // namespace cargobay::hal::jitter
