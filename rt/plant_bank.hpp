// How the wheels answer commands: lag, dead time, ramp and each wheel's gain, learnt from the
// readings while the robot drives.
//
// A bank of models runs side by side. Each has one lag, dead time and ramp of a coarse grid and
// knows how wheels with a gain of 1 would have answered what was sent; the gains that fit the
// readings best are found by recursive least squares, in each model for itself. How well a model
// foresees the readings decides its weight (D. T. Magill, Optimal adaptive estimation of sampled
// stochastic processes, IEEE Trans. Automatic Control 10, 1965). Every model keeps a small share,
// so that a plant that has changed is found again (M. Herbster and M. K. Warmuth, Tracking the
// best expert, Machine Learning 32, 1998). docs/control.md derives it and says how well it does.
//
// One thread; no allocation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "rt/learnt_plant.hpp"
#include "rt/nonblocking.hpp"
#include "rt/remainder.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

// What is known of the wheels and their motors: the mean of all models, by weight.
struct PlantEstimate {
  double lag_s = 0.100;
  double dead_time_s = 0.0;
  double ramp_s2_mm = 0.0;  // 1 / ramp; 0: none
  // True mm/s for each commanded mm/s once all has settled.
  double gain_left = 0.92;
  double gain_right = 0.92;
  // Standard deviations: of the lag, and of the gain of the axis in which the robot moves.
  double lag_sd_s = 0.0;
  double gain_sd = 0.0;
};

class PlantBank {
 public:
  enum class Axis : std::uint8_t { distance, turn };

  struct Parameters {
    double wheel_base_mm = 258.0;
    double tick_s = 0.015;
    double input_delay_s = 0.0025;  // from the tick to the arrival of the command it caused
    double likely_lag_s = 0.100;    // above 0; any other is found too
    // If the plant is known for certain: then nothing is learnt.
    std::optional<PlantEstimate> told{};
  };

  explicit PlantBank(const Parameters& parameters);

  void reset() CARGOBAY_NONBLOCKING;
  // Call directly after reset(). What an earlier drive learnt is likely, no more: it is mixed into
  // what the bank begins with. Does nothing if the bank is told.
  void begin_from(const LearntPlant& prior) CARGOBAY_NONBLOCKING;

  // One tick of the robot, in which `command` was sent in answer to the frame before.
  void step(const WheelSpeeds& command) CARGOBAY_NONBLOCKING;
  // The axis was read `ticks` after its last reading, and said `count`.
  void read(Axis axis, int count, int ticks, RemainderBelief remainder) CARGOBAY_NONBLOCKING;
  // Both axes were read, but what they said is not known, or not to be believed.
  void read_unseen() CARGOBAY_NONBLOCKING;

  // Whether the commands have hardly changed of late: then all models foresee the same.
  bool steady() const CARGOBAY_NONBLOCKING;

  const PlantEstimate& estimate() const CARGOBAY_NONBLOCKING { return estimate_; }
  // The same with all spreads, but nothing of the remainder or of time. Looks at every model.
  LearntPlant learnt() const CARGOBAY_NONBLOCKING;
  // What the wheels were driven at in the last tick, before gain and lag: the command after dead
  // time and ramp, mean of the tick.
  const WheelSpeeds& driven() const CARGOBAY_NONBLOCKING { return driven_; }

 private:
  static constexpr std::size_t kLags = 8;
  static constexpr std::size_t kRamps = 5;
  static constexpr std::size_t kDeadTimes = 4;
  static constexpr std::size_t kGroup = kLags * kRamps;  // the models of one dead time
  static constexpr std::size_t kModels = kGroup * kDeadTimes;
  static constexpr std::size_t kHistory = 8;  // ticks of commands
  using Values = std::array<float, kModels>;  // of all models

  // A wheel with a gain of 1, in each model.
  struct alignas(16) Wheel {
    Values ramped{};              // mm/s, the command after dead time and ramp
    Values speed{};               // mm/s
    Values input{};               // mm/s, what the lag follows: mean of the last tick
    std::array<Values, 2> way{};  // mm, for each axis: since its last reading, older ones fading
    Values gain{};
  };
  // What does not change with time.
  struct alignas(16) Grid {
    Values lag_s{};
    Values lag_squared{};
    Values decay{};           // of the speed in a tick
    Values way_by_speed_s{};  // mm for each mm/s at the begin of a tick
    Values most_mm_s{};       // by which the ramp lets the drive change in a tick
    Values half{};            // of that change is missing from the mean of a tick: 0 or 0.5
    Values ramp_s2_mm{};
    Values prior{};
    std::array<double, kDeadTimes> dead_time_s{};
    std::array<std::size_t, kDeadTimes> whole_ticks{};  // of delay, and ...
    std::array<float, kDeadTimes> part_tick{};          // ... the rest
    void set(std::size_t model, double lag, double ramp, const Parameters& parameters);
  };
  // Covariance of the gains.
  struct alignas(16) GainCovariance {
    Values left_left{};
    Values left_right{};
    Values right_right{};
  };
  // One axis of what is read.
  struct Readings {
    float way_mm = 0.0F;  // as Wheel::way
    int waiting = 0;      // readings that were not weighed
    int misfits = 0;      // in a row; negative if the robot fell short
  };
  struct Seen;

  static Grid grid(const Parameters& parameters);
  float drive(Wheel& wheel, std::size_t which) CARGOBAY_NONBLOCKING;
  float steps_mm(Axis axis) const CARGOBAY_NONBLOCKING;
  void weigh(Axis axis, const Seen& seen) CARGOBAY_NONBLOCKING;
  void learn(float by_left, const Values& left_way, float by_right, const Values& right_way,
             const Seen& seen) CARGOBAY_NONBLOCKING;
  bool load_changed(Readings& readings, float misfit, bool lost) CARGOBAY_NONBLOCKING;
  void widen() CARGOBAY_NONBLOCKING;
  void fade(std::size_t axis, float keep) CARGOBAY_NONBLOCKING;
  void average() CARGOBAY_NONBLOCKING;
  double gain_sd() const CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  Grid grid_;
  std::array<Wheel, 2> wheels_{};
  GainCovariance covariance_{};
  alignas(16) Values weight_{};
  alignas(16) Values miss_{};  // mm, of the last reading
  std::array<Readings, 2> readings_{};
  std::array<std::array<float, 2>, kHistory> commands_{};
  std::size_t now_ = 0;      // the newest of them
  float excitation_ = 0.0F;  // mm/s: changes of the command, fading
  int frozen_ticks_ = 0;     // left, in which nothing is concluded about the plant
  int steady_ticks_ = 0;
  PlantEstimate estimate_{};
  WheelSpeeds driven_{};
};

}  // namespace cargobay::rt
