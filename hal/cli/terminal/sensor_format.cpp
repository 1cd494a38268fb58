#include "hal/cli/terminal/sensor_format.hpp"

#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "oi/dialect.hpp"

namespace cargobay::cli {
namespace {

using oi::PacketId;

// The meaning of a packet that is a code; empty if it is a number or bits.
std::string_view code_name(PacketId packet, const oi::SensorValues& values) {
  switch (packet) {
    case PacketId::charging_state: return oi::name(values.charging_state());
    case PacketId::oi_mode: return oi::name(values.mode());
    case PacketId::infrared_byte: return oi::name(values.infrared());
    default: return {};
  }
}

bool is_bit_set(PacketId packet) { return !oi::bit_name(packet, 0).empty(); }

std::vector<std::string_view> bit_names(PacketId packet, std::int32_t raw) {
  std::vector<std::string_view> names;
  for (unsigned bit = 0; bit < 8; ++bit) {
    const std::string_view name = oi::bit_name(packet, bit);
    if ((raw >> bit & 1) != 0) names.push_back(name.empty() ? "unnamed bit" : name);
  }
  return names;
}

const oi::PacketInfo& info(PacketId packet) { return oi::kCreate.packet(packet); }

}  // namespace

std::vector<PacketId> singles(const std::vector<PacketId>& packets) {
  std::vector<PacketId> all;
  for (const PacketId packet : packets) {
    for (std::uint8_t id = info(packet).first; id <= info(packet).last; ++id)
      all.push_back(static_cast<PacketId>(id));
  }
  return all;
}

std::string text(PacketId packet, const oi::SensorValues& values) {
  const std::int32_t raw = values.raw(packet);
  if (const std::string_view name = code_name(packet, values); !name.empty())
    return fmt::format("{} ({})", raw, name);
  if (is_bit_set(packet)) {
    const auto names = bit_names(packet, raw);
    return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
  }
  const std::string_view unit = oi::symbol(info(packet).unit);
  return unit.empty() ? fmt::format("{}", raw) : fmt::format("{} {}", raw, unit);
}

std::string json_line(const std::vector<PacketId>& packets, const oi::SensorValues& values) {
  nlohmann::json out = nlohmann::json::object();
  for (const PacketId packet : singles(packets)) {
    const std::string key{info(packet).key};
    out[key] = values.raw(packet);
    if (const std::string_view name = code_name(packet, values); !name.empty())
      out[key + "_name"] = name;
    if (is_bit_set(packet)) out[key + "_names"] = bit_names(packet, values.raw(packet));
  }
  return out.dump();
}

std::string lines(const std::vector<PacketId>& packets, const oi::SensorValues& values) {
  std::string out;
  for (const PacketId packet : singles(packets)) {
    fmt::format_to(std::back_inserter(out), "{:>3}  {:<40}{}\n", info(packet).id, info(packet).name,
                   text(packet, values));
  }
  return out;
}

}  // namespace cargobay::cli
