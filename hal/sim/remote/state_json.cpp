// The command `state` of the control socket.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/json_object.hpp"
#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/remote/control.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal::sim {

namespace {

JsonObject pose(const WorldPose& pose) {
  return JsonObject{}
      .thousandths("x_mm", pose.x_mm)
      .thousandths("y_mm", pose.y_mm)
      .thousandths("heading_deg",
                   std::remainder(pose.heading_rad * 180.0 / std::numbers::pi, 360.0));
}

JsonObject speeds(WheelSpeeds speeds) {
  return JsonObject{}.thousandths("left", speeds.left_mm_s).thousandths("right", speeds.right_mm_s);
}

JsonObject leds(const Actuators& actuators) {
  return JsonObject{}
      .truth(oi::name(oi::Led::play), actuators.lit(oi::Led::play))
      .truth(oi::name(oi::Led::advance), actuators.lit(oi::Led::advance))
      .number("power_color", actuators.leds.power_color)
      .number("power_intensity", actuators.leds.power_intensity);
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
      .thousandths("left", device.hardship(Side::left).load)
      .thousandths("right", device.hardship(Side::right).load);
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
      .thousandths("vpwr_mv", vpwr_mv)
      .thousandths("switched_vpwr_mv", on ? vpwr_mv : 0.0);
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
      .number("bytes_received", device.bytes_received)
      .number("bytes_unheard", device.bytes_unheard)
      .number("bytes_overrun", device.bytes_overrun)
      .number("commands", device.commands)
      .number("commands_refused", device.commands_refused)
      .number("commands_out_of_range", device.commands_out_of_range)
      .number("unknown_opcodes", device.unknown_opcodes)
      .number("bytes_sent", device.bytes_sent)
      .number("bytes_lost", device.bytes_lost)
      .number("frames_sent", device.frames_sent)
      .number("safety_stops", device.safety_stops)
      .number("boots", device.boots)
      .number("robot_framing_errors", cable.robot_framing_errors)
      .number("host_framing_errors", cable.host_framing_errors)
      .number("host_overruns", cable.host_overruns);
}

}  // namespace

std::string state_json(const Cable& cable) {
  const Device& device = cable.device();
  const Actuators& actuators = device.actuators();
  const auto condition = device.last_safety_condition();
  JsonObject state;
  state.text("mode", oi::name(device.mode()))
      .number("baud", device.baud())
      .truth("powered", device.power() != Power::off)
      .truth("booting", device.power() == Power::booting)
      .thousandths("time_s", rt::seconds(device.now()))
      .object("pose", pose(device.truth().pose))
      .object("wheel_mm_s", speeds(device.truth().speeds))
      .object("commanded_mm_s", speeds(device.commanded()))
      .object("plant", plant(device.parameters().wheels))
      .object("load", load(device))
      .object("stuck", stuck(device))
      .object("leds", leds(actuators))
      .truth("song_playing", device.songs().playing())
      .number("note", device.sounding())
      .number("digital_out", actuators.digital_outputs);
  low_side_drivers(state, device)
      .raw("ir_sent", actuators.infrared_sent ? std::to_string(*actuators.infrared_sent) : "null")
      .number("script_bytes", device.script().size())
      .truth("waiting", device.waiting())
      .truth("demo_running", device.demos().running())
      .number("charging_state", static_cast<std::uint64_t>(device.battery().state()))
      .thousandths("battery_mah", device.battery().charge_mah())
      .text("battery_pack", name(device.battery().pack()))
      .object("pins", pins(device))
      .number("stream_packets", device.stream().packets().size())
      .truth("streaming", device.stream().running())
      .text("brc", device.brc_high() ? "high" : "low")
      .raw("last_hazard", condition ? "\"" + std::string{name(*condition)} + "\"" : "null")
      .object("counters", counters(device.counters(), cable.counters()));
  return state.take();
}

}  // namespace cargobay::hal::sim
