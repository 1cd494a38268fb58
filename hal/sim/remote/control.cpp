#include "hal/sim/remote/control.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "hal/sim/next_word.hpp"
#include "hal/sim/remote/fault_command.hpp"
#include "hal/sim/remote/wheel_controls.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kShortPressMs = 200.0;
constexpr double kLongestPressMs = 3'600'000.0;
constexpr double kLongestSeconds = 86'400.0;
constexpr std::size_t kMostDeeds = 1000;
constexpr double kFarthestMm = 1e6;
constexpr double kMostMah = 65535.0;
constexpr double kFastestMmPerSec = 1000.0;

std::optional<bool> either(std::string_view word, std::string_view yes, std::string_view no) {
  if (word == yes) return true;
  if (word == no) return false;
  return std::nullopt;
}

// The switch with that name in a group; null if there is none.
bool* wheel_drop(Inputs& inputs, std::string_view name) {
  if (name == "left") return &inputs.wheel_drop_left;
  if (name == "right") return &inputs.wheel_drop_right;
  return name == "caster" ? &inputs.wheel_drop_caster : nullptr;
}
CliffSensor* cliff(Inputs& inputs, std::string_view name) {
  if (name == "left") return &inputs.cliff_left;
  if (name == "front_left") return &inputs.cliff_front_left;
  if (name == "front_right") return &inputs.cliff_front_right;
  return name == "right" ? &inputs.cliff_right : nullptr;
}
bool* overcurrent(Inputs& inputs, std::string_view name) {
  if (name == "left_wheel") return &inputs.overcurrent_left_wheel;
  if (name == "right_wheel") return &inputs.overcurrent_right_wheel;
  if (name == "ld0") return &inputs.overcurrent_low_side_driver[0];
  if (name == "ld1") return &inputs.overcurrent_low_side_driver[1];
  return name == "ld2" ? &inputs.overcurrent_low_side_driver[2] : nullptr;
}

// Sets the switch as the last word of the command says.
bool set_switch(bool* target, std::string_view rest) {
  const std::optional<bool> on = either(next_word(rest), "on", "off");
  if (target == nullptr || !on || !no_more_words(rest)) return false;
  *target = *on;
  return true;
}

bool set_cliff(Inputs& inputs, std::string_view rest) {
  CliffSensor* sensor = cliff(inputs, next_word(rest));
  bool on = false;
  if (sensor == nullptr || !set_switch(&on, rest)) return false;
  constexpr std::uint16_t kNoFloorSignal = 8;
  *sensor = on ? CliffSensor{.cliff = true, .signal = kNoFloorSignal} : CliffSensor{};
  return true;
}

bool set_wall(Inputs& inputs, std::string_view rest) {
  if (!set_switch(&inputs.wall, rest)) return false;
  constexpr std::uint16_t kWallSignal = 2000;
  inputs.wall_signal = inputs.wall ? kWallSignal : std::uint16_t{0};
  return true;
}

bool set_bump(Inputs& inputs, std::string_view rest) {
  const std::string_view side = next_word(rest);
  const bool known = side == "none" || side == "left" || side == "right" || side == "both";
  if (!known || !no_more_words(rest)) return false;
  inputs.bump_left = side == "left" || side == "both";
  inputs.bump_right = side == "right" || side == "both";
  return true;
}

bool press(Device& device, std::string_view rest) {
  const std::optional<oi::Button> which = oi::value_named<oi::Button>(next_word(rest));
  const std::string_view word = next_word(rest);
  const std::optional<double> ms =
      word.empty() ? kShortPressMs : to_number(word, 0.0, kLongestPressMs);
  if (!which || !ms || !no_more_words(rest)) return false;
  device.press(*which, rt::Duration{static_cast<std::int64_t>(*ms * 1e6)});
  return true;
}

bool set_button(Inputs& inputs, std::string_view rest, bool down) {
  const std::optional<oi::Button> which = oi::value_named<oi::Button>(next_word(rest));
  if (!which || !no_more_words(rest)) return false;
  (*which == oi::Button::play ? inputs.play_button : inputs.advance_button) = down;
  return true;
}
bool hold(Inputs& inputs, std::string_view rest) { return set_button(inputs, rest, true); }
bool release(Inputs& inputs, std::string_view rest) { return set_button(inputs, rest, false); }

bool set_digital_in(Inputs& inputs, std::string_view rest) {
  const std::optional<int> number = to_integer(next_word(rest), 0, 3);
  const std::optional<int> level = to_integer(next_word(rest), 0, 1);
  if (!number || !level || !no_more_words(rest)) return false;
  inputs.digital[static_cast<std::size_t>(*number)] = *level == 1;
  return true;
}

bool place(Device& device, std::string_view rest) {
  const std::optional<double> x = to_number(next_word(rest), -kFarthestMm, kFarthestMm);
  const std::optional<double> y = to_number(next_word(rest), -kFarthestMm, kFarthestMm);
  const std::optional<double> heading = to_number(next_word(rest), -36000.0, 36000.0);
  if (!x || !y || !heading || !no_more_words(rest)) return false;
  device.place({.x_mm = *x, .y_mm = *y, .heading_rad = *heading * std::numbers::pi / 180.0});
  return true;
}

// The commands with a number as their only argument.
template <typename Set>
bool set_integer(std::string_view rest, int highest, Set&& set) {
  const std::optional<int> value = to_integer(next_word(rest), 0, highest);
  if (!value || !no_more_words(rest)) return false;
  set(*value);
  return true;
}

// The commands with a level as their only argument.
template <typename Set>
bool set_level(std::string_view rest, Set&& set) {
  const std::optional<bool> high = either(next_word(rest), "high", "low");
  if (!high || !no_more_words(rest)) return false;
  set(*high);
  return true;
}

bool set_battery(Device& device, std::string_view rest) {
  const std::optional<double> mah = to_number(next_word(rest), 0.0, kMostMah);
  if (!mah || !no_more_words(rest)) return false;
  device.battery().set_charge_mah(*mah);
  return true;
}

bool change_battery(Device& device, std::string_view rest) {
  const std::optional<bool> alkaline = either(next_word(rest), "alkaline", "rechargeable");
  if (!alkaline || !no_more_words(rest)) return false;
  device.change_battery(*alkaline ? BatteryPack::alkaline : BatteryPack::rechargeable);
  return true;
}

bool set_charging(Device& device, std::string_view rest) {
  const std::string_view trouble = next_word(rest);
  const bool known = trouble == "normal" || trouble == "waiting" || trouble == "fault";
  if (!known || !no_more_words(rest)) return false;
  device.battery().set_trouble(trouble == "fault"     ? ChargingTrouble::fault
                               : trouble == "waiting" ? ChargingTrouble::waiting
                                                      : ChargingTrouble::none);
  return true;
}

bool turn_wheels(Device& device, std::string_view rest) {
  const std::optional<double> left =
      to_number(next_word(rest), -kFastestMmPerSec, kFastestMmPerSec);
  const std::optional<double> right =
      to_number(next_word(rest), -kFastestMmPerSec, kFastestMmPerSec);
  if (!left || !right || !no_more_words(rest)) return false;
  device.turn_wheels({.left_mm_s = *left, .right_mm_s = *right});
  return true;
}

bool set_infrared(Inputs& inputs, std::string_view rest) {
  return set_integer(rest, 255,
                     [&](int value) { inputs.infrared = static_cast<std::uint8_t>(value); });
}

bool set_analog_in(Inputs& inputs, std::string_view rest) {
  return set_integer(rest, 1023,
                     [&](int value) { inputs.analog = static_cast<std::uint16_t>(value); });
}

bool set_wheel_drop(Inputs& inputs, std::string_view rest) {
  bool* const drop = wheel_drop(inputs, next_word(rest));
  return set_switch(drop, rest);
}

bool set_overcurrent(Inputs& inputs, std::string_view rest) {
  bool* const load = overcurrent(inputs, next_word(rest));
  return set_switch(load, rest);
}

bool press_power(Device& device, std::string_view rest) {
  if (!no_more_words(rest)) return false;
  device.press_power();
  return true;
}

bool set_brc(Device& device, std::string_view rest) {
  return set_level(rest, [&](bool high) { device.set_brc(high); });
}

bool set_power_toggle(Device& device, std::string_view rest) {
  return set_level(rest, [&](bool high) { device.set_power_toggle(high); });
}

std::optional<std::string> fault(std::string_view rest, Cable& cable) {
  while (!rest.empty() && (rest.back() == '\r' || rest.back() == ' ')) rest.remove_suffix(1);
  const std::string problem = apply_fault(rest, cable);
  return problem.empty() ? "" : "error: " + problem;
}

std::optional<std::string> state(std::string_view rest, Cable& cable) {
  if (!no_more_words(rest)) return std::nullopt;
  return state_json(cable);
}

std::optional<std::string> help(std::string_view rest, Cable& cable);
std::optional<std::string> later(std::string_view rest, Cable& cable);

using Answer = std::optional<std::string>;
Answer ok_if(bool done) { return done ? Answer{""} : std::nullopt; }

// The handler of a row, from what it does to the robot, to its inputs, or to one of their switches.
template <bool (*kSet)(Device&, std::string_view)>
Answer to_robot(std::string_view rest, Cable& cable) {
  return ok_if(kSet(cable.device(), rest));
}
template <bool (*kSet)(Inputs&, std::string_view)>
Answer to_inputs(std::string_view rest, Cable& cable) {
  return ok_if(kSet(cable.device().inputs(), rest));
}
template <bool Inputs::* kSwitch>
Answer to_switch(std::string_view rest, Cable& cable) {
  return ok_if(set_switch(&(cable.device().inputs().*kSwitch), rest));
}

constexpr std::array kControls{
    ControlInfo{"power", "", "presses the power button", &to_robot<press_power>},
    ControlInfo{"press", "play|advance [MS]", "presses a button, for 200 ms by default",
                &to_robot<press>},
    ControlInfo{"hold", "play|advance", "holds a button down", &to_inputs<hold>},
    ControlInfo{"release", "play|advance", "lets go of it", &to_inputs<release>},
    ControlInfo{"bump", "none|left|right|both", "pushes the bumper", &to_inputs<set_bump>},
    ControlInfo{"wheeldrop", "left|right|caster on|off", "lifts a wheel from the floor",
                &to_inputs<set_wheel_drop>},
    ControlInfo{"cliff", "left|front_left|front_right|right on|off", "takes the floor away",
                &to_inputs<set_cliff>},
    ControlInfo{"wall", "on|off", "holds something to the wall sensor", &to_inputs<set_wall>},
    ControlInfo{"virtual-wall", "on|off", "shows it a virtual wall's beam",
                &to_switch<&Inputs::virtual_wall>},
    ControlInfo{"charger", "on|off", "plugs the charger in", &to_switch<&Inputs::charger>},
    ControlInfo{"home-base", "on|off", "puts it on its Home Base", &to_switch<&Inputs::home_base>},
    ControlInfo{"ir", "BYTE", "sends it this infrared byte until the next; 255 is none",
                &to_inputs<set_infrared>},
    ControlInfo{"digital-in", "N 0|1", "sets digital input 0 to 3", &to_inputs<set_digital_in>},
    ControlInfo{"analog-in", "N", "sets the analog input, 0 to 1023", &to_inputs<set_analog_in>},
    ControlInfo{"overcurrent", "left_wheel|right_wheel|ld0|ld1|ld2 on|off", "overloads an output",
                &to_inputs<set_overcurrent>},
    ControlInfo{"brc", "low|high", "sets the Baud Rate Change pin", &to_robot<set_brc>},
    ControlInfo{"power-toggle", "low|high", "sets the power toggle pin",
                &to_robot<set_power_toggle>},
    ControlInfo{"battery", "MAH", "sets the charge", &to_robot<set_battery>},
    ControlInfo{"battery-pack", "rechargeable|alkaline",
                "puts a full one in, and the robot forgets everything", &to_robot<change_battery>},
    ControlInfo{"charging", "normal|waiting|fault",
                "gives its charger something to wait for or a fault", &to_robot<set_charging>},
    ControlInfo{"place", "X_MM Y_MM HEADING_DEG", "puts it there", &to_robot<place>},
    ControlInfo{"turn-wheels", "LEFT_MM_S RIGHT_MM_S",
                "turns its wheels by hand while its motors are off", &to_robot<turn_wheels>},
    ControlInfo{"plant", "[NAME] [VALUE NUMBER]...",
                "changes how its wheels answer; `plant ?` lists the names", &change_plant},
    ControlInfo{"load", "PART [left|right|both] [MS]",
                "leaves this part of the wheels' gain (0.75, not 75), for so long or from now on",
                &change_load},
    ControlInfo{"stuck", "none|left|right|both [MS]",
                "holds a wheel, which draws 1 A while its motor is on", &change_stuck},
    ControlInfo{"fault", "NAME [ARGUMENTS]", "makes something go wrong; `fault` alone lists what",
                &fault},
    ControlInfo{"at", "SECONDS COMMAND",
                "does one of these when the virtual Create has run for that long", &later},
    ControlInfo{"state", "", "prints its whole state, as JSON", &state},
    ControlInfo{"help", "", "lists these", &help},
};

std::string names() {
  std::string list;
  for (const ControlInfo& info : kControls)
    list += (list.empty() ? "" : " ") + std::string{info.name};
  return list;
}

std::optional<std::string> help(std::string_view rest, Cable& /*cable*/) {
  if (!no_more_words(rest)) return std::nullopt;
  return "ok " + names();
}

const ControlInfo* find_control(std::string_view name) {
  const auto* const info = std::ranges::find(kControls, name, &ControlInfo::name);
  return info == kControls.end() ? nullptr : info;
}

// What the command answers then, nobody hears: it is tried now, on another robot of the kind.
std::optional<std::string> later(std::string_view rest, Cable& cable) {
  const std::optional<double> seconds = to_number(next_word(rest), 0.0, kLongestSeconds);
  if (!seconds || no_more_words(rest)) return std::nullopt;
  // Tried and then done at each level, they would take twice as long with each.
  std::string_view words = rest;
  if (next_word(words) == "at") return "error: `at` is not for an `at`; give the later time alone";
  if (cable.deeds() >= kMostDeeds)
    return "error: " + std::to_string(kMostDeeds) + " commands wait for their time, the most";
  const auto another = std::make_unique<Device>(cable.device().parameters());
  Cable its_cable{*another};
  if (std::string answer = control(rest, its_cable); answer.starts_with("error: ")) return answer;
  cable.at(rt::Duration{std::llround(*seconds * 1e9)},
           [line = std::string{rest}](Cable& then) { (void)control(line, then); });
  return "";
}

}  // namespace

std::span<const ControlInfo> controls() { return kControls; }

std::string control(std::string_view line, Cable& cable) {
  std::string_view rest = line;
  const std::string_view name = next_word(rest);
  const ControlInfo* const info = find_control(name);
  if (info == nullptr) {
    return "error: unknown command '" + std::string{name} + "'; the commands are: " + names();
  }
  if (const std::optional<std::string> answer = info->apply(rest, cable))
    return answer->empty() ? "ok" : *answer;
  std::string usage{name};
  if (!info->arguments.empty()) usage += " " + std::string{info->arguments};
  return "error: the usage is '" + usage + "'";
}

}  // namespace cargobay::hal::sim
