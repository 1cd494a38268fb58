// From an open port to a robot that streams frames in the wanted mode at the wanted rate, whatever
// state it is found in; and back to Passive.
//
// Runs on the stream's clock, so in virtual time as well. Each step has a time limit.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "gpio/pulse_player.hpp"
#include "hal/bring_up/robot_pins.hpp"
#include "hal/guard/farewell.hpp"
#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/command_table.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"

namespace cargobay::hal {

struct BringUpEvent {
  rt::Duration time{0};  // since the beginning
  std::string step{};    // a word or two
  std::string detail{};  // may be empty
};

struct BringUpRequest {
  const oi::Dialect* dialect = &oi::kCreate;
  oi::Mode mode = oi::Mode::safe;  // passive, safe or full
  oi::StreamList packets{};        // must hold oi_mode
  RobotPins pins{};
  // Called with each step as it begins, and with its result; may be empty.
  std::function<void(const BringUpEvent&)> progress{};
  // Called every 20 ms: true ends the bring-up. May be empty.
  std::function<bool()> cancelled{};
  // Set on failure: what became of the robot. May be null.
  Parting* left = nullptr;
};

enum class RateChange : std::uint8_t { none, brc, command };

struct BringUpReport {
  rt::Duration took{0};
  std::uint32_t found_baud = 0;  // the rate at which the robot first answered
  RateChange rate_change = RateChange::none;
  bool powered_on = false;      // by the toggle
  bool resynchronised = false;  // freed from a half-sent command
  gpio::PlayReport brc{};       // the last pulse train; no pulses if none was played
  oi::Mode mode = oi::Mode::off;
  std::int32_t battery_mv = 0;  // 0 if the list does not contain it
};

// The stream's rate is the wanted one, and is set again at the end. Tries in turn, as far as
// needed: power on by the toggle; Start and a question at the wanted rate, then Stream if it is
// answered; three pulses on the BRC pin, 2 s after power-on, if 19200 is wanted and the pin is
// wired; a search at all rates, 57600, 19200 and 115200 first; another search after freeing the
// robot from a half-sent command, except at 1200 baud or less; the Baud command; the mode. Consumes
// the first readings of the stream, which may be junk. Releases every pin at the end. Blocks for
// 0.2 s if the robot answers at once, for up to 45 s if everything has to be tried. It tries less
// if something else is known to be at the other end: a login prompt, a GPS receiver; or its own
// echo, if the power toggle does not end that. After a failure the robot has been told to stop and
// go Passive, unless it was cancelled before the robot ever answered: then it is as it was found.
// What is known not to be a robot counts as left standing. The failure says at which step it ended,
// what was heard, and what to check.
Result<BringUpReport> bring_up(ByteStream& stream, const BringUpRequest& request);

constexpr std::string_view name(RateChange change) {
  switch (change) {
    case RateChange::none: return "none";
    case RateChange::brc: return "brc";
    case RateChange::command: return "baud command";
  }
  return "";
}

}  // namespace cargobay::hal
