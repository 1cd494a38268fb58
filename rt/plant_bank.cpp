#include "rt/plant_bank.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace cargobay::rt {
namespace {

// A plant of the family lies between two of these; the mean by weight finds it.
constexpr std::array kLagS{0.020, 0.035, 0.060, 0.100, 0.160, 0.250, 0.360, 0.500};
constexpr std::array kDeadTimeS{0.0, 0.025, 0.050, 0.075};
constexpr std::array kRampS2Mm{0.0, 1.0 / 1000.0, 1.0 / 600.0, 1.0 / 400.0, 1.0 / 275.0};
constexpr double kNoLimit = 1e6;  // mm/s, to the change in a tick

// Before anything was seen. The wheels are of one make, so their gains go together.
constexpr float kGain = 0.92F;
constexpr float kGainSd = 0.2F;
constexpr double kWeakestGain = 0.4;
constexpr double kStrongestGain = 1.4;
constexpr float kGainCorrelation = 0.9F;
constexpr double kLagSpread = 1.7;      // standard deviation of the logarithm
constexpr double kRampUnlikely = 0.7;   // logarithm of the odds against one
constexpr double kDelayUnlikely = 6.0;  // the same, for each second of dead time

constexpr float kShare = 3e-4F;         // of the weight, that each reading gives back to the prior
constexpr float kGainDrift = 1e-6F;     // variance that each reading adds to a gain
constexpr double kFadeS = 0.25;         // how long a way counts where the remainder is carried
constexpr int kWeighEvery = 2;          // readings, if they come every tick
constexpr float kMostSurprise = 16.0F;  // variances: no single reading may decide

// A load that has changed.
constexpr float kMisfit = 2.0F;    // standard deviations
constexpr int kMisfitWindows = 2;  // in a row, as all of these; at a steady speed, one reading
constexpr int kMisfitsWhileChanging = 6;  // then a plant that is not known yet misfits too
constexpr float kWidenedSd = 0.1F;        // of a gain
constexpr float kWidenedCorrelation = 0.8F;
constexpr float kSteady = 0.15F;      // of the command: its changes, of late
constexpr float kStillMmS = 0.5F;     // the same, of a robot that stands
constexpr double kExcitationS = 0.5;  // how long a change counts as such
constexpr double kFrozenS = 1.0;
constexpr double kAlikeAfterS = 2.0;  // of steady commands: the slowest plant has settled
constexpr int kMostTicks = 1'000'000;

// Sums in four parts, so that the compiler can take four models at a time.
constexpr std::size_t kLanes = 4;
template <std::size_t kSize, typename Term>
float sum(const Term& term) CARGOBAY_NONBLOCKING {
  static_assert(kSize % kLanes == 0);
  std::array<float, kLanes> part{};
  for (std::size_t i = 0; i < kSize; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) part[lane] += term(i + lane);
  }
  return (part[0] + part[1]) + (part[2] + part[3]);
}

// exp(-square / 2) with a heavier tail: Student's t of 31 degrees of freedom.
float likelihood(float square) CARGOBAY_NONBLOCKING {
  const float t = 1.0F / (1.0F + square / 32.0F);
  const float t2 = t * t;
  const float t4 = t2 * t2;
  const float t8 = t4 * t4;
  return t8 * t8;
}

}  // namespace

// One reading, as it is weighed.
struct PlantBank::Seen {
  float low_mm;  // the way lies between these
  float high_mm;
  float variance;
  bool lost;
};

PlantBank::PlantBank(const Parameters& parameters)
    : parameters_{parameters}, grid_{grid(parameters)} {
  reset();
}

PlantBank::Grid PlantBank::grid(const Parameters& parameters) {
  const auto& told = parameters.told;
  Grid grid;
  for (std::size_t group = 0; group < kDeadTimes; ++group) {
    const double dead_time_s = told ? told->dead_time_s : kDeadTimeS[group];
    // A loop with a tick much shorter than a robot's has no history for that long.
    const double delay = std::min((parameters.input_delay_s + dead_time_s) / parameters.tick_s,
                                  static_cast<double>(kHistory - 2));
    grid.dead_time_s[group] = dead_time_s;
    grid.whole_ticks[group] = static_cast<std::size_t>(delay);
    grid.part_tick[group] = static_cast<float>(delay - std::floor(delay));
    for (std::size_t i = 0; i < kGroup; ++i) {
      const double lag_s = told ? told->lag_s : kLagS[i % kLags];
      const double ramp_s2_mm = told ? told->ramp_s2_mm : kRampS2Mm[i / kLags];
      grid.set(group * kGroup + i, lag_s, ramp_s2_mm, parameters);
      grid.prior[group * kGroup + i] *= static_cast<float>(std::exp(-kDelayUnlikely * dead_time_s));
    }
  }
  float whole = 0.0F;
  for (const float prior : grid.prior) whole += prior;
  for (float& prior : grid.prior) prior /= whole;
  return grid;
}

// A model, but for its dead time.
void PlantBank::Grid::set(std::size_t model, double lag, double ramp,
                          const Parameters& parameters) {
  const double decayed = std::exp(-parameters.tick_s / lag);
  const double off = std::log(lag / parameters.likely_lag_s) / kLagSpread;
  const double unlikely = 0.5 * off * off + (ramp > 0.0 ? kRampUnlikely : 0.0);
  lag_s[model] = static_cast<float>(lag);
  lag_squared[model] = static_cast<float>(lag * lag);
  decay[model] = static_cast<float>(decayed);
  way_by_speed_s[model] = static_cast<float>(lag * (1.0 - decayed));
  most_mm_s[model] = static_cast<float>(ramp > 0.0 ? parameters.tick_s / ramp : kNoLimit);
  half[model] = ramp > 0.0 ? 0.5F : 0.0F;
  ramp_s2_mm[model] = static_cast<float>(ramp);
  prior[model] = static_cast<float>(std::exp(-unlikely));
}

void PlantBank::reset() CARGOBAY_NONBLOCKING {
  const auto& told = parameters_.told;
  wheels_ = {};
  wheels_[0].gain.fill(told ? static_cast<float>(told->gain_left) : kGain);
  wheels_[1].gain.fill(told ? static_cast<float>(told->gain_right) : kGain);
  const float variance = told ? 0.0F : kGainSd * kGainSd;
  covariance_.left_left.fill(variance);
  covariance_.right_right.fill(variance);
  covariance_.left_right.fill(kGainCorrelation * variance);
  weight_ = grid_.prior;
  readings_ = {};
  commands_ = {};
  excitation_ = 0.0F;
  frozen_ticks_ = 0;
  steady_ticks_ = 0;
  driven_ = {};
  average();
}

void PlantBank::step(const WheelSpeeds& command) CARGOBAY_NONBLOCKING {
  const std::array<float, 2> former = commands_[now_];
  now_ = (now_ + 1) % kHistory;
  const std::array newest{static_cast<float>(command.left_mm_s),
                          static_cast<float>(command.right_mm_s)};
  commands_[now_] = newest;
  const auto fade = static_cast<float>(1.0 - parameters_.tick_s / kExcitationS);
  excitation_ =
      fade * excitation_ + std::abs(newest[0] - former[0]) + std::abs(newest[1] - former[1]);
  frozen_ticks_ = std::max(frozen_ticks_ - 1, 0);
  steady_ticks_ = steady() ? std::min(steady_ticks_ + 1, kMostTicks) : 0;
  driven_ = {drive(wheels_[0], 0), drive(wheels_[1], 1)};
}

// One tick of a wheel in each model. Returns the mean drive, by weight.
float PlantBank::drive(Wheel& wheel, std::size_t which) CARGOBAY_NONBLOCKING {
  const auto tick_s = static_cast<float>(parameters_.tick_s);
  for (std::size_t group = 0; group < kDeadTimes; ++group) {
    const std::size_t newer = now_ + kHistory - grid_.whole_ticks[group];
    const float part = grid_.part_tick[group];
    const float command = part * commands_[(newer - 1) % kHistory][which] +
                          (1.0F - part) * commands_[newer % kHistory][which];
    for (std::size_t i = group * kGroup; i < (group + 1) * kGroup; ++i) {
      const float most = grid_.most_mm_s[i];
      const float change = std::min(std::max(command - wheel.ramped[i], -most), most);
      wheel.ramped[i] += change;
      const float input = wheel.ramped[i] - grid_.half[i] * change;
      const float excess = wheel.speed[i] - input;
      const float way = grid_.way_by_speed_s[i] * excess + tick_s * input;
      wheel.input[i] = input;
      wheel.speed[i] = input + grid_.decay[i] * excess;
      wheel.way[0][i] += way;
      wheel.way[1][i] += way;
    }
  }
  return sum<kModels>([&](std::size_t i)
                          CARGOBAY_NONBLOCKING { return weight_[i] * wheel.input[i]; });
}

float PlantBank::steps_mm(Axis axis) const CARGOBAY_NONBLOCKING {
  if (axis == Axis::distance) return 1.0F;
  return static_cast<float>(parameters_.wheel_base_mm * std::numbers::pi / 180.0);
}

// Where the remainder is carried, the readings since long ago say together where the wheels are, to
// a step: so old ways only fade. Where it is lost, each reading stands for itself.
void PlantBank::read(Axis axis, int count, int ticks, RemainderBelief remainder)
    CARGOBAY_NONBLOCKING {
  const auto which = static_cast<std::size_t>(axis);
  Readings& readings = readings_[which];
  const float step = steps_mm(axis);
  const auto steps = static_cast<float>(count);
  readings.way_mm += steps * step;
  const bool turns = axis == Axis::turn;
  if (remainder == RemainderBelief::carried) {
    if (++readings.waiting >= kWeighEvery) {
      readings.waiting = 0;
      weigh(axis, {readings.way_mm, readings.way_mm, turns ? 6.0F : 0.2F, false});
    }
    fade(which, static_cast<float>(std::exp(-ticks * parameters_.tick_s / kFadeS)));
    return;
  }
  if (remainder == RemainderBelief::lost) {
    // Not quite to the edges: a reading there teaches that the next one may be another.
    constexpr float kEdge = 0.4F;
    const float low = (count > 0 ? steps : steps - 1.0F) + kEdge;
    const float high = (count < 0 ? steps : steps + 1.0F) - kEdge;
    weigh(axis, {low * step, high * step, turns ? 4.0F : 0.12F, true});
  } else if (ticks > 1) {  // tick by tick, the kinds differ by more than there is to see
    const float between = steps + (count == 0 ? 0.0F : std::copysign(0.25F, steps));
    weigh(axis, {between * step, between * step, turns ? 6.0F : 0.2F, false});
  }
  fade(which, 0.0F);
}

void PlantBank::read_unseen() CARGOBAY_NONBLOCKING {
  for (std::size_t axis = 0; axis < readings_.size(); ++axis) fade(axis, 0.0F);
}

void PlantBank::fade(std::size_t axis, float keep) CARGOBAY_NONBLOCKING {
  readings_[axis].way_mm *= keep;
  for (Wheel& wheel : wheels_) {
    for (float& way : wheel.way[axis]) way *= keep;
  }
}

bool PlantBank::steady() const CARGOBAY_NONBLOCKING {
  const auto& newest = commands_[now_];
  return excitation_ < kSteady * (std::abs(newest[0]) + std::abs(newest[1])) + kStillMmS;
}

// What all models foresee alike and does not come true is not the plant, but its load.
bool PlantBank::load_changed(Readings& readings, float misfit, bool lost) CARGOBAY_NONBLOCKING {
  if (std::abs(misfit) < kMisfit) {
    readings.misfits = 0;
    return false;
  }
  const int sign = misfit > 0.0F ? 1 : -1;
  readings.misfits = readings.misfits * sign > 0 ? readings.misfits + sign : sign;
  const int enough = lost ? kMisfitWindows : steady() ? 1 : kMisfitsWhileChanging;
  if (std::abs(readings.misfits) < enough) return false;
  readings.misfits = 0;
  return true;
}

void PlantBank::widen() CARGOBAY_NONBLOCKING {
  constexpr float kMore = kWidenedSd * kWidenedSd;
  for (std::size_t i = 0; i < kModels; ++i) {
    covariance_.left_left[i] += kMore;
    covariance_.right_right[i] += kMore;
    covariance_.left_right[i] += kWidenedCorrelation * kMore;
  }
  if (frozen_ticks_ > 0 || steady()) {
    frozen_ticks_ = static_cast<int>(kFrozenS / parameters_.tick_s);
  }
}

void PlantBank::weigh(Axis axis, const Seen& seen) CARGOBAY_NONBLOCKING {
  if (parameters_.told) return;
  const auto which = static_cast<std::size_t>(axis);
  const bool turns = axis == Axis::turn;
  const Values& left_way = wheels_[0].way[which];
  const Values& right_way = wheels_[1].way[which];
  const float by_left = turns ? -1.0F : 0.5F;
  const float by_right = turns ? 1.0F : 0.5F;
  for (std::size_t i = 0; i < kModels; ++i) {
    const float expected =
        by_left * left_way[i] * wheels_[0].gain[i] + by_right * right_way[i] * wheels_[1].gain[i];
    miss_[i] = std::min(std::max(expected, seen.low_mm), seen.high_mm) - expected;
  }
  const float miss =
      sum<kModels>([&](std::size_t i) CARGOBAY_NONBLOCKING { return weight_[i] * miss_[i]; });
  const bool changed = load_changed(readings_[which], miss / std::sqrt(seen.variance), seen.lost);
  if (changed) widen();
  learn(by_left, left_way, by_right, right_way, seen);
  if (changed) fade(which, 0.0F);
  average();
}

// Recursive least squares in each model, and its weight by Bayes.
void PlantBank::learn(float by_left, const Values& left_way, float by_right,
                      const Values& right_way, const Seen& seen) CARGOBAY_NONBLOCKING {
  // Copies: what may overlap with the gains is not taken four at a time.
  const Values left_ways = left_way;
  const Values right_ways = right_way;
  const float variance = seen.variance;
  // Once all models foresee the same, a reading says nothing of the plant, and the little that it
  // seems to say, or the share of the prior, would add up.
  const bool alike = steady_ticks_ * parameters_.tick_s > kAlikeAfterS;
  const float weighs = frozen_ticks_ == 0 && !alike ? 1.0F : 0.0F;
  // A reading that an interval expected teaches nothing.
  const float least_miss = seen.lost ? 0.0F : -1.0F;
  for (std::size_t i = 0; i < kModels; ++i) {
    const float left = by_left * left_ways[i];
    const float right = by_right * right_ways[i];
    const float left_left = covariance_.left_left[i] + kGainDrift;
    const float right_right = covariance_.right_right[i] + kGainDrift;
    const float left_right = covariance_.left_right[i] + 0.5F * kGainDrift;
    const float of_left = left_left * left + left_right * right;
    const float of_right = left_right * left + right_right * right;
    const float certainty = 1.0F / (left * of_left + right * of_right + variance);
    const float scaled = miss_[i] * certainty;
    const float teaches = std::abs(miss_[i]) > least_miss ? certainty : 0.0F;
    wheels_[0].gain[i] += of_left * scaled;
    wheels_[1].gain[i] += of_right * scaled;
    covariance_.left_left[i] = left_left - of_left * of_left * teaches;
    covariance_.left_right[i] = left_right - of_left * of_right * teaches;
    covariance_.right_right[i] = right_right - of_right * of_right * teaches;
    const float fits =
        likelihood(std::min(miss_[i] * scaled, kMostSurprise)) * std::sqrt(certainty);
    weight_[i] *= weighs * fits + (1.0F - weighs);
  }
  const float whole = sum<kModels>([&](std::size_t i) CARGOBAY_NONBLOCKING { return weight_[i]; });
  const float share = alike ? 0.0F : kShare;
  const float keep = (1.0F - share) / whole;
  for (std::size_t i = 0; i < kModels; ++i) {
    weight_[i] = keep * weight_[i] + share * grid_.prior[i];
  }
}

void PlantBank::average() CARGOBAY_NONBLOCKING {
  const auto mean = [&](const Values& values) CARGOBAY_NONBLOCKING {
    return static_cast<double>(
        sum<kModels>([&](std::size_t i) CARGOBAY_NONBLOCKING { return weight_[i] * values[i]; }));
  };
  const double lag_s = mean(grid_.lag_s);
  const double square = mean(grid_.lag_squared);
  estimate_.lag_s = lag_s;
  estimate_.lag_sd_s = std::sqrt(std::max(0.0, square - lag_s * lag_s));
  estimate_.ramp_s2_mm = mean(grid_.ramp_s2_mm);
  estimate_.dead_time_s = 0.0;
  for (std::size_t group = 0; group < kDeadTimes; ++group) {
    const float part = sum<kGroup>(
        [&](std::size_t i) CARGOBAY_NONBLOCKING { return weight_[group * kGroup + i]; });
    estimate_.dead_time_s += grid_.dead_time_s[group] * static_cast<double>(part);
  }
  // Whatever the readings say, no motor is as weak or as strong.
  estimate_.gain_left = std::clamp(mean(wheels_[0].gain), kWeakestGain, kStrongestGain);
  estimate_.gain_right = std::clamp(mean(wheels_[1].gain), kWeakestGain, kStrongestGain);
  estimate_.gain_sd = gain_sd();
}

// Of both wheels together, in proportion to their commands: in a straight line the difference
// between them is not known as well, but does not matter as much.
double PlantBank::gain_sd() const CARGOBAY_NONBLOCKING {
  const auto& newest = commands_[now_];
  const float all = std::abs(newest[0]) + std::abs(newest[1]);
  const float left = all > 0.0F ? std::abs(newest[0]) / all : 0.5F;
  const float right = 1.0F - left;
  const auto gain = [&](std::size_t i) CARGOBAY_NONBLOCKING {
    return left * wheels_[0].gain[i] + right * wheels_[1].gain[i];
  };
  const float mean =
      sum<kModels>([&](std::size_t i) CARGOBAY_NONBLOCKING { return weight_[i] * gain(i); });
  const float variance = sum<kModels>([&](std::size_t i) CARGOBAY_NONBLOCKING {
    const float off = gain(i) - mean;
    return weight_[i] * (off * off + left * left * covariance_.left_left[i] +
                         2.0F * left * right * covariance_.left_right[i] +
                         right * right * covariance_.right_right[i]);
  });
  return std::sqrt(static_cast<double>(std::max(variance, 0.0F)));
}

}  // namespace cargobay::rt
