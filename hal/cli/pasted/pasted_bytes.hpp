// Bytes as they are pasted: from a terminal, a program, a logic analyser.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/cli/terminal/operands.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

struct PastedLine {
  std::string name{};  // of the line or analyser; empty if the form has none
  std::vector<std::uint8_t> bytes{};
};

struct Pasted {
  std::string_view form{};          // "xxd", for a remark; empty for bytes written one by one
  std::vector<PastedLine> lines{};  // more than one only from an analyser
};

// Takes the forms of read_bytes(), read_dump(), read_analyser_export() and, at `baud`, of
// read_line_samples(); literals of Python (b'\x89\xff8', bytes([137, 255])) and arrays of C. An
// offset is never taken for data; what does not fit together is a failure that names the line.
// `base` decides where the form does not.
hal::Result<Pasted> read_pasted(std::string_view text, Base base, std::uint32_t baud);

}  // namespace cargobay::cli
