// Which line an address means, among the chips present. Knows nothing of libgpiod.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "gpio/line.hpp"

namespace cargobay::gpio {

struct FoundLine {
  std::string chip_path{};
  unsigned offset = 0;
};

// Nothing, with `error` set, if none or several are meant, or if another process holds the line.
std::optional<FoundLine> find_line(std::span<const ChipInfo> chips, const LineAddress& address,
                                   LineError& error);
// Why a line that was found was refused, by the errno of the request.
LineError refused(std::span<const ChipInfo> chips, const LineAddress& address,
                  const FoundLine& found, int error);

}  // namespace cargobay::gpio
