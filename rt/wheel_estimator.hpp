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

#include "rt/axes.hpp"
#include "rt/axis_filter.hpp"
#include "rt/course.hpp"
#include "rt/nonblocking.hpp"
#include "rt/plant_bank.hpp"
#include "rt/remainder.hpp"
#include "rt/remainder_judge.hpp"
#include "rt/travel.hpp"
#include "rt/turn_observer.hpp"
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

  // What a frame said about the counters: those that it reads.
  struct Reading {
    std::optional<int> distance_mm{};
    std::optional<int> angle_deg{};
    constexpr Axes axes() const CARGOBAY_NONBLOCKING {
      return {.distance = distance_mm.has_value(), .turn = angle_deg.has_value()};
    }
  };
  // What has gathered on an axis since it was last read, in steps of its counter, as far as is
  // known.
  struct Unread {
    double steps = 0.0;
    double sd = 0.0;
    double steps_a_tick = 0.0;  // by which it grows now
    int blank_ticks = 0;        // that its last reading took to say 0; 0 if it said more
  };

  // What became of the reading of a step.
  struct Seen {
    enum class How : std::uint8_t {
      none,  // there was none
      past,  // its tick had been counted before
      believed,
      unsure,      // it may cover another time than it seems to
      impossible,  // no robot can have gone so far
      wild,        // a way far beyond all that was foreseen, or far back, for the first time
    };
    How how = How::none;
    int distance_ticks = 0;  // since its last reading
    int turn_ticks = 0;
    bool strange = false;  // where the remainder is lost: a part of the wheels' way is off
  };

  explicit WheelEstimator(const Parameters& parameters);

  // Before the first motion, and after the wheels were out of our control.
  void reset() CARGOBAY_NONBLOCKING;

  // One tick of the robot has passed and its frame is here. `command`: what was sent in answer to
  // the frame before. `reading`: what the frame carries.
  void step(const WheelSpeeds& command, const Reading& reading) CARGOBAY_NONBLOCKING;

  // The next reading of these may cover several ticks. That cannot be known yet, so it says
  // nothing.
  void doubt_next_reading(const Axes& axes) CARGOBAY_NONBLOCKING {
    distance_.unsure = distance_.unsure || axes.distance;
    turn_.unsure = turn_.unsure || axes.turn;
  }

  // It is not known from which tick on the present command acts, for example when the robot was
  // told to stop while no frames arrived: for three lags, what the filters expect is no evidence
  // for either kind.
  void doubt_command() CARGOBAY_NONBLOCKING;

  // One tick has passed and its frame is lost. `may_have_read`: what it may have carried.
  void step_lost(const WheelSpeeds& command, const Axes& may_have_read) CARGOBAY_NONBLOCKING;

  // The next `frames` frames were taken for lost: their ticks have been counted. What they read is
  // of the past and will be missing from the reading after them, so neither says anything.
  void came_after_all(int frames) CARGOBAY_NONBLOCKING { gone_through_ += frames; }

  // Of the last step().
  // Whether the last reading of an axis was far from all that was foreseen.
  bool surprised() const CARGOBAY_NONBLOCKING { return distance_.surprised || turn_.surprised; }
  const Seen& seen() const CARGOBAY_NONBLOCKING { return seen_; }

  WheelSpeeds speeds() const CARGOBAY_NONBLOCKING;
  // How far the wheels have gone since reset(), for each kind that the robot may be of.
  Course::Ways ways() const CARGOBAY_NONBLOCKING;
  // How likely the robot is to carry the remainder.
  double carried() const CARGOBAY_NONBLOCKING { return carried_weight_; }
  // Travel since the last call, or since reset(), for each kind that the robot may be of.
  Travels take_travels() CARGOBAY_NONBLOCKING;
  RemainderBelief belief() const CARGOBAY_NONBLOCKING { return belief_; }
  // What is known of the wheels and their motors.
  const PlantEstimate& plant() const CARGOBAY_NONBLOCKING { return bank_.estimate(); }
  // The same with all spreads, the kind of remainder and how long the wheels have been told to
  // move.
  LearntPlant learnt() const CARGOBAY_NONBLOCKING;
  // Whether the load has changed of late, or seems to.
  bool load_in_doubt() const CARGOBAY_NONBLOCKING { return bank_.load_in_doubt(); }
  // By how much the wheels end up faster than that alone would make them.
  WheelSpeeds disturbances() const CARGOBAY_NONBLOCKING;
  // Whether much speaks for it.
  bool sure() const CARGOBAY_NONBLOCKING;
  // Whether the robot stands still, by what was read: the distance was 0 twice in a row, and so was
  // the angle, or it is known well enough that nothing more gathers.
  bool rests() const CARGOBAY_NONBLOCKING;
  // As a robot that loses the remainder has it.
  Unread unread_distance() const CARGOBAY_NONBLOCKING;
  Unread unread_turn() const CARGOBAY_NONBLOCKING;
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
  // The readings of an axis.
  struct Counter {
    int ticks = 0;             // since it was read
    int zeros = 0;             // read in a row, while the wheels are told to stand
    int blank_ticks = 0;       // as Unread has it
    double straight_mm = 0.0;  // by which wheels of gain 1 went straight since it was read
    bool unsure = false;       // a read may have gone unseen: the next one says nothing
    bool surprised = false;    // the last reading was far from all that was foreseen
    RemainderJudge judge{};
  };
  void predict(const WheelSpeeds& command) CARGOBAY_NONBLOCKING;
  // Evidence for `carried`.
  struct Evidence {
    double by_counts = 0.0;
    double by_filters = 0.0;
  };
  Evidence read(Axis axis, int count) CARGOBAY_NONBLOCKING;
  WheelSpeeds mix(double (AxisFilter::*value)() const CARGOBAY_NONBLOCKING) const
      CARGOBAY_NONBLOCKING;
  bool plausible(const Reading& reading) const CARGOBAY_NONBLOCKING;
  // By how much a reading is off what was foreseen.
  struct Miss {
    double mm;
    double foreseen_mm;
    double sd_mm;  // of what was foreseen
    double step_mm;
  };
  Miss miss(Axis axis, double count) const CARGOBAY_NONBLOCKING;
  bool surprising(Axis axis, int count) const CARGOBAY_NONBLOCKING;
  bool wild(const Reading& reading) const CARGOBAY_NONBLOCKING;
  bool strange(Axis axis, int count) const CARGOBAY_NONBLOCKING;
  void read_unseen(Axis axis) CARGOBAY_NONBLOCKING;
  void weigh(double by_counts, double by_filters) CARGOBAY_NONBLOCKING;
  void set_log_odds(double log_odds) CARGOBAY_NONBLOCKING;
  double prior_log_odds() const CARGOBAY_NONBLOCKING;

  void follow_turn(const AxisFilter::Response& response, const AxisFilter::Doubt& doubt)
      CARGOBAY_NONBLOCKING;
  TurnObserver::Begin gains() const CARGOBAY_NONBLOCKING;
  Travel take_travel(Hypothesis& hypothesis) const CARGOBAY_NONBLOCKING;
  void observe_turn(Travel& travel) CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  Hypothesis carried_;
  Hypothesis lost_;
  Taken taken_turns_{};
  PlantBank bank_;
  TurnObserver turns_;  // of a robot that loses the remainder
  bool follows_turns_ = true;
  // By how much a reading of the last step corrected it, and all since its travel was taken.
  double just_corrected_mm_ = 0.0;
  double corrected_mm_ = 0.0;
  Counter distance_{};
  Counter turn_{};
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
  Seen seen_{};
  int gone_through_ = 0;  // frames to come whose ticks step_lost() has counted
};

}  // namespace cargobay::rt
