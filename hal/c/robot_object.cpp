#include "hal/c/robot_object.hpp"

#include <cxxabi.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <exception>
#include <iterator>
#include <vector>

#include "hal/c/errors.hpp"
#include "oi/limits.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::c {
namespace {

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): each thread's own
thread_local bool control_runs = false;

// From the wheels as the OI has them to those of the C API.
cargobay_wheels c_wheels(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  return {.left_mm_s = speeds.left_mm_s, .right_mm_s = speeds.right_mm_s};
}

std::int32_t c_remainder(rt::RemainderBelief belief) CARGOBAY_NONBLOCKING {
  switch (belief) {
    case rt::RemainderBelief::unknown: return CARGOBAY_REMAINDER_UNKNOWN;
    case rt::RemainderBelief::carried: return CARGOBAY_REMAINDER_CARRIED;
    case rt::RemainderBelief::lost: return CARGOBAY_REMAINDER_LOST;
  }
  return CARGOBAY_REMAINDER_UNKNOWN;
}

int code_of(hal::CycleEnd end) noexcept {
  switch (end) {
    case hal::CycleEnd::asked: return CARGOBAY_OK;
    case hal::CycleEnd::link_lost: return CARGOBAY_E_ROBOT;
    case hal::CycleEnd::mode_lost: return CARGOBAY_E_MODE;
    case hal::CycleEnd::hung_up: return CARGOBAY_E_PORT;
    case hal::CycleEnd::guarded: return CARGOBAY_E_STALLED;
    case hal::CycleEnd::control_overrun: return CARGOBAY_E_CONTROL;
    case hal::CycleEnd::guard_lost: return CARGOBAY_E_GUARD;
  }
  return CARGOBAY_E_SYSTEM;
}

// The control function has ended its thread: by pthread_exit(), by a cancellation, or because its
// interpreter ends. The loop cannot go on without a thread, nor end on one that is unwinding: the
// robot is stopped just as when the function does not return.
[[noreturn]] void never_come_back() noexcept {
  for (;;) pause();
}

}  // namespace

RobotObject::~RobotObject() {
  if (robot) (void)robot->stop();
  recording.reset();  // it reads what the robot's recorder holds
  robot.reset();      // before what it drives
  if (sim) sim->taken.store(false);
}

int RobotObject::must_be_started() const noexcept {
  if (life.load(std::memory_order_acquire) == Life::open)
    return fail(CARGOBAY_E_STATE, "the loop was not started; call cargobay_start() first");
  return CARGOBAY_OK;
}

int RobotObject::must_run() const noexcept {
  if (const int early = must_be_started(); early != CARGOBAY_OK) return early;
  if (life.load(std::memory_order_acquire) == Life::stopped || robot->ended()) {
    return fail(CARGOBAY_E_STATE, "the loop has ended; cargobay_stop() says why; open a new robot");
  }
  return CARGOBAY_OK;
}

int RobotObject::end_of_loop(const hal::Robot::Farewell& ended) const {
  if (control_threw.load()) {
    return fail(CARGOBAY_E_CONTROL,
                "an exception left the control function, and the robot was stopped; catch it "
                "there");
  }
  const int code = code_of(ended.end);
  return code == CARGOBAY_OK ? code : fail(code, hal::explain(ended));
}

int RobotObject::request(const hal::Request& wanted) {
  const std::lock_guard lock{requests};
  if (robot->cycle().request(wanted)) return CARGOBAY_OK;
  return fail(CARGOBAY_E_FULL,
              "32 requests are already waiting, and one goes out per frame; try again later");
}

RobotTable& robots() {
  static RobotTable& table = *new RobotTable;  // lives until the very end
  return table;
}

void keep(std::unique_ptr<RobotObject> object) {
  // In virtual time the thread may be inside the virtual Create.
  if (object->sim && !object->virtual_time) {
    object->sim->taken.store(false);
    object->sim = {};
  }
  // Stays reachable, so that a leak checker does not report it.
  static std::mutex keeping;
  static std::vector<RobotObject*>& kept = *new std::vector<RobotObject*>;
  const std::lock_guard lock{keeping};
  kept.push_back(object.release());
}

bool in_control() noexcept { return control_runs; }

int not_from_control(const char* function) noexcept {
  return guarded([&] {
    return fail(CARGOBAY_E_STATE,
                std::string{function} +
                    "() waits for the loop, and the loop for this control function; call "
                    "cargobay_request_stop() here, and this from another thread");
  });
}

rt::WheelSpeeds call_control(void* object, const hal::CycleState& state, double /*seconds*/)
    CARGOBAY_NONBLOCKING {
  auto& robot = *static_cast<RobotObject*>(object);
  // The program's own function; the cycle and the guard watch how long it takes.
  return rt::unchecked([&]() noexcept -> rt::WheelSpeeds {
    const cargobay_state seen = c_state(robot, state);
    cargobay_wheels wheels{};
    control_runs = true;
    try {
      robot.control(robot.context, &seen, &wheels);
    } catch (const abi::__forced_unwind&) {
      if (robot.virtual_time) std::terminate();  // the program's own thread cannot be kept
      never_come_back();
    } catch (...) {
      robot.control_threw.store(true);
      robot.robot->cycle().request_stop();
      wheels = {};
    }
    control_runs = false;
    return {wheels.left_mm_s, wheels.right_mm_s};
  });
}

cargobay_state c_state(const RobotObject& robot, const hal::CycleState& state)
    CARGOBAY_NONBLOCKING {
  cargobay_state seen{};
  seen.size = sizeof seen;
  seen.mode = static_cast<std::int32_t>(state.mode);
  seen.tick = state.tick;
  seen.time_ns = state.tick * rt::Duration{oi::kTick}.count();
  seen.arrival_ns = rt::nanoseconds(state.arrival);
  seen.target = c_wheels(state.target);
  seen.set = c_wheels(state.set);
  seen.estimate = c_wheels(state.estimate);
  seen.command = c_wheels(state.command);
  const rt::WheelSpeeds& speeds = state.estimate;
  seen.velocity_mm_s = (speeds.left_mm_s + speeds.right_mm_s) / 2.0;
  seen.turn_rate_rad_s = (speeds.right_mm_s - speeds.left_mm_s) / robot.wheel_base_mm;
  seen.x_mm = state.pose.x_mm;
  seen.y_mm = state.pose.y_mm;
  seen.heading_rad = state.pose.heading_rad;
  seen.distance_mm = state.distance_mm;
  const rt::PoseCovariance& p = state.pose_covariance;
  const std::array covariance{p.xx, p.xy, p.xh, p.xy, p.yy, p.yh, p.xh, p.yh, p.hh};
  std::copy(covariance.begin(), covariance.end(), std::begin(seen.covariance));
  seen.remainder = c_remainder(state.remainder);
  seen.setpoint_lapsed = state.setpoint_lapsed ? 1 : 0;
  seen.hazards = state.hazards.raw();
  seen.bumps = state.bumps.raw();
  seen.battery_mv = state.battery_mv;
  return seen;
}

}  // namespace cargobay::c
