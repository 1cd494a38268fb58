// Sensor values as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "hal/columns/records.hpp"
#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"

namespace cargobay::cli {

// The single packets of a list, its groups expanded, each once, in order.
std::vector<oi::PacketId> singles(const std::vector<oi::PacketId>& packets);
// `16254 mV`, `3 (left, right)`, `safe`.
std::string text(oi::PacketId packet, const oi::SensorValues& values);
// Makes one JSON object of each reading, without line breaks: its columns (hal/columns), of these
// packets.
class JsonLine {
 public:
  explicit JsonLine(const std::vector<oi::PacketId>& packets);
  std::string of(const hal::SensorRecord& record) const;

 private:
  std::vector<oi::PacketId> packets_;
};

// One line per single packet. Packets that the values do not have are left out, of JSON too.
std::string lines(const std::vector<oi::PacketId>& packets, const oi::SensorValues& values);

}  // namespace cargobay::cli
