// The port that a command talks through.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::cli {

// Like hal::open_port(), but also prints what will disturb a loop on this port.
hal::Result<std::unique_ptr<hal::ByteStream>> open_for_use(const std::string& path,
                                                           std::uint32_t baud);

}  // namespace cargobay::cli
