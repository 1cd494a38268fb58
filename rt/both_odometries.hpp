// Odometry of a robot whose kind of remainder is not known yet: for both kinds, until one is sure.
//
// One thread; no allocation.
#pragma once

#include "rt/nonblocking.hpp"
#include "rt/odometry.hpp"
#include "rt/remainder.hpp"
#include "rt/travel.hpp"

namespace cargobay::rt {

class BothOdometries {
 public:
  explicit BothOdometries(const Odometry::Parameters& parameters)
      : carried_{parameters}, lost_{parameters} {}

  // The robot is known to be at `pose`, for certain.
  void reset(const OdometryPose& pose) CARGOBAY_NONBLOCKING {
    carried_.reset(pose);
    lost_.reset(pose);
  }

  // `sure`: much speaks for `belief`. When the belief changes, the pose becomes that which it would
  // have been from the start, or from when the kind was last sure.
  void step(const Travels& travels, RemainderBelief belief, bool sure) CARGOBAY_NONBLOCKING {
    if (was_sure_ && !sure) (is_carried_ ? lost_ : carried_) = now();
    is_carried_ = belief == RemainderBelief::carried;
    if (!sure) {
      carried_.step(travels.if_carried);
      lost_.step(travels.if_lost);
    } else if (is_carried_) {
      carried_.step(travels.if_carried);
      if (!was_sure_) lost_ = carried_;
    } else {
      lost_.step(travels.if_lost);
      if (!was_sure_) carried_ = lost_;
    }
    was_sure_ = sure;
  }

  // The likelier one.
  const Odometry& now() const CARGOBAY_NONBLOCKING { return is_carried_ ? carried_ : lost_; }

 private:
  Odometry carried_;
  Odometry lost_;
  bool is_carried_ = false;
  bool was_sure_ = false;
};

}  // namespace cargobay::rt
