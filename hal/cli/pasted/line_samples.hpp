// The levels of serial lines over time, as a logic analyser exports them without decoding: CSV of
// Saleae Logic (`Time [s],Channel 0`) and of sigrok and PulseView (a row for each sample).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/cli/pasted/pasted_bytes.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

// Nothing if the text is not such an export. Reads each line as 8 data bits, no parity, one stop
// bit, idle high, at this rate; a failure if more than one byte in ten has no stop bit.
std::optional<hal::Result<Pasted>> read_line_samples(std::string_view text, std::uint32_t baud);

}  // namespace cargobay::cli
