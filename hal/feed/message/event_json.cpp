#include "hal/feed/message/event_json.hpp"

#include <string>

#include "oi/limits.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {

namespace {

// The names of the flags that are set, of those that have one.
template <typename Flag>
std::string flag_names(oi::BitSet<Flag> flags, unsigned count) {
  JsonArray names;
  for (unsigned bit = 0; bit < count; ++bit) {
    const auto flag = static_cast<Flag>(bit);
    if (flags.has(flag)) names.text(name(flag));
  }
  return names.take();
}

// The names of the bits that are set in a packet's byte.
std::string bit_names(oi::PacketId packet, std::uint8_t bits) {
  JsonArray names;
  oi::visit_bits(packet, bits, [&](std::string_view name) { names.text(name); });
  return names.take();
}

constexpr unsigned kHazards = static_cast<unsigned>(Hazard::charger) + 1;
constexpr unsigned kLimits = static_cast<unsigned>(Limit::acceleration) + 1;
constexpr unsigned kWheels = static_cast<unsigned>(Wheel::right) + 1;

std::string json_of(oi::BitSet<oi::Overcurrent> overcurrents) {
  return bit_names(oi::PacketId::overcurrents, overcurrents.raw());
}

}  // namespace

// In whole milliseconds, which have few digits.
double robot_time_s(std::int64_t tick) {
  static_assert(oi::kTick % std::chrono::milliseconds{1} == std::chrono::nanoseconds{0});
  constexpr std::int64_t kTickMs = oi::kTick / std::chrono::milliseconds{1};
  return static_cast<double>(tick * kTickMs) / 1000.0;
}

JsonObject json_of(const rt::WheelSpeeds& speeds) {
  JsonObject object;
  object.number("left", speeds.left_mm_s).number("right", speeds.right_mm_s);
  return object;
}

std::string json_of(Hazards hazards) { return flag_names(hazards, kHazards); }
std::string json_of(Limits limits) { return flag_names(limits, kLimits); }
std::string json_of(Bumps bumps) {
  return bit_names(oi::PacketId::bumps_and_wheel_drops, bumps.raw());
}

void put_event(JsonObject& object, const Event& event) {
  object.text("what", name(event.what))
      .number("tick", event.tick)
      .number("time_s", robot_time_s(event.tick))
      .text("text", describe(event));
  switch (payload(event.what)) {
    case Payload::nothing: break;
    case Payload::mode:
      object.text("mode", oi::name(event.mode)).raw("hazards", json_of(event.hazards));
      break;
    case Payload::battery: {
      JsonObject battery;
      battery.number("mv", event.battery.voltage_mv)
          .number("charge_mah", event.battery.charge_mah)
          .number("capacity_mah", event.battery.capacity_mah);
      object.object("battery", std::move(battery));
      break;
    }
    case Payload::overcurrents: object.raw("overcurrents", json_of(event.overcurrents)); break;
    case Payload::frames: object.number("frames", event.frames); break;
    case Payload::bumps: object.raw("bumps", json_of(event.bumps)); break;
    case Payload::wheels:
      object.raw("wheels", flag_names(event.wheels, kWheels))
          .text("finding", name(event.finding))
          .object("driven_mm_s", json_of(event.wanted))
          .object("counted_mm_s", json_of(event.got))
          .raw("overcurrents", json_of(event.overcurrents));
      break;
    case Payload::limits:
      object.raw("limits", json_of(event.limits))
          .object("asked_mm_s", json_of(event.wanted))
          .object("given_mm_s", json_of(event.got));
      break;
    case Payload::process: {
      JsonObject process;
      process.number("id", event.process).text("name", event.process_name.data());
      object.object("process", std::move(process));
      break;
    }
  }
}

}  // namespace cargobay::hal
