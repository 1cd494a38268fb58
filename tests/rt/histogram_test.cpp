#include "rt/histogram.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

// The definition that the histogram approximates: the smallest value that at least this many
// hundredths of a percent do not exceed.
std::uint64_t exact_percentile(const std::vector<std::uint64_t>& sorted, std::size_t hundredths) {
  const std::size_t rank = (hundredths * sorted.size() + 9999) / 10'000;
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}
double percent(std::size_t hundredths) { return static_cast<double>(hundredths) / 100.0; }

TEST(Histogram, IsEmptyAtFirst) {
  const Histogram histogram;
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.min(), 0U);
  EXPECT_EQ(histogram.max(), 0U);
  for (const double share : {0.0, 50.0, 100.0}) EXPECT_EQ(histogram.percentile(share), 0U);
}

TEST(Histogram, KeepsOneValue) {
  for (const std::uint64_t value : {0ULL, 1ULL, 127ULL, 128ULL, 15'000'000ULL, 1ULL << 50U}) {
    Histogram histogram;
    histogram.record(value);
    EXPECT_EQ(histogram.count(), 1U);
    EXPECT_EQ(histogram.min(), value);
    EXPECT_EQ(histogram.max(), value);
    for (const double share : {0.0, 0.1, 50.0, 99.9, 100.0}) {
      EXPECT_EQ(histogram.percentile(share), std::min(value, Histogram::kMostValue - 1));
    }
  }
}

TEST(Histogram, IsExactBelow128) {
  Histogram histogram;
  for (std::uint64_t value = 0; value < 128; ++value) histogram.record(value);
  for (std::uint64_t value = 0; value < 128; ++value) {
    EXPECT_EQ(histogram.percentile(100.0 * static_cast<double>(value + 1) / 128.0), value);
  }
}

// 1000 values: 99.9 % is the 999th of them, whatever floating point makes of 0.999 times 1000.
TEST(Histogram, CountsRanksExactly) {
  for (const std::uint64_t size : {10ULL, 100ULL, 1000ULL, 10'000ULL, 100'000ULL}) {
    Histogram histogram;
    std::vector<std::uint64_t> sorted;
    for (std::uint64_t i = 0; i < size; ++i) {
      const std::uint64_t value = i * 100 / size;  // below 128: exact
      histogram.record(value);
      sorted.push_back(value);
    }
    for (std::size_t hundredths = 0; hundredths <= 10'000; hundredths += 5) {
      ASSERT_EQ(histogram.percentile(percent(hundredths)), exact_percentile(sorted, hundredths))
          << percent(hundredths) << " % of " << size;
    }
  }
}

// One wait of ten periods: nine more had to wait, each a period less.
TEST(Histogram, CountsWhatWasOmitted) {
  Histogram histogram;
  histogram.record_corrected(100, 10);
  EXPECT_EQ(histogram.count(), 10U);
  EXPECT_EQ(histogram.min(), 10U);
  EXPECT_EQ(histogram.max(), 100U);
  EXPECT_EQ(histogram.percentile(50), 50U);
  histogram.record_corrected(10, 10);
  histogram.record_corrected(0, 10);
  EXPECT_EQ(histogram.count(), 12U) << "what is in time keeps nothing waiting";
}

// 1.5 intervals keep nothing waiting for as long as an interval: 0.5 of one never happened.
TEST(Histogram, MakesUpNothingBelowOneInterval) {
  Histogram histogram;
  for (const std::uint64_t value : {11U, 15U, 19U}) histogram.record_corrected(value, 10);
  EXPECT_EQ(histogram.count(), 3U);
  EXPECT_EQ(histogram.min(), 11U);
  histogram.record_corrected(39, 10);  // and 29 and 19
  EXPECT_EQ(histogram.count(), 6U);
  EXPECT_EQ(histogram.min(), 11U);
}

// HdrHistogram's own loop.
TEST(Histogram, OmitsAsHdrHistogramDoes) {
  for (std::uint64_t interval = 1; interval < 30; ++interval) {
    for (std::uint64_t value = 0; value < 200; ++value) {
      std::vector<std::uint64_t> wanted{value};
      if (value > interval) {
        for (std::uint64_t missing = value - interval; missing >= interval; missing -= interval)
          wanted.push_back(missing);
      }
      ASSERT_EQ(Histogram::omitted(value, interval) + 1, wanted.size()) << value << ' ' << interval;
      Histogram histogram;
      histogram.record_corrected(value, interval);
      ASSERT_EQ(histogram.min(), wanted.back()) << value << ' ' << interval;
    }
  }
}

TEST(Histogram, ShowsItsBuckets) {
  Histogram histogram;
  for (const std::uint64_t value : {3U, 3U, 70U, 1000U}) histogram.record(value);
  std::vector<std::pair<std::uint64_t, std::uint64_t>> seen;
  histogram.visit(
      [&seen](std::uint64_t value, std::uint64_t count) { seen.push_back({value, count}); });
  const std::vector<std::pair<std::uint64_t, std::uint64_t>> wanted{{3, 2}, {70, 1}, {1000, 1}};
  EXPECT_EQ(seen, wanted);
}

TEST(Histogram, IsWithinOnePartIn128) {
  std::mt19937_64 random{3};
  std::lognormal_distribution<double> durations{std::log(15e6), 2.0};
  Histogram histogram;
  std::vector<std::uint64_t> sorted;
  for (int i = 0; i < 20'000; ++i) {
    const auto value = static_cast<std::uint64_t>(durations(random));
    histogram.record(value);
    sorted.push_back(value);
  }
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t hundredths = 0; hundredths <= 10'000; hundredths += 5) {
    const auto exact = static_cast<double>(exact_percentile(sorted, hundredths));
    const auto found = static_cast<double>(histogram.percentile(percent(hundredths)));
    EXPECT_GE(found, exact) << hundredths;
    EXPECT_LE(found, exact * (1.0 + 1.0 / 128.0)) << hundredths;
  }
  EXPECT_EQ(histogram.percentile(100.0), sorted.back());
  EXPECT_EQ(histogram.min(), sorted.front());
  EXPECT_EQ(histogram.max(), sorted.back());
}

// Every value at the border between two buckets, up to the last.
TEST(Histogram, PutsBordersWhereTheyBelong) {
  for (unsigned bit = 7; bit < 40; ++bit) {
    for (const std::uint64_t part : {0ULL, 1ULL, 63ULL, 127ULL}) {
      const std::uint64_t border =
          (std::uint64_t{1} << bit) + part * (std::uint64_t{1} << (bit - 7U));
      Histogram histogram;
      histogram.record(border - 1);
      histogram.record(border);
      histogram.record(Histogram::kMostValue);
      EXPECT_EQ(histogram.percentile(1.0), border - 1);
      EXPECT_GE(histogram.percentile(60.0), border);
      EXPECT_LE(histogram.percentile(60.0), border + border / 128);
    }
  }
}

TEST(Histogram, CountsWhatIsTooLongInTheLastBucket) {
  Histogram histogram;
  histogram.record(5);
  histogram.record(~std::uint64_t{0});
  EXPECT_EQ(histogram.max(), ~std::uint64_t{0});
  EXPECT_EQ(histogram.percentile(50.0), 5U);
  EXPECT_EQ(histogram.percentile(100.0), Histogram::kMostValue - 1);
}

TEST(Histogram, MergesAsIfRecordedInOne) {
  std::mt19937_64 random{4};
  Histogram one;
  Histogram other;
  Histogram both;
  for (int i = 0; i < 5000; ++i) {
    const std::uint64_t value = random() >> (random() % 50 + 14);
    (i % 3 == 0 ? one : other).record(value);
    both.record(value);
  }
  one.merge(other);
  EXPECT_EQ(one.count(), both.count());
  EXPECT_EQ(one.min(), both.min());
  EXPECT_EQ(one.max(), both.max());
  for (int share = 0; share <= 100; ++share) {
    EXPECT_EQ(one.percentile(share), both.percentile(share));
  }
}

TEST(Histogram, IsUnchangedByMergingNothing) {
  Histogram histogram;
  histogram.record(42);
  histogram.merge(Histogram{});
  EXPECT_EQ(histogram.min(), 42U);
  EXPECT_EQ(histogram.count(), 1U);
  Histogram empty;
  empty.merge(histogram);
  EXPECT_EQ(empty.min(), 42U);
  EXPECT_EQ(empty.max(), 42U);
}

}  // namespace
}  // namespace cargobay::rt
