// What a program can read: states, events, sensors; and waiting for them.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>

#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/sized.hpp"
#include "hal/c/text.hpp"
#include "hal/sensing/events.hpp"
#include "hal/sensing/frame_lists.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::c {
namespace {

using hal::Robot;

// What this thread has already seen of each robot: how often its doorbell had rung.
struct Seen {
  const void* robot = nullptr;  // the handle, which is never used twice
  std::uint32_t rings = 0;
};
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): each thread's own
thread_local std::array<Seen, RobotTable::kMost> seen_rings{};

// How often a waiting thread checks that there still is a loop.
constexpr rt::Duration kLookEvery = std::chrono::milliseconds{50};
constexpr std::int64_t kForEver = std::int64_t{1} << 60U;  // ns

// The end of the wait on a clock that says `now`.
rt::TimePoint deadline(rt::TimePoint now, std::int64_t timeout_ns) {
  const bool for_ever = timeout_ns < 0 || timeout_ns > kForEver - rt::nanoseconds(now);
  return for_ever ? rt::TimePoint{rt::Duration{kForEver}} : now + rt::Duration{timeout_ns};
}

int too_late(const RobotObject& object) {
  if (const int code = object.end_of_loop(object.robot->end_so_far()); code != CARGOBAY_OK)
    return code;
  return fail(CARGOBAY_E_STATE,
              "the loop was asked to end, and has; no more frames will come: cargobay_stop()");
}

int timed_out() {
  return fail(CARGOBAY_E_TIMEOUT,
              "no frame came in time; one comes every 15 ms if all is well: wait longer");
}

// Two looks in a row: if the whole machine had stopped, the loop goes on before the second.
bool stands_still(RobotObject& object, std::uint32_t rings) {
  constexpr rt::Duration kAgain = std::chrono::milliseconds{20};
  if (!object.robot->stalled()) return false;
  if (object.robot->doorbell().wait(rings, rt::Clock::now() + kAgain)) return false;
  return object.robot->stalled();
}

int stalled() {
  return fail(
      CARGOBAY_E_STALLED,
      "the loop has been stalled for longer than `guard_deadline_ms`: its control function does "
      "not return, or other programs took the CPU; cargobay_stop() stops the robot all the same");
}

int wait_stepped(RobotObject& object, std::int64_t timeout_ns) {
  const std::unique_lock lock{object.owner, std::try_to_lock};
  if (!lock)
    return fail(CARGOBAY_E_STATE, "another thread already moves the virtual time of this robot");
  const Robot::Stepped stepped = object.robot->step(deadline(object.robot->now(), timeout_ns));
  if (object.recording) object.recording->append();
  switch (stepped) {
    case Robot::Stepped::frame: return CARGOBAY_OK;
    case Robot::Stepped::timed_out: return timed_out();
    case Robot::Stepped::ended: return too_late(object);
  }
  return CARGOBAY_OK;
}

int wait_in_real_time(cargobay_robot* robot, const RobotUse& use, std::int64_t timeout_ns) {
  Seen& seen = seen_rings[use.index()];
  rt::Doorbell& bell = use->robot->doorbell();
  if (seen.robot != robot) seen = {.robot = robot, .rings = bell.rings()};
  const rt::TimePoint until = deadline(rt::Clock::now(), timeout_ns);
  if (use->robot->ended()) return too_late(*use);
  for (;;) {
    const rt::TimePoint now = rt::Clock::now();
    if (bell.wait(seen.rings, std::min(until, now + kLookEvery))) break;
    if (stands_still(*use, seen.rings)) return stalled();
    if (now >= until) return timed_out();
  }
  seen.rings = bell.rings();
  if (use->robot->ended()) return too_late(*use);
  return CARGOBAY_OK;
}

int wait_for_frame(cargobay_robot* robot, const RobotUse& use, std::int64_t timeout_ns) {
  if (const int early = use->must_be_started(); early != CARGOBAY_OK) return early;
  if (use->life.load() == RobotObject::Life::stopped) return use->must_run();
  return use->virtual_time ? wait_stepped(*use, timeout_ns)
                           : wait_in_real_time(robot, use, timeout_ns);
}

int no_frame_yet() {
  return fail(CARGOBAY_E_TIMEOUT,
              "no frame has come yet; cargobay_wait() for the first one after cargobay_start()");
}

cargobay_event c_event(const hal::Event& event) {
  cargobay_event known{};
  known.size = sizeof known;
  known.kind = static_cast<std::int32_t>(event.what);
  known.tick = event.tick;
  known.time_ns = rt::nanoseconds(event.time);
  known.mode = static_cast<std::int32_t>(event.mode);
  known.hazards = event.hazards.raw();
  known.overcurrents = event.overcurrents.raw();
  known.frames = event.frames;
  known.bumps = event.bumps.raw();
  known.voltage_mv = event.battery.voltage_mv;
  known.charge_mah = event.battery.charge_mah;
  known.capacity_mah = event.battery.capacity_mah;
  known.process = event.process;
  std::copy(event.process_name.begin(), event.process_name.end(), std::begin(known.process_name));
  return known;
}

hal::Event event_of(const cargobay_event& known) {
  const auto bits = [](std::uint32_t raw) { return static_cast<std::uint8_t>(raw); };
  hal::Event event;
  event.what = static_cast<hal::EventKind>(known.kind);
  event.mode = static_cast<oi::Mode>(bits(static_cast<std::uint32_t>(known.mode)));
  event.hazards = hal::Hazards{bits(known.hazards)};
  event.overcurrents = oi::BitSet<oi::Overcurrent>{bits(known.overcurrents)};
  event.frames = known.frames;
  event.bumps = hal::Bumps{bits(known.bumps)};
  event.battery = {.voltage_mv = known.voltage_mv,
                   .charge_mah = known.charge_mah,
                   .capacity_mah = known.capacity_mah};
  event.process = known.process;
  std::copy_n(std::begin(known.process_name), event.process_name.size() - 1,
              event.process_name.begin());
  return event;
}

static_assert(static_cast<int>(hal::EventKind::port_shared) == CARGOBAY_EVENT_PORT_SHARED);
static_assert(static_cast<int>(hal::EventKind::frames_lost) == CARGOBAY_EVENT_FRAMES_LOST);
static_assert(hal::Hazards{}.with(hal::Hazard::charger).raw() == CARGOBAY_CHARGER);

// The extra list that has the packet; none if it is always included.
hal::ExtraLists list_with(int packet) {
  using hal::ExtraList;
  if (packet >= CARGOBAY_PACKET_WALL_SIGNAL && packet <= CARGOBAY_PACKET_CLIFF_FRONT_LEFT_SIGNAL)
    return hal::ExtraLists{}.with(ExtraList::signals_left);
  if (packet >= CARGOBAY_PACKET_CLIFF_FRONT_RIGHT_SIGNAL && packet <= CARGOBAY_PACKET_ANALOG_SIGNAL)
    return hal::ExtraLists{}.with(ExtraList::signals_right);
  if (packet >= CARGOBAY_PACKET_SONG_NUMBER) return hal::ExtraLists{}.with(ExtraList::outputs);
  return {};
}

int query(cargobay_robot* robot, const RobotUse& use, int packet, std::int64_t timeout_ns,
          std::int32_t& value) {
  if (const int failed = use->must_run(); failed != CARGOBAY_OK) return failed;
  hal::ControlCycle& cycle = use->robot->cycle();
  const auto now = cycle.state();
  // What is sampled after this tick is sampled after the call.
  const std::int64_t since = now ? now->tick + 1 : 0;
  if (const hal::ExtraLists list = list_with(packet); list.any()) {
    hal::Request look;
    look.kind = hal::Request::Kind::look;
    look.extras = list;
    if (const int failed = use->request(look); failed != CARGOBAY_OK) return failed;
  }
  const auto clock = [&] { return use->virtual_time ? use->robot->now() : rt::Clock::now(); };
  const rt::TimePoint until = deadline(clock(), timeout_ns);
  for (;;) {
    const std::int64_t left = std::max<std::int64_t>((until - clock()).count(), 0);
    if (const int failed = wait_for_frame(robot, use, left); failed != CARGOBAY_OK) return failed;
    const hal::SensorReadings readings = cycle.sensors();
    const auto slot = static_cast<std::size_t>(packet);
    if (readings.tick[slot] <= since) continue;
    value = readings.value[slot];
    return CARGOBAY_OK;
  }
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below
using cargobay::hal::Request;

extern "C" {

int cargobay_get_state(struct cargobay_robot* robot, struct cargobay_state* state) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  const auto known = use->robot->cycle().state();
  if (!known) return no_frame_yet();
  return give(c_state(*use, *known), state) ? static_cast<int>(CARGOBAY_OK) : bad_argument(kBadOut);
}

int cargobay_wait(struct cargobay_robot* robot, int64_t timeout_ns, struct cargobay_state* state) {
  if (in_control()) return not_from_control("cargobay_wait");
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (state != nullptr && !sized(state)) return bad_argument(kBadOut);
    if (const int failed = wait_for_frame(robot, use, timeout_ns); failed != CARGOBAY_OK)
      return failed;
    return state == nullptr ? static_cast<int>(CARGOBAY_OK) : cargobay_get_state(robot, state);
  });
}

int cargobay_reset_odometry(struct cargobay_robot* robot, double x_mm, double y_mm,
                            double heading_rad) {
  // At this distance a millimetre and a millirad still count; false for NaN.
  constexpr double kFarthestMm = 1e9;
  constexpr double kMostRad = 1e6;
  const bool sensible = std::abs(x_mm) <= kFarthestMm && std::abs(y_mm) <= kFarthestMm &&
                        std::abs(heading_rad) <= kMostRad;
  if (!sensible) {
    return bad_argument(
        "the pose is not a number, or out of range: `x_mm` and `y_mm` must be -1e9 to 1e9, "
        "`heading_rad` -1e6 to 1e6");
  }
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (const int failed = use->must_run(); failed != CARGOBAY_OK) return failed;
    Request request;
    request.kind = Request::Kind::pose;
    request.pose = {.x_mm = x_mm, .y_mm = y_mm, .heading_rad = heading_rad};
    return use->request(request);
  });
}

int cargobay_next_event(struct cargobay_robot* robot, struct cargobay_event* event) {
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (!sized(event)) return bad_argument(kBadOut);
    cargobay::hal::Event next;
    const std::lock_guard lock{use->events};
    if (!use->robot->next_event(next)) return 0;
    (void)give(c_event(next), event);  // checked above
    return 1;
  });
}

int cargobay_describe_event(const struct cargobay_event* event, char* text, size_t text_size) {
  if (text == nullptr)
    return bad_argument("`text` is NULL: give it room; 300 characters are enough");
  return guarded([&] {
    cargobay_event known{};
    if (!take(event, known))
      return bad_argument("`event` is NULL or not from cargobay_next_event()");
    if (known.kind < 0 || static_cast<std::size_t>(known.kind) >= cargobay::hal::kEventKinds)
      return bad_argument("this library knows no event of that kind");
    return copy_text(cargobay::hal::describe(event_of(known)), text, text_size);
  });
}

const char* cargobay_packet_name(int packet) {
  const bool single = packet >= CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS && packet < CARGOBAY_PACKETS;
  // From the table of packets, whose keys are literals.
  return single ? cargobay::oi::kCreate.find_packet(static_cast<std::uint8_t>(packet))->key.data()
                : "";
}

int cargobay_get_sensors(struct cargobay_robot* robot, struct cargobay_sensors* sensors) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  if (!use->robot->cycle().state()) return no_frame_yet();
  const cargobay::hal::SensorReadings readings = use->robot->cycle().sensors();
  cargobay_sensors known{};
  static_assert(cargobay::hal::SensorReadings::kSlots == CARGOBAY_PACKETS);
  for (std::size_t i = 0; i < CARGOBAY_PACKETS; ++i) {
    known.value[i] = readings.value[i];
    known.tick[i] = readings.tick[i];
  }
  return give(known, sensors) ? static_cast<int>(CARGOBAY_OK) : bad_argument(kBadOut);
}

int cargobay_subscribe(struct cargobay_robot* robot, uint32_t extras) {
  if ((extras & ~std::uint32_t{cargobay::hal::kAllExtraLists.raw()}) != 0)
    return bad_argument("`extras` has bits that this library does not know");
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (const int failed = use->must_run(); failed != CARGOBAY_OK) return failed;
    Request request;
    request.kind = Request::Kind::stream;
    request.extras = cargobay::hal::ExtraLists{static_cast<std::uint8_t>(extras)};
    return use->request(request);
  });
}

int cargobay_query(struct cargobay_robot* robot, int packet, int64_t timeout_ns, int32_t* value) {
  if (in_control()) return not_from_control("cargobay_query");
  if (value == nullptr) return bad_argument("`value` is NULL: give the address of an int32_t");
  if (packet < CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS || packet >= CARGOBAY_PACKETS)
    return bad_argument("`packet` must be 7 to 42: ask for groups packet by packet");
  if (packet == CARGOBAY_PACKET_DISTANCE || packet == CARGOBAY_PACKET_ANGLE) {
    return bad_argument(
        "distance and angle belong to the loop, and each read would take them from it; use the "
        "odometry in cargobay_state");
  }
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    return query(robot, use, packet, timeout_ns, *value);
  });
}

}  // extern "C"
