// What others can read of a drive, while it goes on and afterwards: a state for each frame, the
// sensors that the frame carried, the events, and the commands that were sent. Each kind has its
// table of columns.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "hal/columns/columns.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/sensing/events.hpp"
#include "oi/sensors.hpp"

namespace cargobay::hal {

// When it was.
struct Stamp {
  std::int64_t unix_ns = 0;  // since 1970 UTC; 0: not known
  // Since the beginning, by a clock that is not set meanwhile.
  double time_s = std::numeric_limits<double>::quiet_NaN();
};

struct StateRecord {
  // What of the state is known.
  enum class Extent : std::uint8_t {
    recorded,  // the fields that a recording keeps
    whole,     // all of it
  };
  Stamp stamp{};
  CycleState state{};
  Extent extent = Extent::whole;
  double wheel_base_mm = 0.0;  // of the robot, as the loop has it
};

struct SensorRecord {
  Stamp stamp{};
  oi::SensorValues values{};  // those that the frame has
  std::int64_t distance_sum_mm = 0;
  std::int64_t angle_sum_deg = 0;
};

struct EventRecord {
  Stamp stamp{};
  Event event{};
};

struct CommandRecord {
  Stamp stamp{};
  std::span<const std::uint8_t> bytes{};  // one whole command, or what is none
};

// Of the robot, since the first frame. In whole milliseconds, which have few digits.
double robot_time_s(std::int64_t tick);
// Of a time in seconds since 1970; 0 if it is none of ours.
std::int64_t unix_ns(double unix_time_s);

// Tables that are made once. Any thread.
const Columns<StateRecord>& state_columns();
const Columns<SensorRecord>& sensor_columns();
const Columns<EventRecord>& event_columns();
const Columns<CommandRecord>& command_columns();

enum class Topic : std::uint8_t { states, sensors, events, commands };
inline constexpr std::size_t kTopics = 4;
std::string_view name(Topic topic);  // "states"
const TopicInfo& info(Topic topic);

// The columns that all records begin with.
template <typename Record>
Columns<Record> stamp_columns() {
  constexpr auto kNumber = ColumnInfo::Kind::number;
  Columns<Record> columns;
  columns.push_back({{"unix_time_s", kNumber, "s", "When it was, since 1970 UTC"},
                     [](const Record& record) -> Value {
                       if (record.stamp.unix_ns == 0) return {};
                       return static_cast<double>(record.stamp.unix_ns) / 1e9;
                     },
                     [](Record& record, const Value& value) {
                       record.stamp.unix_ns = unix_ns(std::get<double>(value));
                     }});
  columns.push_back(
      {{"time_s", kNumber, "s",
        "The same, since the beginning, by a clock that is not set meanwhile"},
       [](const Record& record) -> Value { return record.stamp.time_s; },
       [](Record& record, const Value& value) { record.stamp.time_s = std::get<double>(value); }});
  return columns;
}

}  // namespace cargobay::hal
