// Setpoints, and everything else that changes how the loop drives.
#include <cmath>

#include "hal/c/cargobay.h"
#include "hal/c/durations.hpp"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "oi/limits.hpp"

namespace cargobay::c {
namespace {

int drive(cargobay_robot* robot, const cargobay_wheels& wheels) noexcept {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  constexpr double kMost = oi::kMaxWheelSpeed;
  const bool possible = std::abs(wheels.left_mm_s) <= kMost && std::abs(wheels.right_mm_s) <= kMost;
  if (!possible)  // also if one is not a number
    return bad_argument(
        "a wheel would have to go faster than 500 mm/s, or the speed is not a number");
  if (const int failed = use->must_run(); failed != CARGOBAY_OK) return failed;
  if (use->control != nullptr) {
    return fail(CARGOBAY_E_STATE,
                "a control function decides the speeds; set them there, or start without one");
  }
  const auto state = use->robot->cycle().state();
  const oi::Mode mode = state ? state->mode : oi::Mode::safe;
  if (mode != oi::Mode::safe && mode != oi::Mode::full) {
    return fail(CARGOBAY_E_MODE,
                "the robot has left its mode and obeys no drive commands; see the event, put it "
                "right, then cargobay_rearm()");
  }
  // In range, so it is accepted.
  (void)use->robot->cycle().set_speeds({wheels.left_mm_s, wheels.right_mm_s});
  return CARGOBAY_OK;
}

// The wheel base of a robot; 0, with the error recorded, for an invalid handle.
double wheel_base_mm(cargobay_robot* robot) noexcept {
  const RobotUse use = robots().use(robot);
  return use ? use->wheel_base_mm : 0.0;
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below

extern "C" {

struct cargobay_wheels cargobay_wheels_of(double velocity_mm_s, double turn_rate_rad_s,
                                          double wheel_base_mm) {
  const double apart_mm_s = turn_rate_rad_s * wheel_base_mm / 2.0;
  return {velocity_mm_s - apart_mm_s, velocity_mm_s + apart_mm_s};
}

int cargobay_drive_wheels(struct cargobay_robot* robot, double left_mm_s, double right_mm_s) {
  return drive(robot, {left_mm_s, right_mm_s});
}

int cargobay_drive(struct cargobay_robot* robot, double velocity_mm_s, double turn_rate_rad_s) {
  return drive(robot, cargobay_wheels_of(velocity_mm_s, turn_rate_rad_s, wheel_base_mm(robot)));
}

int cargobay_drive_radius(struct cargobay_robot* robot, double velocity_mm_s, double radius_mm) {
  if (std::isnan(radius_mm))
    return bad_argument("`radius_mm` is not a number; INFINITY is straight on, 0 turns in place");
  if (radius_mm == 0.0) return drive(robot, {-velocity_mm_s, velocity_mm_s});
  return cargobay_drive(robot, velocity_mm_s, velocity_mm_s / radius_mm);
}

int cargobay_rearm(struct cargobay_robot* robot) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  if (const int failed = use->must_run(); failed != CARGOBAY_OK) return failed;
  use->robot->cycle().request_rearm();
  return CARGOBAY_OK;
}

int cargobay_expect_silence(struct cargobay_robot* robot, int64_t duration_ns) {
  if (const int bad = check_duration("duration_ns", duration_ns); bad != CARGOBAY_OK) return bad;
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  if (const int failed = use->must_run(); failed != CARGOBAY_OK) return failed;
  use->robot->cycle().expect_silence(cargobay::rt::Duration{duration_ns});
  return CARGOBAY_OK;
}

}  // extern "C"
