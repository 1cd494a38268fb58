#include "hal/cli/terminal/sensor_format.hpp"

#include <iterator>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "oi/dialect.hpp"
#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

using oi::PacketId;

std::vector<std::string_view> bit_names(PacketId packet, std::int32_t raw) {
  std::vector<std::string_view> names;
  oi::visit_bits(packet, raw, [&](std::string_view name) { names.push_back(name); });
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
  if (const std::string_view name = oi::code_name(packet, raw); !name.empty())
    return fmt::format("{} ({})", raw, name);
  if (oi::is_bit_set(packet)) {
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
    if (const std::string_view name = oi::code_name(packet, values.raw(packet)); !name.empty())
      out[key + "_name"] = name;
    if (oi::is_bit_set(packet)) out[key + "_names"] = bit_names(packet, values.raw(packet));
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
