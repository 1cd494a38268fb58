// The port that a command talks through.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::cli {

// As hal::open_port(); what will disturb a loop on it is printed.
hal::Result<std::unique_ptr<hal::ByteStream>> open_for_use(const std::string& path,
                                                           std::uint32_t baud);

}  // namespace cargobay::cli
