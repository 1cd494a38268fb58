// Setpoints, and everything else that changes how the loop drives.
#include <cmath>

#include "hal/c/cargobay.h"
#include "hal/c/durations.hpp"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "oi/limits.hpp"

namespace cargobay::c {
namespace {

// Calls `function` with the session of a robot whose loop runs.
template <typename Function>
int running(cargobay_robot* robot, const Function& function) noexcept {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  const SessionUse session{*use};
  if (!session) return no_session();
  if (const int failed = session->must_run(); failed != CARGOBAY_OK) return failed;
  return function(*use, session);
}

int drive(const SessionUse& session, const cargobay_wheels& wheels) noexcept {
  constexpr double kMost = oi::kMaxWheelSpeed;
  const bool possible = std::abs(wheels.left_mm_s) <= kMost && std::abs(wheels.right_mm_s) <= kMost;
  if (!possible)  // also if one is not a number
    return bad_argument("a wheel's speed is not a number, or beyond -500 to 500 mm/s");
  const auto state = session.cycle().state();
  const oi::Mode mode = state ? state->mode : oi::Mode::safe;
  if (mode != oi::Mode::safe && mode != oi::Mode::full) {
    return fail(CARGOBAY_E_MODE,
                "the robot has left its mode and obeys no drive commands; see the event, put it "
                "right, then cargobay_rearm()");
  }
  // In range, so it is accepted.
  (void)session.cycle().set_speeds({wheels.left_mm_s, wheels.right_mm_s});
  return CARGOBAY_OK;
}

int drive(cargobay_robot* robot, const cargobay_twist& twist) noexcept {
  return running(robot, [&](const RobotObject& object, const SessionUse& session) {
    return drive(session, wheels_for(object, twist));
  });
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below

extern "C" {

int cargobay_wheels_of(struct cargobay_robot* robot, struct cargobay_twist twist,
                       struct cargobay_wheels* wheels) {
  if (wheels == nullptr) return bad_argument("`wheels` is NULL: give the address of one");
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  if (!std::isfinite(twist.velocity_mm_s) || !std::isfinite(twist.turn_rate_rad_s))
    return bad_argument("the velocity or the turn rate is not a number");
  *wheels = wheels_for(*use, twist);
  return CARGOBAY_OK;
}

int cargobay_drive_wheels(struct cargobay_robot* robot, double left_mm_s, double right_mm_s) {
  return running(robot, [&](const RobotObject& /*object*/, const SessionUse& session) {
    return drive(session, cargobay_wheels{left_mm_s, right_mm_s});
  });
}

int cargobay_drive(struct cargobay_robot* robot, double velocity_mm_s, double turn_rate_rad_s) {
  return drive(robot, cargobay_twist{velocity_mm_s, turn_rate_rad_s});
}

int cargobay_drive_radius(struct cargobay_robot* robot, double velocity_mm_s, double radius_mm) {
  if (std::isnan(radius_mm))
    return bad_argument("`radius_mm` is not a number; INFINITY is straight on, 0 turns in place");
  if (radius_mm == 0.0) return cargobay_drive_wheels(robot, -velocity_mm_s, velocity_mm_s);
  return cargobay_drive(robot, velocity_mm_s, velocity_mm_s / radius_mm);
}

int cargobay_stop(struct cargobay_robot* robot) {
  return running(robot, [](RobotObject& object, const SessionUse& session) {
    object.control.store(nullptr, std::memory_order_seq_cst);
    session.cycle().stand_still();
    return CARGOBAY_OK;
  });
}

int cargobay_rearm(struct cargobay_robot* robot) {
  return running(robot, [](const RobotObject& /*object*/, const SessionUse& session) {
    session.cycle().request_rearm();
    return CARGOBAY_OK;
  });
}

int cargobay_expect_silence(struct cargobay_robot* robot, int64_t duration_ns) {
  if (const int bad = check_duration("duration_ns", duration_ns); bad != CARGOBAY_OK) return bad;
  return running(robot, [&](const RobotObject& /*object*/, const SessionUse& session) {
    session.cycle().expect_silence(cargobay::rt::Duration{duration_ns});
    return CARGOBAY_OK;
  });
}

}  // extern "C"
