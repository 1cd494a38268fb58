#include "hal/columns/records.hpp"
#include "oi/dialect.hpp"
#include "oi/packet_table.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {
namespace {

using oi::PacketId;
using Kind = ColumnInfo::Kind;
using SensorTable = Columns<SensorRecord>;

// Known if the frame has the packet.
void add(SensorTable& table, const ColumnInfo& info, PacketId packet, auto get) {
  table.push_back({info, [packet, get](const SensorRecord& record) -> Value {
                     if (!record.values.has(packet)) return {};
                     return get(record);
                   }});
}

void add_sum(SensorTable& table, PacketId packet, const char* unit,
             std::int64_t SensorRecord::* sum) {
  add(table,
      {std::string{oi::kCreate.packet(packet).key} + "_sum", Kind::whole, unit,
       "Added up since the beginning"},
      packet, [sum](const SensorRecord& record) { return record.*sum; });
  table.back().take = [sum](SensorRecord& record, const Value& value) {
    record.*sum = std::get<std::int64_t>(value);
  };
}

void add_packet(SensorTable& table, const oi::PacketInfo& info) {
  const auto packet = static_cast<PacketId>(info.id);
  const std::string key{info.key};
  const auto raw = [packet](const SensorRecord& record) { return record.values.raw(packet); };
  add(table,
      {key, Kind::whole, std::string{oi::symbol(info.unit)},
       "Packet " + std::to_string(info.id) + ", " + std::string{info.name}},
      packet, [raw](const SensorRecord& record) { return std::int64_t{raw(record)}; });
  table.back().take = [packet](SensorRecord& record, const Value& value) {
    const std::int64_t wide = std::get<std::int64_t>(value);
    if (std::in_range<std::int32_t>(wide))
      record.values.set(packet, static_cast<std::int32_t>(wide));
  };
  if (oi::is_bit_set(packet)) {
    add(table, {key + "_names", Kind::words, "", "The names of its bits that are set"}, packet,
        [packet, raw](const SensorRecord& record) {
          std::vector<std::string_view> names;
          oi::visit_bits(packet, raw(record),
                         [&](std::string_view name) { names.push_back(name); });
          return names;
        });
  } else if (oi::find_named(packet) != nullptr) {
    add(table, {key + "_name", Kind::text, "", "Its meaning"}, packet,
        [packet, raw](const SensorRecord& record) {
          return std::string{oi::code_name(packet, raw(record))};
        });
  }
  if (packet == PacketId::distance) add_sum(table, packet, "mm", &SensorRecord::distance_sum_mm);
  if (packet == PacketId::angle) add_sum(table, packet, "deg", &SensorRecord::angle_sum_deg);
}

SensorTable make_sensor_columns() {
  SensorTable table = stamp_columns<SensorRecord>();
  for (unsigned id = oi::kFirstSinglePacket; id <= oi::kLastPacket; ++id)
    add_packet(table, oi::kCreate.packet(static_cast<PacketId>(id)));
  return table;
}

}  // namespace

const Columns<SensorRecord>& sensor_columns() {
  static const SensorTable kTable = make_sensor_columns();
  return kTable;
}

}  // namespace cargobay::hal
