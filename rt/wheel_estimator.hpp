// Wheel speeds from the distance and angle that the robot reports, whichever kind of robot it is.
//
// Distance is the mean of the wheels' travel in whole mm, angle their difference over the wheel
// base in whole degrees; the part below one step is carried to the next reading by some robots and
// lost by others. Both kinds are estimated side by side, with an AxisFilter for each axis; which
// kind it is, the counts decide (rt/remainder_judge.hpp), and as long as they are silent, a little
// of what the filters expected. How the wheels answer a command is learnt by the way
// (rt/plant_bank.hpp), and the filters predict with what is known of it.
//
// Steps by the robot's tick, never by arrival time. One thread; no allocation.
#pragma once

#include <cstdint>
#include <optional>

#include "rt/axis_filter.hpp"
#include "rt/nonblocking.hpp"
#include "rt/plant_bank.hpp"
#include "rt/remainder.hpp"
#include "rt/remainder_judge.hpp"
#include "rt/travel.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

class WheelEstimator {
 public:
  struct Parameters {
    double wheel_base_mm = 258.0;
    double tick_s = 0.015;
    double likely_lag_s = 0.100;     // of the wheels, before anything is known of them
    double input_delay_s = 0.0025;   // from the tick to the arrival of the command it caused
    double speed_noise_mm_s = 2.0;   // of a wheel, each tick
    double decision_log_odds = 5.0;  // evidence that settles the kind for now: 150 to 1
    // Known from the configuration; if empty, the estimator finds out.
    std::optional<Remainder> remainder{};
    // How the wheels answer, if that is known for certain; if empty, it is learnt.
    std::optional<PlantEstimate> told{};
    // What an earlier drive learnt: where this one begins, as far as it is believed. Its kind of
    // remainder only weighs the two speeds until the readings have decided.
    std::optional<LearntPlant> prior{};
  };

  // What a frame said about the counters.
  struct Reading {
    int distance_mm = 0;
    int angle_deg = 0;
  };

  explicit WheelEstimator(const Parameters& parameters);

  // Before the first motion, and after the wheels were out of our control.
  void reset() CARGOBAY_NONBLOCKING;

  // One tick of the robot has passed and its frame is here. `command`: what was sent in answer to
  // the frame before. `reading`: what the frame carries; nothing if it does not read the counters.
  void step(const WheelSpeeds& command, const std::optional<Reading>& reading) CARGOBAY_NONBLOCKING;

  // The next reading may cover several ticks. That cannot be known yet, so it says nothing.
  void doubt_next_reading() CARGOBAY_NONBLOCKING { reading_unsure_ = true; }

  // It is not known from which tick on the present command acts, for example when the robot was
  // told to stop while no frames arrived: for three lags, what the filters expect is no evidence
  // for either kind.
  void doubt_command() CARGOBAY_NONBLOCKING;

  // One tick has passed and its frame is lost. `may_have_read`: it may have carried a reading.
  void step_lost(const WheelSpeeds& command, bool may_have_read) CARGOBAY_NONBLOCKING;

  // The next `frames` frames were taken for lost: their ticks have been counted. What they read is
  // of the past and will be missing from the reading after them, so neither says anything.
  void came_after_all(int frames) CARGOBAY_NONBLOCKING { gone_through_ += frames; }

  WheelSpeeds speeds() const CARGOBAY_NONBLOCKING;
  // Travel since the last call, or since reset(), for each kind that the robot may be of.
  Travels take_travels() CARGOBAY_NONBLOCKING;
  RemainderBelief belief() const CARGOBAY_NONBLOCKING { return belief_; }
  // What is known of the wheels and their motors.
  const PlantEstimate& plant() const CARGOBAY_NONBLOCKING { return bank_.estimate(); }
  // The same with all spreads, the kind of remainder and how long the wheels have been told to
  // move. Takes about as long as a tick.
  LearntPlant learnt() const CARGOBAY_NONBLOCKING;
  // By how much the wheels end up faster than that alone would make them.
  WheelSpeeds disturbances() const CARGOBAY_NONBLOCKING;
  // Whether much speaks for it.
  bool sure() const CARGOBAY_NONBLOCKING;
  // Whether the counters have read 0 twice in a row.
  bool rests() const CARGOBAY_NONBLOCKING { return zeros_ >= 2; }
  // Evidence for `carried` over `lost`, natural logarithm of the odds.
  double log_odds_carried() const CARGOBAY_NONBLOCKING { return log_odds_; }
  // Natural logarithm of the probability that the likelier kind of robot gave to all readings that
  // were believed. The best fit to a drive has the greatest.
  double log_likelihood() const CARGOBAY_NONBLOCKING {
    return log_odds_ > 0.0 ? carried_likelihood_ : lost_likelihood_;
  }
  // Standard deviation that the filter itself states for one wheel's speed.
  double speed_sd_mm_s() const CARGOBAY_NONBLOCKING;

 private:
  // Travel and forgotten variance of a hypothesis when they were last taken.
  struct Taken {
    double distance_mm = 0.0;
    double turn_mm = 0.0;
    double distance_variance = 0.0;
    double turn_variance = 0.0;
  };
  struct Hypothesis {
    Remainder remainder = Remainder::carried;
    AxisFilter distance;
    AxisFilter turn;
    Taken taken{};
  };
  void predict(const WheelSpeeds& command) CARGOBAY_NONBLOCKING;
  WheelSpeeds mix(double (AxisFilter::*value)() const CARGOBAY_NONBLOCKING) const
      CARGOBAY_NONBLOCKING;
  bool plausible(const Reading& reading) const CARGOBAY_NONBLOCKING;
  void read_unseen() CARGOBAY_NONBLOCKING;
  void weigh(double by_counts, double by_filters) CARGOBAY_NONBLOCKING;
  void set_log_odds(double log_odds) CARGOBAY_NONBLOCKING;
  double prior_log_odds() const CARGOBAY_NONBLOCKING;

  Travel take_travel(Hypothesis& hypothesis) const CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  Hypothesis carried_;
  Hypothesis lost_;
  PlantBank bank_;
  RemainderJudge judge_{};
  int zeros_ = 0;           // readings in a row
  int command_unsure_ = 0;  // ticks left
  // Evidence for `carried` over `lost`, logarithms of the odds; log_odds_ is the sum.
  double counts_say_ = 0.0;
  double filters_say_ = 0.0;
  double log_odds_ = 0.0;
  double carried_weight_ = 0.5;  // the same odds as a probability, with those of the prior
  double carried_likelihood_ = 0.0;
  double lost_likelihood_ = 0.0;
  RemainderBelief belief_ = RemainderBelief::unknown;
  std::int64_t moved_ticks_ = 0;
  int ticks_since_read_ = 0;
  int gone_through_ = 0;         // frames to come whose ticks step_lost() has counted
  bool reading_unsure_ = false;  // a read may have gone unseen: the next one says nothing
};

}  // namespace cargobay::rt
