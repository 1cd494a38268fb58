// Why a bring-up failed, and the message for it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "hal/bring_up/dialogue.hpp"
#include "hal/result.hpp"
#include "oi/command_table.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"

namespace cargobay::hal {

enum class BringUpTrouble : std::uint8_t {
  silent,        // no answer at any rate; something else may have been heard
  switched_off,  // according to its indicator, and there is no toggle
  stays_off,     // according to its indicator, after the toggle
  pin_failed,
  keeps_its_rate,  // neither pulses nor the Baud command changed it
  wrong_mode,
  stream_ended,  // it answered, then fell silent
  hung_up,
  cancelled,
};

struct HeardAt {
  std::uint32_t baud = 0;
  Heard heard{};
};

struct BringUpFailure {
  const oi::Dialect* dialect = &oi::kCreate;
  BringUpTrouble trouble = BringUpTrouble::silent;
  std::string step{};  // the last one reported
  std::uint32_t wanted_baud = 0;
  std::uint32_t found_baud = 0;  // 0: it never answered
  std::vector<HeardAt> heard{};  // each time that nothing answered
  oi::Mode wanted_mode = oi::Mode::safe;
  oi::Mode mode = oi::Mode::off;
  bool charging = false;  // according to its pin
  bool pulses_played = false;
  bool toggled = false;
  std::error_code pin_error{};
  bool pins_of_port = false;  // RTS or DTR is one of the pins
  std::string others{};       // as others_at() says it
};

// One line: the step, what was heard, what to check.
Failure explain(const BringUpFailure& why);

// Whose text or echo was heard, and what to do about it; empty if there was neither.
std::string what_sends(const BringUpFailure& why);

// That frames with these packets take longer than a tick at this rate, and what to do about it.
Failure too_long(const oi::StreamList& packets, std::uint32_t baud, const oi::Dialect& dialect);

}  // namespace cargobay::hal
