// Keeps the robot on the curve that it is asked for: what the wheels went out of proportion while
// they started, or were disturbed, they take back.
//
// The way of the wheels since the curve began, across the direction that both have together in it
// (equal for a straight line, opposite for a turn on the spot), is the error. It is taken back
// in some seconds, with speeds that are small beside those asked for, and so is what the robot went
// aside for it.
//
// One thread; no allocation.
#pragma once

#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

class Course {
 public:
  struct Parameters {
    // Whether the heading follows what it should have become by all that was asked for so far, also
    // across stops and other curves; otherwise, only the present curve is kept.
    bool hold_heading = false;
    // Of an error, so much is taken back in a second.
    double rate_1_s = 0.3;
    double holding_rate_1_s = 1.0;
  };
  // How far the wheels have gone, mm, by each kind that the robot may be of.
  struct Ways {
    WheelSpeeds if_carried{};
    WheelSpeeds if_lost{};
    // By how much a reading has just corrected the turn of the latter, right less left: it has come
    // about since the reading before, evenly.
    double corrected_mm = 0.0;
  };

  // How well the robot is known by now.
  struct Known {
    double carried = 0.5;  // how likely it carries the remainder, 0 to 1
    bool gains = false;    // to a hundredth: no load has just come, the first step is over
  };

  explicit Course(const Parameters& parameters) : parameters_{parameters} {}

  // The wheels do what nobody asked for, or stand: nothing of it is to be taken back.
  void forget() CARGOBAY_NONBLOCKING;

  // One tick, at whose end the wheels have gone `ways` and turn at `now`. Returns the set speeds
  // that bring it back.
  WheelSpeeds step(const WheelSpeeds& target, const WheelSpeeds& set, const WheelSpeeds& now,
                   const Ways& ways, const Known& known, double tick_s) CARGOBAY_NONBLOCKING;

 private:
  bool follows(const WheelSpeeds& target, const WheelSpeeds& now) CARGOBAY_NONBLOCKING;
  double off_mm() const CARGOBAY_NONBLOCKING;
  void go_aside(const Ways& ways, double way_mm, double carried) CARGOBAY_NONBLOCKING;
  double held_back_mm_s(const WheelSpeeds& set) const CARGOBAY_NONBLOCKING;
  double back_mm_s(const WheelSpeeds& set, const WheelSpeeds& now, const Known& known) const
      CARGOBAY_NONBLOCKING;
  double across(const WheelSpeeds& way) const CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  WheelSpeeds along_{};  // a unit vector: the share of each wheel in the curve; 0 if there is none
  Ways former_{};
  WheelSpeeds former_set_{};
  bool on_curve_ = false;       // the wheels have come to it
  double if_carried_mm_ = 0.0;  // the errors
  double if_lost_mm_ = 0.0;
  // How far the right wheel is ahead of where it should be, less that of the left one.
  double error_mm_ = 0.0;
  double unread_way_mm_ = 0.0;  // since a reading corrected the turn
  double aside_mm_ = 0.0;  // what the way went aside for it, as an error to be had for the way back
};

}  // namespace cargobay::rt
