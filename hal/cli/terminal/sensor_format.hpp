// Sensor values as text and as JSON.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"

namespace cargobay::cli {

// The single packets of a list, its groups expanded, each once, in order.
std::vector<oi::PacketId> singles(const std::vector<oi::PacketId>& packets);
// `16254 mV`, `3 (left, right)`, `safe`.
std::string text(oi::PacketId packet, const oi::SensorValues& values);
// When a reading was taken, neither time before 0, and what its distance and angle add up to.
struct ReadingContext {
  double unix_time_s = 0.0;  // by the system's clock, which may be set meanwhile
  double time_s = 0.0;       // since the first reading, by one that cannot
  std::int64_t distance_mm = 0;
  std::int64_t angle_deg = 0;
};

// Makes one JSON object of each reading, without line breaks: both times; raw numbers by their
// keys; in addition `<key>_name` for a code, `<key>_names` for bits, `<key>_sum` for distance and
// angle. By hand: at 67 frames a second a tree of the values costs more than reading them.
class JsonLine {
 public:
  explicit JsonLine(const std::vector<oi::PacketId>& packets);
  std::string of(const oi::SensorValues& values, const ReadingContext& context) const;

 private:
  std::vector<oi::PacketId> packets_;
};

// One line per single packet. Packets that the values do not have are left out, of JSON too.
std::string lines(const std::vector<oi::PacketId>& packets, const oi::SensorValues& values);

}  // namespace cargobay::cli
