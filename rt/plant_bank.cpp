#include "rt/plant_bank.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cargobay::rt {
namespace {

// A plant of the family lies between two of these; the mean by weight finds it.
constexpr std::array kLagS{0.020, 0.035, 0.060, 0.100, 0.160, 0.250, 0.360, 0.500};
constexpr std::array kDeadTimeS{0.0, 0.035, 0.070};
constexpr std::array kRampS2Mm{0.0, 1.0 / 1000.0, 1.0 / 500.0, 1.0 / 275.0};

// Before anything was seen. The wheels are of one make, so their gains go together.
constexpr float kGain = 0.92F;
constexpr float kGainSd = 0.2F;
constexpr float kGainCorrelation = 0.9F;
constexpr double kLagSpread = 1.7;      // standard deviation of the logarithm
constexpr double kRampUnlikely = 0.7;   // logarithm of the odds against one
constexpr double kDelayUnlikely = 6.0;  // the same, for each second of dead time

constexpr double kFadeS = 0.25;       // how long a way counts where the remainder is carried, ...
constexpr double kLongerFadeS = 1.0;  // ... and until that is known
constexpr int kWeighTicks = 4;        // between two times, if an axis is read every tick
constexpr int kForgetEvery = 2;       // times; not every time, only to save work

// A load that has changed.
constexpr float kMisfit = 2.0F;  // standard deviations
constexpr float kMisfitSteady = 2.5F;
constexpr int kMisfitWindows = 2;  // in a row, as all of these; at a steady speed, one reading
constexpr int kMisfitsWhileChanging = 6;  // then a plant that is not known yet misfits too
constexpr float kWidenedSd = 0.14F;       // a part of each gain
constexpr float kWidenedCorrelation = 0.95F;
constexpr float kSteady = 0.15F;      // of the command: its changes, of late
constexpr float kStillMmS = 0.5F;     // the same, of a robot that stands
constexpr double kExcitationS = 0.5;  // how long a change counts as such
constexpr double kFrozenS = 1.0;
constexpr double kDoubtfulS = 1.0;
constexpr double kAlikeAfterS = 2.0;  // of steady commands: the slowest plant has settled
constexpr int kMostTicks = 1'000'000;

void fill(PlantModels::Lags& lags, float value) CARGOBAY_NONBLOCKING {
  lags.fill(all_lanes(value));
}

PlantModels::Grid grid_for(const PlantBank::Parameters& parameters) {
  PlantModels::Grid grid{.lag_s = kLagS,
                         .dead_time_s = kDeadTimeS,
                         .ramp_s2_mm = kRampS2Mm,
                         .tick_s = parameters.tick_s,
                         .input_delay_s = parameters.input_delay_s};
  if (const auto& told = parameters.told) {
    grid.lag_s.fill(told->lag_s);
    grid.dead_time_s.fill(told->dead_time_s);
    grid.ramp_s2_mm.fill(told->ramp_s2_mm);
  }
  return grid;
}

}  // namespace

PlantBank::PlantBank(const Parameters& parameters)
    : parameters_{parameters}, grid_{grid_for(parameters)}, models_{grid_} {
  set_prior();
  reset();
}

void PlantBank::set_prior() {
  float whole = 0.0F;
  for (std::size_t i = 0; i < PlantModels::kCount; ++i) {
    const double off = std::log(grid_.lag_of(i) / parameters_.likely_lag_s) / kLagSpread;
    const double unlikely = 0.5 * off * off + (grid_.ramp_of(i) > 0.0 ? kRampUnlikely : 0.0) +
                            kDelayUnlikely * grid_.dead_time_of(i);
    const double prior = std::exp(-unlikely);
    PlantModels::set(prior_, i, prior);
    whole += static_cast<float>(prior);
  }
  for (Lags& lags : prior_) {
    for (Lanes& part : lags) part /= whole;
  }
}

void PlantBank::sum_drives() CARGOBAY_NONBLOCKING {
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    drive_weight_[drive] = PlantModels::sum(weight_[drive]);
  }
}

void PlantBank::reset() CARGOBAY_NONBLOCKING {
  const auto& told = parameters_.told;
  const float variance = told ? 0.0F : kGainSd * kGainSd;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    fill(gain_[0][drive], told ? static_cast<float>(told->gain_left) : kGain);
    fill(gain_[1][drive], told ? static_cast<float>(told->gain_right) : kGain);
    fill(covariance_.left_left[drive], variance);
    fill(covariance_.right_right[drive], variance);
    fill(covariance_.left_right[drive], kGainCorrelation * variance);
  }
  weight_ = prior_;
  sum_drives();
  models_.reset();
  readings_ = {};
  excitation_ = 0.0F;
  frozen_ticks_ = 0;
  doubtful_ticks_ = 0;
  steady_ticks_ = 0;
  turn_ = 0;
  driven_ = {};
  estimate_ = {};
  concluded_ = false;
  conclude();
}

void PlantBank::step(const WheelSpeeds& command) CARGOBAY_NONBLOCKING {
  models_.step(command);
  for (Readings& readings : readings_) ++readings.since;
  const auto& newest = models_.command();
  const auto& former = models_.former_command();
  const auto fade = static_cast<float>(1.0 - parameters_.tick_s / kExcitationS);
  excitation_ =
      fade * excitation_ + std::abs(newest[0] - former[0]) + std::abs(newest[1] - former[1]);
  frozen_ticks_ = std::max(frozen_ticks_ - 1, 0);
  doubtful_ticks_ = std::max(doubtful_ticks_ - 1, 0);
  steady_ticks_ = steady() ? std::min(steady_ticks_ + 1, kMostTicks) : 0;
  Lanes left{};
  Lanes right{};
  for (std::size_t group = 0; group < PlantModels::kDeadTimes; ++group) {
    left += drive_weights_[group] * models_.wheel(0).input[group];
    right += drive_weights_[group] * models_.wheel(1).input[group];
  }
  driven_ = {rt::sum(left), rt::sum(right)};
}

float PlantBank::steps_mm(Axis axis) const CARGOBAY_NONBLOCKING {
  if (axis == Axis::distance) return 1.0F;
  return static_cast<float>(parameters_.wheel_base_mm * std::numbers::pi / 180.0);
}

// Where the remainder is carried, the readings since long ago say together where the wheels are, to
// a step: so old ways only fade. Where it is lost, each reading stands for itself.
void PlantBank::read(Axis axis, int count, int ticks, RemainderBelief remainder,
                     const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  if (parameters_.told) return;
  Readings& readings = readings_[static_cast<std::size_t>(axis)];
  readings.since = 0;
  if (readings.unsure) return read_unseen(axis);
  readings.way_mm += static_cast<float>(count) * steps_mm(axis);
  readings.waiting += ticks;
  const bool carried = remainder == RemainderBelief::carried;
  if (carried) {
    readings.at_once = true;  // then what is remembered of the last reading is old
    return read_carried(axis, speeds);
  }
  const bool old = std::exchange(readings.at_once, false);
  if (!old && (remainder == RemainderBelief::lost || ticks > 1)) {
    read_window(axis, count, remainder == RemainderBelief::lost, speeds);
  }
  models_.remember(axis, Memory::last_reading, 0.0F);
  if (readings.waiting >= kWeighTicks) {
    fade(axis, static_cast<float>(std::exp(-readings.waiting * parameters_.tick_s / kLongerFadeS)));
  }
}

void PlantBank::read_carried(Axis axis, const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  Readings& readings = readings_[static_cast<std::size_t>(axis)];
  if (readings.waiting < kWeighTicks) return;
  weigh(axis, Memory::longer,
        {readings.way_mm, readings.way_mm, axis == Axis::turn ? 6.0F : 0.2F, false}, speeds);
  if (++readings.weighed < kForgetEvery) {
    readings.waiting = 0;
    return;
  }
  fade(axis, static_cast<float>(
                 std::exp(-kForgetEvery * readings.waiting * parameters_.tick_s / kFadeS)));
}

void PlantBank::read_window(Axis axis, int count, bool lost, const WheelSpeeds& speeds)
    CARGOBAY_NONBLOCKING {
  const auto steps = static_cast<float>(count);
  const float step = steps_mm(axis);
  const bool turns = axis == Axis::turn;
  if (!lost) {
    const float between = steps + (count == 0 ? 0.0F : std::copysign(0.25F, steps));
    return weigh(axis, Memory::last_reading,
                 {between * step, between * step, turns ? 6.0F : 0.2F, false}, speeds);
  }
  // Not quite to the edges: a reading there teaches that the next one may be another.
  constexpr float kEdge = 0.4F;
  const float low = (count > 0 ? steps : steps - 1.0F) + kEdge;
  const float high = (count < 0 ? steps : steps + 1.0F) - kEdge;
  weigh(axis, Memory::last_reading, {low * step, high * step, turns ? 4.0F : 0.12F, true}, speeds);
}

void PlantBank::read_unseen(Axis axis) CARGOBAY_NONBLOCKING {
  models_.remember(axis, Memory::last_reading, 0.0F);
  fade(axis, 0.0F);
  readings_[static_cast<std::size_t>(axis)].unsure = false;
}

// What is remembered for longer.
void PlantBank::fade(Axis axis, float part) CARGOBAY_NONBLOCKING {
  Readings& readings = readings_[static_cast<std::size_t>(axis)];
  readings.way_mm *= part;
  readings.waiting = 0;
  readings.weighed = 0;
  models_.remember(axis, Memory::longer, part);
}

bool PlantBank::steady() const CARGOBAY_NONBLOCKING {
  const auto& newest = models_.command();
  return excitation_ < kSteady * (std::abs(newest[0]) + std::abs(newest[1])) + kStillMmS;
}

bool PlantBank::alike() const CARGOBAY_NONBLOCKING {
  return steady_ticks_ * parameters_.tick_s > kAlikeAfterS;
}

// What all models foresee alike and does not come true is not the plant, but its load.
bool PlantBank::load_changed(Readings& readings, float misfit, bool lost) CARGOBAY_NONBLOCKING {
  const bool at_once = steady();
  if (std::abs(misfit) < (at_once ? kMisfitSteady : kMisfit)) {
    readings.misfits = 0;
    return false;
  }
  if (alike()) doubtful_ticks_ = static_cast<int>(kDoubtfulS / parameters_.tick_s);
  const int sign = misfit > 0.0F ? 1 : -1;
  readings.misfits = readings.misfits * sign > 0 ? readings.misfits + sign : sign;
  const int enough = lost ? kMisfitWindows : at_once ? 1 : kMisfitsWhileChanging;
  if (std::abs(readings.misfits) < enough) return false;
  readings.misfits = 0;
  return true;
}

// A load takes the same part of both gains, or nearly: a better wheel loses more.
void PlantBank::widen() CARGOBAY_NONBLOCKING {
  constexpr float kMore = kWidenedSd * kWidenedSd;
  for (std::size_t drive = 0; drive < PlantModels::kDrives; ++drive) {
    for (std::size_t part = 0; part < PlantModels::kParts; ++part) {
      const Lanes left = gain_[0][drive][part];
      const Lanes right = gain_[1][drive][part];
      covariance_.left_left[drive][part] += kMore * left * left;
      covariance_.right_right[drive][part] += kMore * right * right;
      covariance_.left_right[drive][part] += kWidenedCorrelation * kMore * left * right;
    }
  }
}

// The wheels answer by other gains from now on; what they do already is not concerned.
void PlantBank::begin_again(const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  widen();
  if (frozen_ticks_ > 0 || steady()) {
    frozen_ticks_ = static_cast<int>(kFrozenS / parameters_.tick_s);
  }
  models_.begin_again(speeds);
  for (Readings& readings : readings_) {
    readings = {.since = readings.since, .unsure = readings.since > 0};
  }
}

}  // namespace cargobay::rt
