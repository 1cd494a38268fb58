// What a control cycle reports about itself: why it ended, the state of each tick, what it counts;
// and the functions that it calls.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "hal/cycle/request.hpp"
#include "hal/sensing/events.hpp"
#include "oi/command_table.hpp"
#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"
#include "rt/odometry.hpp"
#include "rt/wheel_estimator.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

// Why the cycle ended.
enum class CycleEnd : std::uint8_t {
  asked,            // request_stop()
  link_lost,        // no frame for longer than link_timeout
  mode_lost,        // the robot left the mode it was driven in: mode_loss_causes()
  hung_up,          // a call on the port failed: it is gone, or no longer ours: port_error()
  guarded,          // the cycle stood still for so long that its guard stopped the robot
  control_overrun,  // the control function was over its budget too many times in a row
  guard_lost,       // the guard is dead or suspended: nothing would stop the robot in our place
  control_failed,   // the control function said so
  implausible,      // a wheel is stuck, or the counters cannot be true: its event says which
};

// One tick of the loop, as others see it.
struct CycleState {
  // Of the robot, since the first frame. The same as before if this frame had been given up.
  std::int64_t tick = 0;
  rt::TimePoint arrival{};   // of the frame, on the stream's clock
  rt::WheelSpeeds target{};  // as asked for; 0 if nothing valid was
  rt::WheelSpeeds set{};     // after the acceleration limit
  Limits limits{};           // that hold the wheels back from the target
  rt::WheelSpeeds estimate{};
  rt::WheelSpeeds command{};  // as sent
  rt::RemainderBelief remainder = rt::RemainderBelief::unknown;
  oi::Mode mode = oi::Mode::off;
  bool setpoint_lapsed = false;  // nothing steers: it was not renewed, or dropped, or impossible
  Hazards hazards{};             // in this frame, whether or not they stop the robot
  // What the robot reported of its counters, as far as this frame reads them.
  rt::WheelEstimator::Reading reading{};
  std::int32_t battery_mv = 0;  // 0 until the first frame that has it
  Bumps bumps{};                // as in the last frame that has them
  rt::OdometryPose pose{};      // by odometry
  double distance_mm = 0.0;
  rt::PoseCovariance pose_covariance{};
};

// After the first frame, each tick of the robot is counted once: good, bad or lost. Frames that may
// still be in flight when the cycle ends are not counted. After a lost link none are in flight, so
// every frame that was due is counted.
struct FrameCounters {
  std::uint64_t good = 0;
  std::uint64_t bad = 0;   // damaged on the way
  std::uint64_t lost = 0;  // never came, damaged ones not included
  std::uint64_t late = 0;  // deadlines that passed without a frame
};

// How often a phase of the cycle took longer than allowed. Each phase is counted separately.
struct PhaseOverruns {
  std::uint64_t wait = 0;   // the frame arrived more than late_margin after its time
  std::uint64_t read = 0;   // reading and decoding it: 1 ms
  std::uint64_t user = 0;   // the control function: control_budget
  std::uint64_t write = 0;  // control and sending: 1 ms
};

// All that is counted, as of one frame.
struct CycleCounters {
  FrameCounters frames{};
  PhaseOverruns overruns{};
  std::uint64_t unsent = 0;    // commands that the port did not take whole
  std::uint64_t withheld = 0;  // not sent: the robot might have got them in the tick of the last
  std::uint64_t refused = 0;   // answers of the control function that no robot can follow
};

// What a control function wants. As large as the speeds, and as quick to return: what is not speeds
// has no number for the left wheel, and its kind for the right.
class ControlAnswer {
 public:
  enum class Kind : std::uint8_t {
    speeds,    // these
    setpoint,  // what the latest setpoint says, as if there were no control function
    stand,     // to stand still, as if a setpoint had lapsed
    finish,    // the cycle to end, as asked
    fail,      // the cycle to end with CycleEnd::control_failed
  };

  // Implicit, for `return speeds;` and `return ControlAnswer::Kind::finish;`.
  // NOLINTBEGIN(google-explicit-constructor): implicit on purpose, as said above
  ControlAnswer(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING : speeds_{speeds} {
    if (std::isnan(speeds.left_mm_s)) speeds_.right_mm_s = 0.0;  // of kind `speeds`
  }
  ControlAnswer(Kind kind) CARGOBAY_NONBLOCKING
      : speeds_{std::numeric_limits<double>::quiet_NaN(), static_cast<double>(kind)} {}
  // NOLINTEND(google-explicit-constructor)

  Kind kind() const CARGOBAY_NONBLOCKING {
    if (!std::isnan(speeds_.left_mm_s)) return Kind::speeds;
    return static_cast<Kind>(static_cast<std::uint8_t>(speeds_.right_mm_s));
  }
  // 0 for a kind that has none.
  rt::WheelSpeeds speeds() const CARGOBAY_NONBLOCKING {
    return kind() == Kind::speeds ? speeds_ : rt::WheelSpeeds{};
  }

 private:
  rt::WheelSpeeds speeds_;
};

// Called once per frame on the control thread, between estimate and command: returns the wanted
// wheel speeds, each within -500 to 500 mm/s; for any others the wheels stop, and the answer is
// counted. It must not block, lock, allocate or throw. `seconds` is robot time since the first
// frame. It is not called while the robot has lost its mode.
struct ControlFunction {
  ControlAnswer (*function)(void* context, const CycleState& state, double seconds)
      CARGOBAY_NONBLOCKING = nullptr;
  void* context = nullptr;  // must outlive the cycle
};

// Called once per frame on the control thread, after the command, with everything about the tick.
// The rules are those of a ControlFunction.
struct StateObserver {
  void (*function)(void* context, const CycleState& state) CARGOBAY_NONBLOCKING = nullptr;
  void* context = nullptr;  // must outlive the cycle
  // Called for each request when the cycle takes it up; may be null.
  void (*request)(void* context, const Request& request) CARGOBAY_NONBLOCKING = nullptr;
  // Called for each event as it is reported; may be null.
  void (*event)(void* context, const Event& event) CARGOBAY_NONBLOCKING = nullptr;
  // Called by whoever runs the cycle, once it has ended; may be null.
  void (*ended)(void* context) CARGOBAY_NONBLOCKING = nullptr;
};

}  // namespace cargobay::hal
