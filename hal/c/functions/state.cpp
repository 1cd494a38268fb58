// The states of the loop: reading them, and waiting for them.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <span>

#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/sized.hpp"
#include "hal/c/text.hpp"
#include "hal/c/waiting.hpp"

namespace cargobay::c {
namespace {

using hal::Robot;

// How often a waiting thread checks that there still is a loop.
constexpr rt::Duration kLookEvery = std::chrono::milliseconds{50};
constexpr std::int64_t kForEver = std::int64_t{1} << 60U;  // ns

int too_late(Session& session) {
  const auto farewell = session.farewell();
  const EndWords words = words_of(session, *farewell);
  return words.code == CARGOBAY_OK ? CARGOBAY_ENDED : fail(words.code, words.message);
}

int timed_out() {
  return fail(CARGOBAY_E_TIMEOUT,
              "no frame came in time; one comes every 15 ms if all is well: wait longer");
}

// Two looks in a row: if the whole machine had stopped, the loop goes on before the second.
bool stands_still(Robot& robot, std::uint32_t rings) {
  constexpr rt::Duration kAgain = std::chrono::milliseconds{20};
  if (!robot.stalled()) return false;
  if (robot.doorbell().wait(rings, rt::Clock::now() + kAgain)) return false;
  return robot.stalled();
}

int stalled() {
  return fail(
      CARGOBAY_E_STALLED,
      "the loop has been stalled for longer than `guard_deadline_ns`: its control function does "
      "not return, or other programs took the CPU; cargobay_end() stops the robot all the same");
}

std::optional<SeenState> newer(const RobotObject& object, std::int64_t after_tick) {
  const auto newest = object.history.newest();
  if (!newest || newest->value.state.tick <= after_tick) return std::nullopt;
  return newest->value;
}

// What one look at the loop shows.
struct Look {
  bool over = false;  // `code` is the result
  int code = CARGOBAY_OK;
};

// Waits for a frame, the end or `slice`, whichever comes first.
Look look(RobotObject& object, std::int64_t after_tick, rt::TimePoint slice, SeenState& seen) {
  const SessionUse session{object};
  if (!session) {  // being brought up again: another thread sees to it
    std::this_thread::sleep_until(std::min(slice, rt::Clock::now() + kLookEvery / 5));
    return {};
  }
  Robot& robot = *session->robot;
  const std::uint32_t rings = robot.doorbell().rings();
  if (const auto found = newer(object, after_tick)) {
    seen = *found;
    return {.over = true};
  }
  if (const int early = session->must_be_started(); early != CARGOBAY_OK)
    return {.over = true, .code = early};
  if (robot.ended()) return {.over = true, .code = too_late(*session)};
  if (robot.doorbell().wait(rings, slice)) return {};
  if (stands_still(robot, rings)) return {.over = true, .code = stalled()};
  return {};
}

int wait_in_real_time(RobotObject& object, std::int64_t after_tick, std::int64_t timeout_ns,
                      SeenState& seen) {
  const rt::TimePoint until = deadline(rt::Clock::now(), timeout_ns);
  for (;;) {
    const rt::TimePoint now = rt::Clock::now();
    const Look seen_now = look(object, after_tick, std::min(until, now + kLookEvery), seen);
    if (seen_now.over) return seen_now.code;
    if (now >= until) return timed_out();
  }
}

int wait_stepped(RobotObject& object, std::int64_t after_tick, std::int64_t timeout_ns,
                 SeenState& seen) {
  const std::unique_lock lock{object.owner(), std::try_to_lock};
  if (!lock) return moved_elsewhere();
  const SessionUse session{object};
  if (!session) return no_session();
  const rt::TimePoint until = deadline(session->robot->now(), timeout_ns);
  for (;;) {
    if (const auto found = newer(object, after_tick)) {
      seen = *found;
      return CARGOBAY_OK;
    }
    if (const int early = session->must_be_started(); early != CARGOBAY_OK) return early;
    if (session->robot->ended()) return too_late(*session);
    if (session->robot->now() >= until) return timed_out();
    session->step(until);  // what came of it is seen above
  }
}

}  // namespace

rt::TimePoint deadline(rt::TimePoint now, std::int64_t timeout_ns) {
  const bool for_ever = timeout_ns < 0 || timeout_ns > kForEver - rt::nanoseconds(now);
  return for_ever ? rt::TimePoint{rt::Duration{kForEver}} : now + rt::Duration{timeout_ns};
}

int wait_for_frame(RobotObject& object, std::int64_t after_tick, std::int64_t timeout_ns,
                   SeenState& seen) {
  return object.in_virtual_time() ? wait_stepped(object, after_tick, timeout_ns, seen)
                                  : wait_in_real_time(object, after_tick, timeout_ns, seen);
}

int no_frame_yet() noexcept {
  return fail(CARGOBAY_E_NO_FRAME,
              "no frame has come yet; cargobay_wait() for the first one after cargobay_start()");
}

}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below

extern "C" {

int cargobay_get_state(struct cargobay_robot* robot, struct cargobay_state* state) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  const auto newest = use->history.newest();
  if (!newest) return sized(state) ? no_frame_yet() : bad_argument(kBadOut);
  return give(c_state(*use, newest->value), state) ? static_cast<int>(CARGOBAY_OK)
                                                   : bad_argument(kBadOut);
}

int cargobay_wait(struct cargobay_robot* robot, int64_t after_tick, int64_t timeout_ns,
                  struct cargobay_state* state) {
  if (in_control()) return not_from_control("cargobay_wait");
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (state != nullptr && !sized(state)) return bad_argument(kBadOut);
    SeenState seen;
    const int result = wait_for_frame(*use, after_tick, timeout_ns, seen);
    if (result == CARGOBAY_OK && state != nullptr) (void)give(c_state(*use, seen), state);
    return result;
  });
}

int cargobay_get_history(struct cargobay_robot* robot, int64_t after_tick,
                         struct cargobay_state* states, size_t count) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  if (count < 1 || count > kHistory) return bad_argument("`count` must be 1 to 256");
  if (!sized(states)) return bad_argument(kBadOut);
  const std::size_t stride = states->size;
  auto* const bytes = reinterpret_cast<unsigned char*>(states);
  std::size_t written = 0;
  std::int64_t number = 0;
  while (written < count) {
    const auto next = use->history.next(number);
    if (!next) break;
    number = next->number;
    if (next->value.state.tick <= after_tick) continue;
    auto* const state = reinterpret_cast<cargobay_state*>(bytes + written * stride);
    state->size = static_cast<std::uint32_t>(stride);
    (void)give(c_state(*use, next->value), state);  // sized, as the first is
    ++written;
  }
  return static_cast<int>(written);
}

int cargobay_get_fd(struct cargobay_robot* robot) {
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (use->in_virtual_time()) {
      return fail(CARGOBAY_E_UNSUPPORTED,
                  "in virtual time nothing happens by itself: call cargobay_wait() instead");
    }
    const int number = use->descriptor.number();
    if (number >= 0) return number;
    return fail(CARGOBAY_E_LIMIT, "no descriptor is left (" +
                                      std::generic_category().message(-number) +
                                      "); close some, or raise the limit: ulimit -n");
  });
}

int cargobay_reset_odometry(struct cargobay_robot* robot, double x_mm, double y_mm,
                            double heading_rad) {
  const cargobay::rt::OdometryPose pose{.x_mm = x_mm, .y_mm = y_mm, .heading_rad = heading_rad};
  if (!cargobay::hal::is_possible(pose)) {
    return bad_argument(std::string{"the pose is not a number, or out of range: "} +
                        cargobay::hal::kPossiblePoses);
  }
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    const SessionUse session{*use};
    if (!session) return no_session();
    if (const int failed = session->must_run(); failed != CARGOBAY_OK) return failed;
    cargobay::hal::Request request;
    request.kind = cargobay::hal::Request::Kind::pose;
    request.pose = pose;
    return session->request(request);
  });
}

}  // extern "C"
