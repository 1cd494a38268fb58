// Any command of the manual as one value.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>

#include "oi/command_table.hpp"
#include "oi/commands.hpp"
#include "oi/fixed_list.hpp"
#include "oi/limits.hpp"

namespace cargobay::oi {

// In the order of kCommands, so that index() is an index into it.
using Command =
    std::variant<Start, Baud, Control, Safe, Full, Spot, Cover, Demo, Drive, LowSideDrivers, Leds,
                 Song, Play, Sensors, CoverAndDock, PwmLowSideDrivers, DriveDirect, DigitalOutputs,
                 Stream, QueryList, PauseResumeStream, SendIr, Script, PlayScript, ShowScript,
                 WaitTime, WaitDistance, WaitAngle, WaitEvent>;

// The command's entry in the table.
constexpr const CommandInfo& info(const Command& command) { return kCommands[command.index()]; }

using EncodedAnyCommand = FixedList<std::uint8_t, kMaxCommandBytes>;

// The command's bytes; nothing if a value is outside its range, as for the command itself
// (oi/encode.hpp).
std::optional<EncodedAnyCommand> encode(const Command& command);

}  // namespace cargobay::oi
