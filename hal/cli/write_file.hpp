// Writes a result to a file.
#pragma once

#include <optional>
#include <string>

#include "hal/result.hpp"

namespace cargobay::cli {

// Whole or not at all: by a temporary file beside it. "-" is standard output.
std::optional<hal::Failure> write_file(const std::string& path, const std::string& text);
// Whether write_file() could write there; found out before a long run, not after. Leaves an
// existing file as it is.
std::optional<hal::Failure> check_writable(const std::string& path);

}  // namespace cargobay::cli
