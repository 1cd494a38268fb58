// The virtual Create by remote control, as text: the hands that push its buttons and hold things in
// front of its sensors. One line is one command, and its answer is one line: `ok`, `error: ...` or
// JSON.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "hal/sim/line/cable.hpp"

namespace cargobay::hal::sim {

struct ControlInfo {
  std::string_view name;
  std::string_view arguments;
  std::string_view meaning;
};

inline constexpr std::array<ControlInfo, 25> kControls{{
    {"power", "", "presses the power button"},
    {"press", "play|advance [MS]", "presses a button, for 200 ms unless said otherwise"},
    {"hold", "play|advance", "holds a button down"},
    {"release", "play|advance", "lets go of it"},
    {"bump", "none|left|right|both", "pushes the bumper"},
    {"wheeldrop", "left|right|caster on|off", "lifts a wheel from the floor"},
    {"cliff", "left|front_left|front_right|right on|off", "takes the floor away"},
    {"wall", "on|off", "holds something to the wall sensor"},
    {"virtual-wall", "on|off", "shows it a virtual wall's beam"},
    {"charger", "on|off", "plugs the charger in"},
    {"home-base", "on|off", "puts it on its Home Base"},
    {"ir", "BYTE", "sends it an infrared byte until the next; 255 is none"},
    {"digital-in", "N 0|1", "sets digital input 0 to 3"},
    {"analog-in", "N", "sets the analog input, 0 to 1023"},
    {"overcurrent", "left_wheel|right_wheel|ld0|ld1|ld2 on|off", "overloads an output"},
    {"brc", "low|high", "sets the Baud Rate Change pin"},
    {"power-toggle", "low|high", "sets the power toggle pin"},
    {"battery", "MAH", "sets the charge"},
    {"battery-pack", "rechargeable|alkaline", "puts a full one in, which it forgets all over"},
    {"charging", "normal|waiting|fault", "gives its charger something to wait for or a fault"},
    {"place", "X_MM Y_MM HEADING_DEG", "puts it there"},
    {"turn-wheels", "LEFT_MM_S RIGHT_MM_S", "turns its wheels by hand while its motors are off"},
    {"fault", "NAME [ARGUMENTS]", "makes something go wrong; `fault` alone lists what"},
    {"state", "", "tells all about it, as JSON"},
    {"help", "", "lists these"},
}};

// The answer to the line, without its end.
std::string control(std::string_view line, Cable& cable);

// All about the device and its line, as one JSON object on one line.
std::string state_json(const Cable& cable);

}  // namespace cargobay::hal::sim
