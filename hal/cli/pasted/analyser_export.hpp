// What logic analysers export of a serial line that they have decoded: the tables of Saleae Logic 1
// and 2 (CSV), the annotations of sigrok-cli and PulseView.
#pragma once

#include <optional>
#include <string_view>

#include "hal/cli/pasted/pasted_bytes.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

// Nothing if the text is not such an export. Rows that are not bytes (start bits, errors) are left
// out; a table without a column of data is a failure.
std::optional<hal::Result<Pasted>> read_analyser_export(std::string_view text);

}  // namespace cargobay::cli
