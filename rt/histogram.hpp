// A histogram of durations in fixed memory: log-linear buckets, like HdrHistogram's. Each power of
// two is divided into 128 equal buckets, so a percentile is exact to 1/128 (0.8 %) of its value.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

class Histogram {
 public:
  // Values from this one up, about 18 minutes in nanoseconds, are counted in the last bucket.
  static constexpr std::uint64_t kMostValue = std::uint64_t{1} << 40U;

  // One thread records at a time; another may take a snapshot() meanwhile.
  void record(std::uint64_t value) CARGOBAY_NONBLOCKING {
    const std::size_t bucket = bucket_of(value);
    store(counts_[bucket], counts_[bucket] + 1);
    if (value < min_) store(min_, value);
    if (value > max_) store(max_, value);
    store(sum_, sum_ + value);
  }
  // A copy, taken while another thread records: every value recorded so far, and perhaps part of
  // the one being recorded.
  Histogram snapshot() const CARGOBAY_NONBLOCKING {
    Histogram copy;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      copy.counts_[i] = load(counts_[i]);
    }
    copy.min_ = load(min_);
    copy.max_ = load(max_);
    copy.sum_ = load(sum_);
    return copy;
  }
  // While one value was late, others were due every `interval`, had to wait too, and were not
  // measured: without them a stall of a thousand intervals would count as one late value
  // ("coordinated omission"). How many of them record_corrected() adds, by HdrHistogram's rule
  // (G. Tene, recordValueWithExpectedInterval): the value less one interval, less two, and so on,
  // as long as at least one interval is left. A shorter wait was within what is expected, and is
  // never made up. At most kMostOmitted; `interval` is not 0.
  static constexpr std::uint64_t kMostOmitted = 1'000'000;
  static constexpr std::uint64_t omitted(std::uint64_t value, std::uint64_t interval)
      CARGOBAY_NONBLOCKING {
    const std::uint64_t intervals = value / interval;
    return intervals < 2 ? 0 : std::min(intervals - 1, kMostOmitted);
  }
  // record() for something that is due every `interval` and waits for its turn, with what was
  // omitted meanwhile.
  void record_corrected(std::uint64_t value, std::uint64_t interval) CARGOBAY_NONBLOCKING {
    record(value);
    const std::uint64_t more = omitted(value, interval);
    for (std::uint64_t i = 1; i <= more; ++i) record(value - i * interval);
  }
  void merge(const Histogram& other) CARGOBAY_NONBLOCKING {
    for (std::size_t i = 0; i < kBuckets; ++i) counts_[i] += other.counts_[i];
    min_ = std::min(min_, other.min_);
    max_ = std::max(max_, other.max_);
    sum_ += other.sum_;
  }

  // Adds up the buckets, so that record() has no second counter to keep.
  std::uint64_t count() const CARGOBAY_NONBLOCKING {
    return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
  }
  // Exact. 0 if nothing was recorded.
  std::uint64_t min() const CARGOBAY_NONBLOCKING { return min_ == kNone ? 0 : min_; }
  std::uint64_t max() const CARGOBAY_NONBLOCKING { return max_; }

  double mean() const CARGOBAY_NONBLOCKING {
    const std::uint64_t all = count();
    return all == 0 ? 0.0 : static_cast<double>(sum_) / static_cast<double>(all);
  }

  // Calls `see(value, count)` for each bucket that is not empty, in ascending order: `value` is the
  // bucket's last, never above max().
  template <typename See>
  void visit(See see) const {
    for (std::size_t i = 0; i < kBuckets; ++i) {
      if (counts_[i] != 0) see(std::min(last_value_of(i), max_), counts_[i]);
    }
  }

  // The smallest value that at least `percent` (0 to 100) of the recorded ones do not exceed,
  // rounded up to the end of its bucket but never above max(). 0 if nothing was recorded.
  std::uint64_t percentile(double percent) const CARGOBAY_NONBLOCKING {
    // 99.9 % of 1000 is the 999th, whatever floating point makes of it.
    const double all = static_cast<double>(count());
    const double wanted = std::max(1.0, percent / 100.0 * all - 1e-9 * all);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      seen += counts_[i];
      if (static_cast<double>(seen) >= wanted) return std::min(last_value_of(i), max_);
    }
    return max_;
  }

 private:
  static constexpr unsigned kSubBits = 7;
  static constexpr std::uint64_t kSubBuckets = std::uint64_t{1} << kSubBits;
  static constexpr std::size_t kBuckets = (40 - kSubBits + 1) * kSubBuckets;

  // Relaxed: each number is read whole, and a snapshot promises no more.
  static void store(std::uint64_t& number, std::uint64_t value) CARGOBAY_NONBLOCKING {
    std::atomic_ref{number}.store(value, std::memory_order_relaxed);
  }
  // Before C++26 there is no atomic_ref to const; a load changes nothing.
  static std::uint64_t load(const std::uint64_t& number) CARGOBAY_NONBLOCKING {
    return std::atomic_ref{const_cast<std::uint64_t&>(number)}.load(std::memory_order_relaxed);
  }

  // The first 128 values have a bucket each; after them, 128 buckets for each power of two.
  static std::size_t bucket_of(std::uint64_t value) CARGOBAY_NONBLOCKING {
    const std::uint64_t held = std::min(value, kMostValue - 1);
    if (held < kSubBuckets) return static_cast<std::size_t>(held);
    const unsigned shift = static_cast<unsigned>(std::bit_width(held)) - 1 - kSubBits;
    return static_cast<std::size_t>((shift + 1) * kSubBuckets + (held >> shift) - kSubBuckets);
  }
  static std::uint64_t last_value_of(std::size_t bucket) CARGOBAY_NONBLOCKING {
    if (bucket < kSubBuckets) return bucket;
    const std::uint64_t shift = bucket / kSubBuckets - 1;
    return ((bucket % kSubBuckets + kSubBuckets + 1) << shift) - 1;
  }

  // atomic_ref needs 8-byte alignment, which integers of a 32-bit processor may not have.
  static constexpr std::size_t kAlignment = 8;
  alignas(kAlignment) std::array<std::uint64_t, kBuckets> counts_{};
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  alignas(kAlignment) std::uint64_t min_ = kNone;
  alignas(kAlignment) std::uint64_t max_ = 0;
  alignas(kAlignment) std::uint64_t sum_ = 0;
};

}  // namespace cargobay::rt
