// Sensor values as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"

namespace cargobay::cli {

// The single packets of a list, its groups expanded, in order.
std::vector<oi::PacketId> singles(const std::vector<oi::PacketId>& packets);
// `16254 mV`, `3 (left, right)`, `safe`.
std::string text(oi::PacketId packet, const oi::SensorValues& values);
// One JSON object without line breaks: raw numbers by their keys; in addition `<key>_name` for a
// code and `<key>_names` for bits.
std::string json_line(const std::vector<oi::PacketId>& packets, const oi::SensorValues& values);
// One line per single packet.
std::string lines(const std::vector<oi::PacketId>& packets, const oi::SensorValues& values);

}  // namespace cargobay::cli
