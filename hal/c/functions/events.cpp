// What happened to the robot.
#include "hal/sensing/events.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/sized.hpp"
#include "hal/c/text.hpp"
#include "oi/value_names.hpp"

namespace cargobay::c {
namespace {

// The robot's bits in the API's order, and back.
template <typename Bit>
struct BitPair {
  Bit robots;
  std::uint32_t apis;
};
constexpr BitPair<oi::Bump> kBumps[] = {{oi::Bump::bump_left, CARGOBAY_BUMP_LEFT},
                                        {oi::Bump::bump_right, CARGOBAY_BUMP_RIGHT}};
constexpr BitPair<oi::Overcurrent> kOvercurrents[] = {
    {oi::Overcurrent::left_wheel, CARGOBAY_OVERCURRENT_WHEEL_LEFT},
    {oi::Overcurrent::right_wheel, CARGOBAY_OVERCURRENT_WHEEL_RIGHT},
    {oi::Overcurrent::low_side_driver_0, CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_0},
    {oi::Overcurrent::low_side_driver_1, CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_1},
    {oi::Overcurrent::low_side_driver_2, CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_2}};

template <typename Bit>
std::uint32_t to_api(oi::BitSet<Bit> set, std::span<const BitPair<Bit>> pairs)
    CARGOBAY_NONBLOCKING {
  std::uint32_t bits = 0;
  for (const auto& [robots, apis] : pairs) bits |= set.has(robots) ? apis : 0U;
  return bits;
}
template <typename Bit>
oi::BitSet<Bit> to_robot(std::uint32_t bits, std::span<const BitPair<Bit>> pairs) {
  oi::BitSet<Bit> set;
  for (const auto& [robots, apis] : pairs) set = (bits & apis) != 0 ? set.with(robots) : set;
  return set;
}

cargobay_event c_event(const hal::EventLog::Entry& entry) CARGOBAY_NONBLOCKING {
  const hal::Event& event = entry.event;
  cargobay_event known{};
  known.size = sizeof known;
  known.kind = static_cast<std::int32_t>(event.what);
  known.sequence = entry.sequence;
  known.tick = event.tick;
  known.arrival_ns = rt::nanoseconds(event.time);
  known.mode = static_cast<std::int32_t>(event.mode);
  known.hazards = event.hazards.raw();
  known.overcurrents = to_api<oi::Overcurrent>(event.overcurrents, kOvercurrents);
  known.frames = event.frames;
  known.bumps = to_api<oi::Bump>(event.bumps, kBumps);
  known.voltage_mv = event.battery.voltage_mv;
  known.charge_mah = event.battery.charge_mah;
  known.capacity_mah = event.battery.capacity_mah;
  known.process = event.process;
  known.wheels = event.wheels.raw();
  known.finding = static_cast<std::int32_t>(event.finding);
  known.limits = event.limits.raw();
  known.wanted = {event.wanted.left_mm_s, event.wanted.right_mm_s};
  known.got = {event.got.left_mm_s, event.got.right_mm_s};
  std::copy(event.process_name.begin(), event.process_name.end(), std::begin(known.process_name));
  return known;
}

// A program may pass anything.
rt::WheelWatch::Finding finding_of(std::int32_t number) {
  using Finding = rt::WheelWatch::Finding;
  const bool known = number >= 0 && number <= static_cast<std::int32_t>(Finding::jumps);
  return known ? static_cast<Finding>(number) : Finding::nothing;
}

hal::Event event_of(const cargobay_event& known) {
  hal::Event event;
  event.what = static_cast<hal::EventKind>(known.kind);
  event.mode = static_cast<oi::Mode>(known.mode & 0xFF);
  event.hazards = hal::Hazards{static_cast<std::uint8_t>(known.hazards)};
  event.overcurrents = to_robot<oi::Overcurrent>(known.overcurrents, kOvercurrents);
  event.frames = known.frames;
  event.bumps = to_robot<oi::Bump>(known.bumps, kBumps);
  event.battery = {.voltage_mv = known.voltage_mv,
                   .charge_mah = known.charge_mah,
                   .capacity_mah = known.capacity_mah};
  event.process = known.process;
  event.wheels = oi::BitSet<hal::Wheel>{static_cast<std::uint8_t>(known.wheels)};
  event.finding = finding_of(known.finding);
  event.limits = hal::Limits{static_cast<std::uint8_t>(known.limits)};
  event.wanted = {known.wanted.left_mm_s, known.wanted.right_mm_s};
  event.got = {known.got.left_mm_s, known.got.right_mm_s};
  std::copy_n(std::begin(known.process_name), event.process_name.size() - 1,
              event.process_name.begin());
  return event;
}

static_assert(hal::kEventKinds == CARGOBAY_EVENT_LIMIT_ENDED + 1);
static_assert(static_cast<int>(rt::WheelWatch::Finding::jumps) == CARGOBAY_FINDING_JUMPS);
static_assert(hal::Limits{}.with(hal::Limit::acceleration).raw() == CARGOBAY_LIMIT_ACCELERATION);
static_assert(static_cast<int>(hal::EventKind::frames_lost) == CARGOBAY_EVENT_FRAMES_LOST);
static_assert(hal::Hazards{}.with(hal::Hazard::charger).raw() == CARGOBAY_HAZARD_CHARGER);

bool is_kind(int kind) { return kind >= 0 && static_cast<std::size_t>(kind) < hal::kEventKinds; }

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below

extern "C" {

int cargobay_next_event(struct cargobay_robot* robot, int64_t after_sequence,
                        struct cargobay_event* event) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  if (!sized(event)) return bad_argument(kBadOut);
  if (after_sequence < 0) return bad_argument("`after_sequence` is negative: 0 means none yet");
  const auto next = use->events.next(after_sequence);
  if (!next) return 0;
  (void)give(c_event(*next), event);  // checked above
  return 1;
}

int cargobay_describe_event(const struct cargobay_event* event, char* text, size_t text_size) {
  if (text == nullptr)
    return bad_argument("`text` is NULL: give it room; 300 characters are enough");
  return guarded([&] {
    cargobay_event known{};
    if (!take(event, known))
      return bad_argument("`event` is NULL or not from cargobay_next_event()");
    if (!is_kind(known.kind)) return bad_argument("this library knows no event of that kind");
    return copy_text(cargobay::hal::describe(event_of(known)), text, text_size);
  });
}

const char* cargobay_event_name(int kind) {
  // From the table of events, whose names are literals.
  return is_kind(kind) ? name(static_cast<cargobay::hal::EventKind>(kind)).data() : "";
}

const char* cargobay_mode_name(int mode) {
  if (mode < CARGOBAY_MODE_OFF || mode > CARGOBAY_MODE_FULL) return "";
  return cargobay::oi::name(static_cast<cargobay::oi::Mode>(mode)).data();
}

}  // extern "C"
