// Percentiles, ratios and their intervals, from values that are made here. How often the intervals
// hold is counted by tests/campaign/coverage.cpp.
#include "hal/jitter/estimate.hpp"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::hal::jitter {
namespace {

constexpr std::uint64_t kPeriodNs = 1'000'000;

struct Made {
  std::size_t slices = 60;
  std::size_t frames = 500;
  double scale = 1.0;
  double mood = 0.0;  // from slice to slice
  unsigned seed = 1;
};
std::vector<Slice> make(const Made& made) {
  std::mt19937 random{made.seed};
  std::lognormal_distribution<double> values{0.0, 0.3};
  std::normal_distribution<double> moods{0.0, 1.0};
  std::vector<Slice> all(made.slices);
  for (Slice& slice : all) {
    const double mood = std::exp(made.mood * moods(random));
    for (std::size_t i = 0; i < made.frames; ++i)
      slice.headline_ns.push_back(
          static_cast<float>(10'000.0 * made.scale * mood * values(random)));
  }
  return all;
}

Estimate estimate(const std::vector<Slice>& slices, double percent) {
  return Sample{slices, kPeriodNs}.estimate(percent);
}

TEST(Sample, KnowsAPercentile) {
  const std::vector<Slice> all{{.headline_ns = {5, 1, 3}}, {.headline_ns = {2, 4}}};
  Sample sample{all, kPeriodNs};
  EXPECT_EQ(sample.percentile(50), 3.0);
  EXPECT_EQ(sample.percentile(100), 5.0);
  EXPECT_EQ(sample.percentile(0), 1.0);
  Sample nothing{{}, kPeriodNs};
  EXPECT_EQ(nothing.percentile(50), 0.0);
  EXPECT_FALSE(nothing.estimate(50).interval);
}

TEST(Sample, CountsWhatWasOmittedDownToOnePeriod) {
  const std::vector<Slice> all{{.headline_ns = {30'000, 3'400'000}}};
  Sample sample{all, kPeriodNs};
  ASSERT_EQ(sample.count(), 4U);
  EXPECT_EQ(sample.percentile(25), 30'000.0);
  EXPECT_EQ(sample.percentile(50), 1'400'000.0);
  EXPECT_EQ(sample.percentile(75), 2'400'000.0);
}

// In overload everything is late: no wait is made up that is shorter than any that was seen.
TEST(Sample, MakesUpNothingFasterThanTheFastest) {
  const std::vector<Slice> all{{.headline_ns = {3'400'000, 3'900'000}}};
  Sample sample{all, kPeriodNs};
  EXPECT_EQ(sample.count(), 6U);
  EXPECT_EQ(sample.percentile(0), 3'400'000.0);
  EXPECT_EQ(sample.percentile(100), 3'900'000.0);
}

TEST(Sample, KeepsWaitsOfMoreThanFourSeconds) {
  const std::vector<Slice> all{{.headline_ns = {30'000, 6e9F}}};
  Sample sample{all, kPeriodNs};
  EXPECT_EQ(sample.count(), 6001U);
  EXPECT_EQ(sample.percentile(100), 6e9);
}

TEST(Estimate, HasNoIntervalFromTooFewSlices) {
  const Estimate one = estimate(make({.slices = 1, .frames = 30'000}), 50);
  EXPECT_GT(one.value, 0.0);
  EXPECT_FALSE(one.interval);
  EXPECT_EQ(one.lack, Lack::slices);
  EXPECT_FALSE(estimate(make({.slices = kLeastSlices - 1}), 50).interval);
  EXPECT_TRUE(estimate(make({.slices = kLeastSlices}), 50).interval);
}

TEST(Estimate, HasNoIntervalFromTooFewValuesBeyond) {
  EXPECT_EQ(estimate(make({.slices = 39}), 99).lack, Lack::values);
  EXPECT_EQ(estimate(make({.slices = 40}), 99).lack, Lack::nothing);
}

// A machine that only ever gets slower: sixty slices say no more than a few would.
TEST(Estimate, HasNoIntervalIfTheRunIsOneSlowChange) {
  std::vector<Slice> all = make({});
  double slower = 1.0;
  for (Slice& slice : all) {
    slower *= 1.05;
    for (float& value : slice.headline_ns) value *= static_cast<float>(slower);
  }
  EXPECT_EQ(estimate(all, 50).lack, Lack::steadiness);
}

TEST(Estimate, IsAroundItsValue) {
  for (const double percent : {50.0, 90.0, 99.0}) {
    const Estimate found = estimate(make({.mood = 0.1}), percent);
    ASSERT_TRUE(found.interval);
    EXPECT_LT(found.interval->low, found.value);
    EXPECT_GT(found.interval->high, found.value);
  }
}

// Neighbours are alike, because the machine has moods: single values would look more certain.
TEST(Estimate, IsLessSureWhereSlicesDiffer) {
  const auto width = [](double mood) {
    const Estimate found = estimate(make({.mood = mood}), 50);
    return found.interval->high - found.interval->low;
  };
  EXPECT_GT(width(0.2), 5.0 * width(0.0));
}

TEST(Estimate, OfValuesThatAreAllTheSameIsThatValue) {
  const std::vector<Slice> all(60, Slice{.headline_ns = std::vector<float>(500, 7000.0F)});
  const Estimate found = estimate(all, 50);
  ASSERT_TRUE(found.interval);
  EXPECT_EQ(found.interval->low, 7000.0);
  EXPECT_EQ(found.interval->high, 7000.0);
}

TEST(Ratio, IsThatOfTheValues) {
  const Estimate a = estimate(make({.scale = 1.1, .seed = 1}), 50);
  const Estimate b = estimate(make({.seed = 2}), 50);
  const Estimate found = ratio(a, b);
  EXPECT_DOUBLE_EQ(found.value, a.value / b.value);
  ASSERT_TRUE(found.interval);
  EXPECT_GT(found.interval->low, 1.05) << "a tenth more shows";
  EXPECT_LT(found.interval->high, 1.15);
}

TEST(Ratio, HasNoIntervalIfOneHasNone) {
  const Estimate sure = estimate(make({}), 50);
  const Estimate unsure = estimate(make({.slices = 1, .frames = 30'000}), 50);
  EXPECT_FALSE(ratio(sure, unsure).interval);
  EXPECT_EQ(ratio(sure, unsure).lack, Lack::slices);
  EXPECT_FALSE(ratio(unsure, sure).interval);
  EXPECT_EQ(ratio(unsure, sure).lack, Lack::slices);
  EXPECT_GT(ratio(unsure, sure).value, 0.0);
  EXPECT_EQ(ratio(sure, Estimate{}).value, 0.0);
}

// Two channels that took turns had the same moods: these do not make their ratio uncertain.
TEST(Ratio, OfChannelsInTurnsIgnoresWhatTheyShare) {
  const std::vector<Slice> a = make({.mood = 0.2});
  std::vector<Slice> b = a;
  for (Slice& slice : b) {
    for (float& value : slice.headline_ns) value *= 1.01F;
  }
  const Estimate of_a = estimate(a, 50);
  const Estimate of_b = estimate(b, 50);
  EXPECT_GT(correlation(of_a, of_b), 0.95);
  const Estimate in_turns = ratio(of_b, of_a, correlation(of_a, of_b));
  const Estimate apart = ratio(of_b, of_a);
  EXPECT_LT(in_turns.interval->high - in_turns.interval->low,
            0.4 * (apart.interval->high - apart.interval->low));
  EXPECT_EQ(correlation(of_a, estimate(make({.slices = 40}), 50)), 0.0);
}

// The tables of Student's t.
TEST(StudentT, IsThatOfTheTables) {
  EXPECT_NEAR(student_t95(3), 3.182, 0.03);
  EXPECT_NEAR(student_t95(5), 2.571, 0.005);
  EXPECT_NEAR(student_t95(10), 2.228, 0.001);
  EXPECT_NEAR(student_t95(30), 2.042, 0.001);
  EXPECT_NEAR(student_t95(1e9), 1.960, 0.001);
}

}  // namespace
}  // namespace cargobay::hal::jitter
