// The command `state` of the control socket.
#include <algorithm>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/remote/control.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal::sim {

namespace {

// An object whose values are numbers, booleans, names without quotes in them, and objects.
class JsonObject {
 public:
  JsonObject& number(std::string_view key, double value) {
    std::array<char, 48> text{};
    const int length = std::snprintf(text.data(), text.size(), "%.3f", value);
    return raw(key, {text.data(), static_cast<std::size_t>(length)});
  }
  JsonObject& integer(std::string_view key, std::uint64_t value) {
    return raw(key, std::to_string(value));
  }
  JsonObject& truth(std::string_view key, bool value) { return raw(key, value ? "true" : "false"); }
  JsonObject& text(std::string_view key, std::string_view value) {
    return raw(key, "\"" + std::string{value} + "\"");
  }
  JsonObject& object(std::string_view key, JsonObject value) { return raw(key, value.take()); }
  JsonObject& raw(std::string_view key, std::string_view value) {
    text_ += text_.empty() ? "{\"" : ",\"";
    text_ += key;
    text_ += "\":";
    text_ += value;
    return *this;
  }
  std::string take() { return std::move(text_) + "}"; }

 private:
  std::string text_;
};

JsonObject pose(const WorldPose& pose) {
  return JsonObject{}
      .number("x_mm", pose.x_mm)
      .number("y_mm", pose.y_mm)
      .number("heading_deg", std::remainder(pose.heading_rad * 180.0 / std::numbers::pi, 360.0));
}

JsonObject speeds(WheelSpeeds speeds) {
  return JsonObject{}.number("left", speeds.left_mm_s).number("right", speeds.right_mm_s);
}

JsonObject leds(const Actuators& actuators) {
  return JsonObject{}
      .truth(oi::name(oi::Led::play), actuators.lit(oi::Led::play))
      .truth(oi::name(oi::Led::advance), actuators.lit(oi::Led::advance))
      .integer("power_color", actuators.leds.power_color)
      .integer("power_intensity", actuators.leds.power_intensity);
}

JsonObject plant(const WheelParameters& wheels) {
  JsonObject values;
  const std::optional<std::string_view> name = plant_name(wheels);
  values.raw("name", name ? "\"" + std::string{*name} + "\"" : "null");
  for (const PlantValue& value : plant_values()) {
    std::string key{value.name};
    std::ranges::replace(key, '-', '_');
    const std::string text = value_of(value, wheels);
    value.is_number() ? values.raw(key, text) : values.text(key, text);
  }
  return values;
}

JsonObject load(const Device& device) {
  return JsonObject{}
      .number("left", device.hardship(Side::left).load)
      .number("right", device.hardship(Side::right).load);
}

JsonObject stuck(const Device& device) {
  return JsonObject{}
      .truth("left", device.stuck(Side::left))
      .truth("right", device.stuck(Side::right));
}

// The pins of the cargo bay connector (OI p. 4) that the robot drives: 13, 8, 9, 10 to 12.
JsonObject pins(const Device& device) {
  const bool on = device.power() != Power::off;
  const double vpwr_mv = device.battery().voltage_mv();
  return JsonObject{}
      .truth("charging", device.battery().charging())
      .truth("switched_5v", on)
      .number("vpwr_mv", vpwr_mv)
      .number("switched_vpwr_mv", on ? vpwr_mv : 0.0);
}

// The settings of the drivers, and the currents.
JsonObject& low_side_drivers(JsonObject& state, const Device& device) {
  const std::array<std::uint8_t, 3>& duty = device.actuators().low_side_drivers;
  const std::array<double, 3> current_ma = device.low_side_driver_ma();
  std::string duties;
  std::string currents;
  for (std::size_t i = 0; i < duty.size(); ++i) {
    duties += (i == 0 ? "[" : ",") + std::to_string(duty[i]);
    currents += (i == 0 ? "[" : ",") + std::to_string(std::lround(current_ma[i]));
  }
  return state.raw("low_side_driver", duties + "]").raw("low_side_driver_ma", currents + "]");
}

JsonObject counters(const DeviceCounters& device, const CableCounters& cable) {
  return JsonObject{}
      .integer("bytes_received", device.bytes_received)
      .integer("bytes_unheard", device.bytes_unheard)
      .integer("bytes_overrun", device.bytes_overrun)
      .integer("commands", device.commands)
      .integer("commands_refused", device.commands_refused)
      .integer("commands_out_of_range", device.commands_out_of_range)
      .integer("unknown_opcodes", device.unknown_opcodes)
      .integer("bytes_sent", device.bytes_sent)
      .integer("bytes_lost", device.bytes_lost)
      .integer("frames_sent", device.frames_sent)
      .integer("safety_stops", device.safety_stops)
      .integer("boots", device.boots)
      .integer("robot_framing_errors", cable.robot_framing_errors)
      .integer("host_framing_errors", cable.host_framing_errors)
      .integer("host_overruns", cable.host_overruns);
}

}  // namespace

std::string state_json(const Cable& cable) {
  const Device& device = cable.device();
  const Actuators& actuators = device.actuators();
  const auto condition = device.last_safety_condition();
  JsonObject state;
  state.text("mode", oi::name(device.mode()))
      .integer("baud", device.baud())
      .truth("powered", device.power() != Power::off)
      .truth("booting", device.power() == Power::booting)
      .number("time_s", rt::seconds(device.now()))
      .object("pose", pose(device.truth().pose))
      .object("wheel_mm_s", speeds(device.truth().speeds))
      .object("commanded_mm_s", speeds(device.commanded()))
      .object("plant", plant(device.parameters().wheels))
      .object("load", load(device))
      .object("stuck", stuck(device))
      .object("leds", leds(actuators))
      .truth("song_playing", device.songs().playing())
      .integer("note", device.sounding())
      .integer("digital_out", actuators.digital_outputs);
  low_side_drivers(state, device)
      .raw("ir_sent", actuators.infrared_sent ? std::to_string(*actuators.infrared_sent) : "null")
      .integer("script_bytes", device.script().size())
      .truth("waiting", device.waiting())
      .truth("demo_running", device.demos().running())
      .integer("charging_state", static_cast<std::uint64_t>(device.battery().state()))
      .number("battery_mah", device.battery().charge_mah())
      .text("battery_pack", name(device.battery().pack()))
      .object("pins", pins(device))
      .integer("stream_packets", device.stream().packets().size())
      .truth("streaming", device.stream().running())
      .text("brc", device.brc_high() ? "high" : "low")
      .raw("last_hazard", condition ? "\"" + std::string{name(*condition)} + "\"" : "null")
      .object("counters", counters(device.counters(), cable.counters()));
  return state.take();
}

}  // namespace cargobay::hal::sim
