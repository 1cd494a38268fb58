// Sensor packets by their numbers.
#include <algorithm>
#include <array>
#include <span>

#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/waiting.hpp"
#include "hal/sensing/frame_lists.hpp"
#include "oi/dialect.hpp"

namespace cargobay::c {
namespace {

constexpr std::size_t kMostPackets = 64;  // at once

// The extra list that has the packet; none if it is always included.
hal::ExtraLists list_with(std::size_t packet) {
  using hal::ExtraList;
  if (packet >= CARGOBAY_PACKET_WALL_SIGNAL && packet <= CARGOBAY_PACKET_CLIFF_FRONT_LEFT_SIGNAL)
    return hal::ExtraLists{}.with(ExtraList::signals_left);
  if (packet >= CARGOBAY_PACKET_CLIFF_FRONT_RIGHT_SIGNAL && packet <= CARGOBAY_PACKET_ANALOG_SIGNAL)
    return hal::ExtraLists{}.with(ExtraList::signals_right);
  if (packet >= CARGOBAY_PACKET_SONG_NUMBER && packet < RobotObject::kPackets)
    return hal::ExtraLists{}.with(ExtraList::outputs);
  return {};
}

bool exists(std::uint32_t packet) CARGOBAY_NONBLOCKING {
  if (packet >= RobotObject::kPackets) return false;
  const oi::PacketInfo* const info = oi::kCreate.find_packet(static_cast<std::uint8_t>(packet));
  return info != nullptr && !info->is_group();
}

int unsupported() noexcept {
  return fail(CARGOBAY_E_UNSUPPORTED,
              "this robot has no such packet, or it is a group: name single packets, 7 to 42");
}

// CARGOBAY_OK if there are some, and the robot has them all.
int check(const std::uint32_t* packets, std::size_t count) noexcept {
  if (packets == nullptr) return bad_argument("`packets` is NULL: give the packets' numbers");
  if (count < 1 || count > kMostPackets) return bad_argument("`count` must be 1 to 64");
  const bool known = std::all_of(packets, packets + count, exists);
  return known ? static_cast<int>(CARGOBAY_OK) : unsupported();
}

// When the frame of that tick arrived: as told if it is in the history, else by the robot's clock.
std::int64_t arrival_ns(const RobotObject& object, std::int64_t tick) CARGOBAY_NONBLOCKING {
  const auto newest = object.history.newest();
  if (!newest) return 0;
  // One number for each tick, unless frames were lost.
  std::int64_t number = newest->number - (newest->value.state.tick - tick) - 1;
  std::optional<rt::NewestRing<SeenState, kHistory>::Entry> at = newest;
  for (std::int64_t i = 0; i < 4 && number >= 0; ++i, ++number) {
    const auto next = object.history.next(number);
    if (!next || next->value.state.tick > tick) break;
    at = next;
    if (at->value.state.tick == tick) break;
  }
  const std::int64_t apart = at->value.state.tick - tick;
  return rt::nanoseconds(at->value.state.arrival) - apart * rt::Duration{oi::kTick}.count();
}

cargobay_reading reading_of(const RobotObject& object, const Session& session,
                            const hal::SensorReadings& readings, std::uint32_t packet)
    CARGOBAY_NONBLOCKING {
  cargobay_reading reading{};
  reading.packet = packet;
  reading.value = readings.value[packet];
  const std::int64_t tick = readings.tick[packet];
  if (tick == hal::SensorReadings::kNever) {
    reading.tick = -1;
    return reading;
  }
  reading.tick = tick + session.first_tick;
  reading.arrival_ns = arrival_ns(object, reading.tick);
  return reading;
}

// Counts each packet up or down, and has the robot stream what is then wanted. After an error no
// count has changed.
int subscribe(RobotObject& object, std::span<const std::uint32_t> packets, bool more) {
  const SessionUse session{object};
  if (!session) return no_session();
  if (const int failed = session->must_run(); failed != CARGOBAY_OK) return failed;
  const std::lock_guard lock{object.subscribing};
  auto counts = object.subscriptions;
  for (const std::uint32_t packet : packets) {
    if (!more && counts[packet] == 0) {
      return bad_argument("a packet in `packets` is not subscribed as often as you take it back");
    }
    counts[packet] = more ? counts[packet] + 1 : counts[packet] - 1;
  }
  const hal::ExtraLists wanted = lists_with(counts);
  if (wanted != lists_with(object.subscriptions)) {
    hal::Request request;
    request.kind = hal::Request::Kind::stream;
    request.extras = wanted;
    if (const int failed = session->request(request); failed != CARGOBAY_OK) return failed;
  }
  object.subscriptions = counts;
  return CARGOBAY_OK;
}

// Asks for one frame with the packet, if it does not come anyway.
int ask_for(Session& session, std::uint32_t packet) {
  hal::Request look;
  look.kind = hal::Request::Kind::look;
  look.extras = list_with(packet);
  return look.extras.any() ? session.request(look) : static_cast<int>(CARGOBAY_OK);
}

// The tick after which everything that is sampled is sampled after now.
int since_now(RobotObject& object, std::uint32_t packet, std::int64_t& since) {
  const SessionUse session{object};
  if (!session) return no_session();
  if (const int failed = session->must_run(); failed != CARGOBAY_OK) return failed;
  const auto newest = object.history.newest();
  since = newest ? newest->value.state.tick + 1 : 0;
  return ask_for(*session, packet);
}

rt::TimePoint now_of(RobotObject& object) {
  if (!object.in_virtual_time()) return rt::Clock::now();
  const SessionUse session{object};
  return session ? session->robot->now() : rt::TimePoint{};
}

int query(RobotObject& object, std::uint32_t packet, std::int64_t timeout_ns,
          cargobay_reading& reading) {
  std::int64_t since = 0;
  if (const int failed = since_now(object, packet, since); failed != CARGOBAY_OK) return failed;
  const rt::TimePoint until = deadline(now_of(object), timeout_ns);
  SeenState seen;
  seen.state.tick = since - 1;
  for (;;) {
    const std::int64_t left = std::max<std::int64_t>((until - now_of(object)).count(), 0);
    if (const int ended = wait_for_frame(object, seen.state.tick, left, seen); ended != CARGOBAY_OK)
      return ended;
    const SessionUse session{object};
    if (!session) return no_session();
    const cargobay_reading found = reading_of(object, *session, session.cycle().sensors(), packet);
    if (found.tick <= since) continue;
    reading = found;
    return CARGOBAY_OK;
  }
}

}  // namespace

hal::ExtraLists lists_with(const RobotObject::Subscriptions& subscriptions) {
  std::uint8_t lists = 0;
  for (std::size_t packet = 0; packet < subscriptions.size(); ++packet) {
    if (subscriptions[packet] > 0) lists |= list_with(packet).raw();
  }
  return hal::ExtraLists{lists};
}

}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below

extern "C" {

const char* cargobay_packet_name(int packet) {
  // From the table of packets, whose keys are literals.
  return packet >= 0 && exists(static_cast<std::uint32_t>(packet))
             ? cargobay::oi::kCreate.find_packet(static_cast<std::uint8_t>(packet))->key.data()
             : "";
}

int cargobay_get_readings(struct cargobay_robot* robot, const uint32_t* packets, size_t count,
                          struct cargobay_reading* readings) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  if (const int failed = check(packets, count); failed != CARGOBAY_OK) return failed;
  if (readings == nullptr) return bad_argument("`readings` is NULL: give it room for `count`");
  const SessionUse session{*use};
  if (!session || !session.cycle().state()) return no_frame_yet();
  const cargobay::hal::SensorReadings known = session.cycle().sensors();
  for (std::size_t i = 0; i < count; ++i)
    readings[i] = reading_of(*use, *session, known, packets[i]);
  return CARGOBAY_OK;
}

int cargobay_subscribe(struct cargobay_robot* robot, const uint32_t* packets, size_t count) {
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (const int failed = check(packets, count); failed != CARGOBAY_OK) return failed;
    return subscribe(*use, {packets, count}, true);
  });
}

int cargobay_unsubscribe(struct cargobay_robot* robot, const uint32_t* packets, size_t count) {
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (const int failed = check(packets, count); failed != CARGOBAY_OK) return failed;
    return subscribe(*use, {packets, count}, false);
  });
}

int cargobay_query(struct cargobay_robot* robot, uint32_t packet, int64_t timeout_ns,
                   struct cargobay_reading* reading) {
  if (in_control()) return not_from_control("cargobay_query");
  if (reading == nullptr) return bad_argument("`reading` is NULL: give the address of one");
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    if (!exists(packet)) return unsupported();
    if (packet == CARGOBAY_PACKET_DISTANCE || packet == CARGOBAY_PACKET_ANGLE) {
      return bad_argument(
          "distance and angle belong to the loop, and each read would take them from it; use the "
          "odometry in cargobay_state");
    }
    return query(*use, packet, timeout_ns, *reading);
  });
}

}  // extern "C"
