// The closed velocity loop of both wheels: estimator, read schedule, acceleration limit and
// controllers, one step per tick of the robot. Knows no clock, no bytes and no port, so that a
// recording can be replayed bit for bit.
#pragma once

#include "rt/axes.hpp"
#include "rt/course.hpp"
#include "rt/nonblocking.hpp"
#include "rt/read_schedule.hpp"
#include "rt/slew_limiter.hpp"
#include "rt/velocity_controller.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_speeds.hpp"
#include "rt/wheel_watch.hpp"

namespace cargobay::rt {

class WheelLoop {
 public:
  // Whether the estimate affects the command.
  enum class Feedback { closed, open };

  // What keeps the wheels from the speeds that were asked for. Both wheels are held back by one
  // factor, so that the robot keeps to its curve.
  struct Limited {
    bool speed = false;         // beyond what the weaker wheel can reach, or may be driven at
    bool acceleration = false;  // the set speeds are on their way
    friend constexpr bool operator==(const Limited&, const Limited&) = default;
  };

  struct Parameters {
    WheelEstimator::Parameters estimator{};
    VelocityController::Parameters controller{};
    ReadSchedule::Parameters schedule{};
    SlewLimiter::Limits limits{};
    Course::Parameters course{};
    Feedback feedback = Feedback::closed;
  };

  explicit WheelLoop(const Parameters& parameters);

  // What one tick brought: call these first, in this order, ...
  void lost(int ticks, const Axes& may_have_read) CARGOBAY_NONBLOCKING;
  void came_after_all(int frames) CARGOBAY_NONBLOCKING { estimator_.came_after_all(frames); }
  void doubt_next_reading(const Axes& axes) CARGOBAY_NONBLOCKING {
    estimator_.doubt_next_reading(axes);
  }
  void frame(const WheelEstimator::Reading& reading) CARGOBAY_NONBLOCKING;
  // ... and then this, once. Returns the command for the wheels, whole mm/s within the robot's
  // range. When the acceleration limit has brought the set speed to a target of 0, the command is
  // exactly 0.
  WheelSpeeds control(const WheelSpeeds& target) CARGOBAY_NONBLOCKING;
  // The same for wheels that nobody steers: they are told to stand, however gentle the limits.
  WheelSpeeds stand() CARGOBAY_NONBLOCKING {
    slew_.reset({});
    return control({});
  }
  // The command could not be sent: the previous one still acts.
  void not_sent(const WheelSpeeds& former) CARGOBAY_NONBLOCKING { command_ = former; }
  // The command may act a tick later than one sent in time.
  void sent_late() CARGOBAY_NONBLOCKING { estimator_.doubt_command(); }

  // The wheels were told to stop, past the acceleration limit: they start again from standstill.
  void stop() CARGOBAY_NONBLOCKING;

  // What is wrong with counters or wheels, if anything.
  const WheelWatch::Evidence& evidence() const CARGOBAY_NONBLOCKING { return watch_.evidence(); }

  WheelSpeeds estimate() const CARGOBAY_NONBLOCKING { return estimator_.speeds(); }
  Travels take_travels() CARGOBAY_NONBLOCKING { return estimator_.take_travels(); }
  // The target after the acceleration limit.
  WheelSpeeds set() const CARGOBAY_NONBLOCKING { return slew_.speeds(); }
  // That, as far as the wheels can reach it, and what limited the last step.
  const WheelSpeeds& given() const CARGOBAY_NONBLOCKING { return given_; }
  const Limited& limited() const CARGOBAY_NONBLOCKING { return limited_; }
  WheelSpeeds command() const CARGOBAY_NONBLOCKING { return command_; }
  RemainderBelief belief() const CARGOBAY_NONBLOCKING { return estimator_.belief(); }
  // Whether much speaks for that.
  bool sure() const CARGOBAY_NONBLOCKING { return estimator_.sure(); }
  // What is known of the wheels and their motors.
  const PlantEstimate& plant() const CARGOBAY_NONBLOCKING { return estimator_.plant(); }
  LearntPlant learnt() const CARGOBAY_NONBLOCKING { return estimator_.learnt(); }
  // Call once a tick. What the frame of the next tick should read.
  Axes next_reads() CARGOBAY_NONBLOCKING;

 private:
  double answer(const VelocityController::Wish& wish, const VelocityController::Wheel& wheel) const
      CARGOBAY_NONBLOCKING;
  Course::Known known() const CARGOBAY_NONBLOCKING;
  double proportional() const CARGOBAY_NONBLOCKING;
  bool suspicious() const CARGOBAY_NONBLOCKING;
  bool suspects() const CARGOBAY_NONBLOCKING;
  double reach(double target_mm_s, double gain) const CARGOBAY_NONBLOCKING;
  double reachable_part(const WheelSpeeds& set, const WheelSpeeds& target) CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  WheelEstimator estimator_;
  WheelWatch watch_;
  ReadSchedule schedule_;
  SlewLimiter slew_;
  Course course_;
  VelocityController controller_;
  WheelSpeeds command_{};
  WheelSpeeds given_{};
  int suspicious_ticks_ = 0;  // left, in which both counters are read in short windows
  double part_ = 1.0;         // of the set speeds
  Limited limited_{};
};

}  // namespace cargobay::rt
