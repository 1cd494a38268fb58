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
#include <optional>

#include "rt/learnt_plant.hpp"
#include "rt/nonblocking.hpp"
#include "rt/plant_models.hpp"
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
  // Standard deviations: of the lag; of the gain of the axis in which the robot moves; and of the
  // difference of the wheels' gains, which the distance of a straight line does not show.
  double lag_sd_s = 0.0;
  double gain_sd = 0.0;
  double gain_difference_sd = 0.0;
  double gain_left_sd = 0.0;
  double gain_right_sd = 0.0;
  // A load has made the wheels weaker: they are not stronger than that, however wide the spread.
  bool weakened = false;
};

class PlantBank {
 public:
  using Axis = rt::Axis;

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
  // `speeds`: of the wheels, as far as they are known otherwise.
  void read(Axis axis, int count, int ticks, RemainderBelief remainder, const WheelSpeeds& speeds)
      CARGOBAY_NONBLOCKING;
  // The axis was read, but what it said is not known, or not to be believed.
  void read_unseen(Axis axis) CARGOBAY_NONBLOCKING;

  // To be called when all of a frame was read: what it taught is in the estimate then.
  void conclude() CARGOBAY_NONBLOCKING;

  // Whether the commands have hardly changed of late: then all models foresee the same.
  bool steady() const CARGOBAY_NONBLOCKING;

  // Whether a reading within the last second missed what all models foresaw alike, as if the load
  // had changed: what comes next should be read soon.
  bool load_in_doubt() const CARGOBAY_NONBLOCKING { return doubtful_ticks_ > 0; }

  const PlantEstimate& estimate() const CARGOBAY_NONBLOCKING { return estimate_; }
  // The same with all spreads, but nothing of the remainder or of time.
  LearntPlant learnt() const CARGOBAY_NONBLOCKING;
  // What the wheels were driven at in the last tick, before gain and lag: the command after dead
  // time and ramp, mean of the tick.
  const WheelSpeeds& driven() const CARGOBAY_NONBLOCKING { return driven_; }

 private:
  using Lags = PlantModels::Lags;
  using Models = PlantModels::Models;
  using Drives = PlantModels::Drives;
  using Memory = PlantModels::Memory;

  // Covariance of the gains.
  struct GainCovariance {
    Models left_left{};
    Models left_right{};
    Models right_right{};
  };
  // One axis of what is read.
  struct Readings {
    float way_mm = 0.0F;  // as far as it is remembered for longer
    int waiting = 0;      // ticks since that was weighed
    int weighed = 0;      // times since something of it was forgotten
    int misfits = 0;      // in a row; negative if the robot fell short
    int since = 0;        // ticks since it was read
    // The next reading began before what is remembered of the ways.
    bool unsure = false;
    // It is read every tick, and what is remembered of the last reading is old.
    bool at_once = false;
  };
  // One reading, as it is weighed: the way lies between these.
  struct Seen {
    float low_mm;
    float high_mm;
    float variance;
    bool lost;
  };

  // What the models of a lag expected of it, but for what they will foresee by their gains.
  struct Expected {
    std::size_t at = 0;
    float by_left = 0.0F;
    float by_right = 0.0F;
    Lags low_mm{};
    Lags high_mm{};
  };

  void set_prior();
  double expected_from(const LearntPlant& prior, std::size_t model) const CARGOBAY_NONBLOCKING;
  void mix_gains(const LearntPlant& prior, std::size_t model, double share) CARGOBAY_NONBLOCKING;
  void sum_drives() CARGOBAY_NONBLOCKING;
  float steps_mm(Axis axis) const CARGOBAY_NONBLOCKING;
  void read_carried(Axis axis, const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING;
  void read_window(Axis axis, int count, bool lost, const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING;
  void fade(Axis axis, float part) CARGOBAY_NONBLOCKING;
  bool alike() const CARGOBAY_NONBLOCKING;
  void choose_drives(bool all) CARGOBAY_NONBLOCKING;
  void weigh(Axis axis, Memory memory, const Seen& seen, const WheelSpeeds& speeds)
      CARGOBAY_NONBLOCKING;
  Expected expected_of(Axis axis, Memory memory, const Seen& seen) const CARGOBAY_NONBLOCKING;
  std::array<Lanes, 2> ways(std::size_t drive, std::size_t part, const Expected& expected) const
      CARGOBAY_NONBLOCKING;
  float expect(std::size_t drive, const Expected& expected) CARGOBAY_NONBLOCKING;
  float foreseen_variance(const Expected& expected) const CARGOBAY_NONBLOCKING;
  float learn(std::size_t drive, const Seen& seen, const Expected& expected) CARGOBAY_NONBLOCKING;
  void give_back(float before, float after) CARGOBAY_NONBLOCKING;
  bool load_changed(Readings& readings, float misfit, bool lost) CARGOBAY_NONBLOCKING;
  void widen() CARGOBAY_NONBLOCKING;
  void begin_again(const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING;
  void average_gains() CARGOBAY_NONBLOCKING;
  void state_spread(float left_left, float left_right, float right_right) CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  PlantModels::Grid grid_;
  PlantModels models_;
  Models prior_{};
  std::array<Models, 2> gain_{};
  GainCovariance covariance_{};
  Models weight_{};
  Models miss_{};                                           // mm, of the last reading
  std::array<float, PlantModels::kDrives> drive_weight_{};  // sums over the lags
  Drives drive_weights_{};                                  // the same
  std::array<Readings, 2> readings_{};
  std::array<bool, PlantModels::kDrives> chosen_{};  // to be weighed now
  std::size_t turn_ = 0;     // of the drives that are weighed one after the other
  float excitation_ = 0.0F;  // mm/s: changes of the command, fading
  int frozen_ticks_ = 0;     // left, in which nothing is concluded about the plant
  int doubtful_ticks_ = 0;   // left, since a reading missed although the commands were steady
  int steady_ticks_ = 0;
  bool concluded_ = true;  // all that was read is in the estimate
  PlantEstimate estimate_{};
  WheelSpeeds driven_{};
};

}  // namespace cargobay::rt
