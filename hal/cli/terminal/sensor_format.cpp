#include "hal/cli/terminal/sensor_format.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include <fmt/format.h>

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
    for (std::uint8_t id = info(packet).first; id <= info(packet).last; ++id) {
      const auto single = static_cast<PacketId>(id);
      if (std::ranges::find(all, single) == all.end()) all.push_back(single);
    }
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

JsonLine::JsonLine(const std::vector<PacketId>& packets) : packets_{singles(packets)} {}

std::string JsonLine::of(const hal::SensorRecord& record) const {
  hal::SensorRecord chosen = record;
  chosen.values.clear();
  for (const PacketId packet : packets_) {
    if (record.values.has(packet)) chosen.values.set(packet, record.values.raw(packet));
  }
  std::string out;
  out.reserve(std::size_t{1} << 11U);
  hal::append_json(out, hal::sensor_columns(), chosen);
  return out;
}

std::string lines(const std::vector<PacketId>& packets, const oi::SensorValues& values) {
  std::string out;
  for (const PacketId packet : singles(packets)) {
    if (!values.has(packet)) continue;
    fmt::format_to(std::back_inserter(out), "{:>3}  {:<40}{}\n", info(packet).id, info(packet).name,
                   text(packet, values));
  }
  return out;
}

}  // namespace cargobay::cli
