// How the models of a bank learn from a reading: their gains, and which of them is right.
#include <algorithm>
#include <cmath>

#include "rt/plant_bank.hpp"

namespace cargobay::rt {
namespace {

constexpr float kShare = 3e-4F;         // of the weight, that each reading gives back to the prior
constexpr float kGainDrift = 1e-6F;     // variance that each reading adds to a gain
constexpr float kMostSurprise = 16.0F;  // variances: no single reading may decide
// Models of less weight are weighed in turn, a few each time.
constexpr float kHardlyLikely = 1e-3F;
constexpr std::size_t kTurns = 8;
constexpr float kStraight = 0.2F;  // of the way: what the wheels differ by at most
constexpr std::size_t kParts = PlantModels::kParts;

// exp(-square / 2) with a heavier tail: Student's t of 31 degrees of freedom.
Lanes likelihood(const Lanes& square) CARGOBAY_NONBLOCKING {
  const Lanes t = 1.0F / (1.0F + square / 32.0F);
  const Lanes t2 = t * t;
  const Lanes t4 = t2 * t2;
  const Lanes t8 = t4 * t4;
  return t8 * t8;
}

}  // namespace

// The likely ones every time, the others in turn.
void PlantBank::choose_drives(bool all) CARGOBAY_NONBLOCKING {
  turn_ = (turn_ + 1) % kTurns;
  const float enough = alike() ? *std::ranges::max_element(drive_weight_) : kHardlyLikely;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    chosen_[drive] = all || drive_weight_[drive] >= enough || drive % kTurns == turn_;
  }
}

void PlantBank::weigh(Axis axis, Memory memory, const Seen& seen, const WheelSpeeds& speeds)
    CARGOBAY_NONBLOCKING {
  const Expected expected = expected_of(axis, memory, seen);
  choose_drives(seen.lost && !alike());
  float miss = 0.0F;
  float before = 0.0F;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    if (!chosen_[drive]) continue;
    miss += expect(drive, expected);
    before += drive_weight_[drive];
  }
  concluded_ = false;
  const float sd = std::sqrt(seen.variance + foreseen_variance(expected));
  if (load_changed(readings_[static_cast<std::size_t>(axis)], miss / before / sd, seen.lost)) {
    const auto& command = models_.command();
    const float forwards = expected.by_left * command[0] + expected.by_right * command[1];
    estimate_.weakened = (miss < 0.0F) == (forwards > 0.0F);
    return begin_again(speeds);
  }
  float after = 0.0F;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    if (chosen_[drive]) after += learn(drive, seen, expected);
  }
  give_back(before, after);
}

PlantBank::Expected PlantBank::expected_of(Axis axis, Memory memory, const Seen& seen) const
    CARGOBAY_NONBLOCKING {
  const bool turns = axis == Axis::turn;
  Expected expected{.at = PlantModels::at(axis, memory),
                    .by_left = turns ? -1.0F : 0.5F,
                    .by_right = turns ? 1.0F : 0.5F};
  const auto& left = models_.wheel(0);
  const auto& right = models_.wheel(1);
  for (std::size_t part = 0; part < kParts; ++part) {
    const Lanes rolled =
        expected.by_left * (left.rolled[part] - left.rolled_at[expected.at][part]) +
        expected.by_right * (right.rolled[part] - right.rolled_at[expected.at][part]);
    expected.low_mm[part] = seen.low_mm - rolled;
    expected.high_mm[part] = seen.high_mm - rolled;
  }
  return expected;
}

// Returns the sum of the misses, by weight.
float PlantBank::expect(std::size_t drive, const Expected& expected) CARGOBAY_NONBLOCKING {
  Lags misses{};
  for (std::size_t part = 0; part < kParts; ++part) {
    const auto [left, right] = ways(drive, part, expected);
    const Lanes way = left * gain_[0][drive][part] + right * gain_[1][drive][part];
    const Lanes nearest = least(greatest(way, expected.low_mm[part]), expected.high_mm[part]);
    miss_[drive][part] = nearest - way;
    misses[part] = weight_[drive][part] * miss_[drive][part];
  }
  return PlantModels::sum(misses);
}

// What the wheels, with a gain of 1, add to the way.
std::array<Lanes, 2> PlantBank::ways(std::size_t drive, std::size_t part,
                                     const Expected& expected) const CARGOBAY_NONBLOCKING {
  const auto& left = models_.wheel(0);
  const auto& right = models_.wheel(1);
  return {expected.by_left * (left.way[drive][part] - left.way_at[expected.at][drive][part]),
          expected.by_right * (right.way[drive][part] - right.way_at[expected.at][drive][part])};
}

// Of the way, by what the likeliest model knows of its gains.
float PlantBank::foreseen_variance(const Expected& expected) const CARGOBAY_NONBLOCKING {
  const auto drive =
      static_cast<std::size_t>(std::ranges::max_element(drive_weight_) - drive_weight_.begin());
  const Lags& weights = weight_[drive];
  std::size_t lag = 0;
  for (std::size_t i = 1; i < PlantModels::kLags; ++i) {
    if (weights[i / kLanes][i % kLanes] > weights[lag / kLanes][lag % kLanes]) lag = i;
  }
  const std::size_t part = lag / kLanes;
  const auto [left, right] = ways(drive, part, expected);
  const Lanes variance = left * left * covariance_.left_left[drive][part] +
                         2.0F * left * right * covariance_.left_right[drive][part] +
                         right * right * covariance_.right_right[drive][part];
  return variance[lag % kLanes];
}

// Recursive least squares in each model, and its weight by Bayes. Returns the sum of the weights.
float PlantBank::learn(std::size_t drive, const Seen& seen, const Expected& expected)
    CARGOBAY_NONBLOCKING {
  // Once all models foresee the same, a reading says nothing of the plant, and the little that it
  // seems to say would add up.
  const bool weighs = frozen_ticks_ == 0 && !alike();
  // A reading that an interval expected teaches nothing, unless it was not known to be within: an
  // angle of 0 after a long straight way tells how alike the wheels are.
  const float half_mm = 0.5F * (seen.high_mm - seen.low_mm);
  const float within = seen.variance + half_mm * half_mm;
  for (std::size_t part = 0; part < kParts; ++part) {
    const auto [left, right] = ways(drive, part, expected);
    const Lanes miss = miss_[drive][part];
    const Lanes left_left = covariance_.left_left[drive][part] + kGainDrift;
    const Lanes right_right = covariance_.right_right[drive][part] + kGainDrift;
    const Lanes left_right = covariance_.left_right[drive][part] + 0.5F * kGainDrift;
    const Lanes of_left = left_left * left + left_right * right;
    const Lanes of_right = left_right * left + right_right * right;
    const Lanes doubt = left * of_left + right * of_right;
    const Lanes certainty = 1.0F / (doubt + seen.variance);
    const Lanes scaled = miss * certainty;
    const auto straight = magnitude(left + right) < kStraight * magnitude(right - left);
    const auto tells = (magnitude(miss) > 0.0F) | (straight & (doubt > within));
    const Lanes teaches = seen.lost ? (tells ? certainty : Lanes{}) : certainty;
    gain_[0][drive][part] += of_left * scaled;
    gain_[1][drive][part] += of_right * scaled;
    covariance_.left_left[drive][part] = left_left - of_left * of_left * teaches;
    covariance_.left_right[drive][part] = left_right - of_left * of_right * teaches;
    covariance_.right_right[drive][part] = right_right - of_right * of_right * teaches;
    if (weighs) {
      weight_[drive][part] *=
          likelihood(least(miss * scaled, all_lanes(kMostSurprise))) * root(certainty);
    }
  }
  drive_weight_[drive] = PlantModels::sum(weight_[drive]);
  return drive_weight_[drive];
}

// What the chosen ones weighed before they weigh again, but for the share of the prior.
void PlantBank::give_back(float before, float after) CARGOBAY_NONBLOCKING {
  const float share = alike() ? 0.0F : kShare;
  const float keep = (1.0F - share) * before / after;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    if (!chosen_[drive]) continue;
    for (std::size_t part = 0; part < kParts; ++part) {
      weight_[drive][part] = keep * weight_[drive][part] + share * prior_[drive][part];
    }
    drive_weight_[drive] = PlantModels::sum(weight_[drive]);
  }
}

}  // namespace cargobay::rt
