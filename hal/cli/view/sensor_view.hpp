// The live picture of `cargobay sensors`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/bring_up/sensor_stream.hpp"
#include "hal/cli/view/screen.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::cli {

struct SensorPicture {
  std::string where{};  // port and rate
  std::uint64_t frames = 0;
  double time_s = 0.0;  // since the first frame
  hal::SensorFrame frame{};
};

// All single packets of the list: mode, bumps, wheel drops, cliffs and battery first, then
// distance and angle with their sums. A large window has one packet a line with its number and
// name; a smaller one has several a line, short. What does not even fit then is counted.
std::vector<ScreenLine> sensor_view(const SensorPicture& picture,
                                    const std::vector<oi::PacketId>& packets,
                                    const WindowSize& window);

// The same packets, as far as the frame has them: several a line, short, for a part of a picture.
std::vector<ScreenLine> sensor_lines(const std::vector<oi::PacketId>& packets,
                                     const hal::SensorFrame& frame, int columns);

}  // namespace cargobay::cli
