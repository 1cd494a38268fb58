// The port that a command talks through.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/result.hpp"
#include "hal/sim/remote/chosen_robot.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::cli {

// Like hal::open_port(), but also prints what will disturb a loop on this port.
hal::Result<std::unique_ptr<hal::ByteStream>> open_for_use(const std::string& path,
                                                           std::uint32_t baud);

// The same for a robot that is not brought up. Pins on RTS and DTR are brought to rest: they would
// stay as opening the port left them, and closing it would be an edge at the power toggle.
hal::Result<std::unique_ptr<hal::ByteStream>> open_plain(const hal::ChosenRobot& chosen,
                                                         std::uint32_t baud);

}  // namespace cargobay::cli
