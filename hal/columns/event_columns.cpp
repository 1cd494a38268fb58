#include "hal/columns/flag_names.hpp"
#include "hal/columns/records.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {
namespace {

using Kind = ColumnInfo::Kind;
using EventTable = Columns<EventRecord>;

// Known for the kinds of events that have this payload.
void add(EventTable& table, const ColumnInfo& info, Payload wanted, auto get) {
  table.push_back({info, [wanted, get](const EventRecord& record) -> Value {
                     if (payload(record.event.what) != wanted) return {};
                     return get(record.event);
                   }});
}

void add_speeds(EventTable& table, const std::string& key, const std::string& meaning,
                Payload wanted, rt::WheelSpeeds Event::* speeds) {
  add(table, {key + ".left", Kind::number, "mm/s", "Left wheel: " + meaning}, wanted,
      [speeds](const Event& event) { return (event.*speeds).left_mm_s; });
  add(table, {key + ".right", Kind::number, "mm/s", "Right wheel: " + meaning}, wanted,
      [speeds](const Event& event) { return (event.*speeds).right_mm_s; });
}

void add_battery(EventTable& table) {
  const auto member = [&](const char* path, const char* unit, const char* meaning,
                          std::int32_t BatteryState::* value) {
    add(table, {path, Kind::whole, unit, meaning}, Payload::battery,
        [value](const Event& event) { return std::int64_t{event.battery.*value}; });
  };
  member("battery.mv", "mV", "Of the battery", &BatteryState::voltage_mv);
  member("battery.charge_mah", "mAh", "Charge of the battery", &BatteryState::charge_mah);
  member("battery.capacity_mah", "mAh", "Its capacity; 0 with ordinary batteries",
         &BatteryState::capacity_mah);
}

void add_wheels(EventTable& table) {
  add(table, {"wheels", Kind::words, "", "Wheels concerned: left, right"}, Payload::wheels,
      [](const Event& event) { return names_of(event.wheels); });
  add(table, {"finding", Kind::text, "", "What is wrong with what they count"}, Payload::wheels,
      [](const Event& event) { return std::string{name(event.finding)}; });
  add_speeds(table, "driven_mm_s", "what one that reaches its command would have done",
             Payload::wheels, &Event::wanted);
  add_speeds(table, "counted_mm_s", "what was counted", Payload::wheels, &Event::got);
  add(table, {"limits", Kind::words, "", "What keeps the wheels from the target"}, Payload::limits,
      [](const Event& event) { return names_of(event.limits); });
  add_speeds(table, "asked_mm_s", "what was asked for", Payload::limits, &Event::wanted);
  add_speeds(table, "given_mm_s", "what it got", Payload::limits, &Event::got);
}

void add_overcurrents(EventTable& table) {
  table.push_back({{"overcurrents", Kind::words, "", "What draws too much current"},
                   [](const EventRecord& record) -> Value {
                     const Payload has = payload(record.event.what);
                     if (has != Payload::overcurrents && has != Payload::wheels) return {};
                     return names_of(record.event.overcurrents);
                   }});
}

void add_head(EventTable& table) {
  table.push_back({{"tick", Kind::whole, "15 ms", "As of the states: the newest then"},
                   [](const EventRecord& record) -> Value { return record.event.tick; }});
  table.push_back(
      {{"robot_time_s", Kind::number, "s", "The robot's time at the tick"},
       [](const EventRecord& record) -> Value { return robot_time_s(record.event.tick); }});
  table.push_back({{"what", Kind::text, "", "Its name"}, [](const EventRecord& record) -> Value {
                     return std::string{name(record.event.what)};
                   }});
  table.push_back({{"text", Kind::text, "", "In words"},
                   [](const EventRecord& record) -> Value { return describe(record.event); }});
}

EventTable make_event_columns() {
  EventTable table = stamp_columns<EventRecord>();
  add_head(table);
  add(table, {"mode", Kind::text, "", "The mode that the robot is in"}, Payload::mode,
      [](const Event& event) { return std::string{oi::name(event.mode)}; });
  add(table, {"hazards", Kind::words, "", "The causes, as far as a sensor shows them"},
      Payload::mode, [](const Event& event) { return names_of(event.hazards); });
  add_battery(table);
  add_overcurrents(table);
  add(table, {"frames", Kind::whole, "", "How many frames"}, Payload::frames,
      [](const Event& event) { return std::int64_t{event.frames}; });
  add(table, {"bumps", Kind::words, "", "Sides of the bumper"}, Payload::bumps,
      [](const Event& event) { return names_of(event.bumps); });
  add_wheels(table);
  add(table, {"process.id", Kind::whole, "", "Its process ID; 0: too brief to be seen"},
      Payload::process, [](const Event& event) { return std::int64_t{event.process}; });
  add(table, {"process.name", Kind::text, "", "The kernel's name for it"}, Payload::process,
      [](const Event& event) { return std::string{event.process_name.data()}; });
  return table;
}

}  // namespace

const Columns<EventRecord>& event_columns() {
  static const EventTable kTable = make_event_columns();
  return kTable;
}

}  // namespace cargobay::hal
