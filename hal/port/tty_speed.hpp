// The baud rate of a terminal as a number. termios knows only the rates that have a constant; of
// the robot's twelve, 14400 and 28800 have none.
#pragma once

#include <cstdint>
#include <optional>
#include <system_error>

namespace cargobay::hal {

// Both directions, from now on, using the rate's constant if it has one, so that every program that
// looks at the terminal sees the rate. Bytes still queued go out at the new rate, so drain first.
// After an error the previous rate still applies.
[[nodiscard]] std::error_code set_tty_speed(int descriptor, std::uint32_t baud);

// The rate at which the terminal sends; nothing if it is not a terminal. On the master side of a
// pseudo-terminal: the rate that its slave side was set to.
std::optional<std::uint32_t> tty_speed(int descriptor);

}  // namespace cargobay::hal
