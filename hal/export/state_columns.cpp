#include <chrono>

#include "hal/export/records.hpp"
#include "oi/limits.hpp"
#include "oi/value_names.hpp"
#include "rt/remainder.hpp"

namespace cargobay::hal {
namespace {

using Kind = ColumnInfo::Kind;
using StateTable = Columns<StateRecord>;

std::string remainder_name(rt::RemainderBelief belief) {
  switch (belief) {
    case rt::RemainderBelief::unknown: break;
    case rt::RemainderBelief::carried: return "carried";
    case rt::RemainderBelief::lost: return "lost";
  }
  return "unknown";
}

// A column that every recording has.
void add(StateTable& table, const ColumnInfo& info, auto get) {
  table.push_back({info, [get](const StateRecord& record) -> Value { return get(record); }});
}
// One that is known of a whole state.
void add_whole(StateTable& table, const ColumnInfo& info, auto get) {
  table.push_back({info, [get](const StateRecord& record) -> Value {
                     if (record.extent != StateRecord::Extent::whole) return {};
                     return get(record.state);
                   }});
}

void add_wheels(StateTable& table, const std::string& key, const std::string& meaning,
                rt::WheelSpeeds CycleState::* speeds) {
  add(table, {key + ".left", Kind::number, "mm/s", "Left wheel: " + meaning},
      [speeds](const StateRecord& record) { return (record.state.*speeds).left_mm_s; });
  add(table, {key + ".right", Kind::number, "mm/s", "Right wheel: " + meaning},
      [speeds](const StateRecord& record) { return (record.state.*speeds).right_mm_s; });
}

void add_time(StateTable& table) {
  add(table, {"tick", Kind::whole, "15 ms", "Of the robot, since the first frame"},
      [](const StateRecord& record) { return record.state.tick; });
  add(table, {"robot_time_s", Kind::number, "s", "The robot's time at the tick"},
      [](const StateRecord& record) {
        return static_cast<double>(record.state.tick) * rt::seconds(oi::kTick);
      });
}

void add_speeds(StateTable& table) {
  add_wheels(table, "target_mm_s", "the speed that was asked for; 0 if nothing valid was",
             &CycleState::target);
  add_wheels(table, "set_mm_s", "the target after the limits of acceleration and jerk",
             &CycleState::set);
  add_wheels(table, "estimate_mm_s", "estimated true speed", &CycleState::estimate);
  add_wheels(table, "command_mm_s", "as sent to the robot", &CycleState::command);
  add(table, {"velocity_mm_s", Kind::number, "mm/s", "Forward speed, of the estimate"},
      [](const StateRecord& record) {
        const rt::WheelSpeeds& speeds = record.state.estimate;
        return (speeds.left_mm_s + speeds.right_mm_s) / 2.0;
      });
  add(table,
      {"turn_rate_rad_s", Kind::number, "rad/s", "Turn rate of the estimate, counter-clockwise"},
      [](const StateRecord& record) {
        const rt::WheelSpeeds& speeds = record.state.estimate;
        return (speeds.right_mm_s - speeds.left_mm_s) / record.wheel_base_mm;
      });
}

void add_pose(StateTable& table) {
  add_whole(table, {"x_mm", Kind::number, "mm", "Odometry: ahead at heading 0"},
            [](const CycleState& state) { return state.pose.x_mm; });
  add_whole(table, {"y_mm", Kind::number, "mm", "Odometry: to the left of that"},
            [](const CycleState& state) { return state.pose.y_mm; });
  add_whole(table, {"heading_rad", Kind::number, "rad", "Odometry: counter-clockwise, not wrapped"},
            [](const CycleState& state) { return state.pose.heading_rad; });
  add_whole(table,
            {"distance_mm", Kind::number, "mm", "Travelled; driving backwards counts negative"},
            [](const CycleState& state) { return state.distance_mm; });
  struct Entry {
    const char* name;
    const char* unit;
    const char* meaning;
    double rt::PoseCovariance::* value;
  };
  using Covariance = rt::PoseCovariance;
  for (const Entry& entry : {Entry{"xx", "mm^2", "variance of x", &Covariance::xx},
                             Entry{"xy", "mm^2", "covariance of x and y", &Covariance::xy},
                             Entry{"xh", "mm rad", "of x and heading", &Covariance::xh},
                             Entry{"yy", "mm^2", "variance of y", &Covariance::yy},
                             Entry{"yh", "mm rad", "of y and heading", &Covariance::yh},
                             Entry{"hh", "rad^2", "variance of the heading", &Covariance::hh}}) {
    add_whole(table,
              {std::string{"covariance."} + entry.name, Kind::number, entry.unit,
               std::string{"Of the pose: "} + entry.meaning},
              [entry](const CycleState& state) { return state.pose_covariance.*entry.value; });
  }
}

void add_sensed(StateTable& table) {
  add_whole(table, {"hazards", Kind::words, "", "What this frame reports of them"},
            [](const CycleState& state) { return names(state.hazards); });
  add_whole(table, {"bumps", Kind::words, "", "Sides of the bumper, as last reported"},
            [](const CycleState& state) { return names(state.bumps); });
  add_whole(table, {"limits", Kind::words, "", "What keeps the wheels from the target"},
            [](const CycleState& state) { return names(state.limits); });
  const auto read = [](const std::optional<int>& counter) -> Value {
    return counter ? Value{std::int64_t{*counter}} : Value{};
  };
  add_whole(table, {"reading.distance_mm", Kind::whole, "mm", "Counter, if this frame reads it"},
            [read](const CycleState& state) { return read(state.reading.distance_mm); });
  add_whole(table, {"reading.angle_deg", Kind::whole, "deg", "Counter, if this frame reads it"},
            [read](const CycleState& state) { return read(state.reading.angle_deg); });
  add(table, {"battery_mv", Kind::whole, "mV", "As last reported; 0: not yet"},
      [](const StateRecord& record) { return std::int64_t{record.state.battery_mv}; });
}

StateTable make_state_columns() {
  StateTable table = stamp_columns<StateRecord>();
  add_time(table);
  add(table, {"mode", Kind::text, "", "off, passive, safe or full"},
      [](const StateRecord& record) { return std::string{oi::name(record.state.mode)}; });
  add_speeds(table);
  add_pose(table);
  add_sensed(table);
  add(table,
      {"remainder", Kind::text, "",
       "The kind of robot as far as it is known: carried, lost or unknown"},
      [](const StateRecord& record) { return remainder_name(record.state.remainder); });
  add(table, {"setpoint_lapsed", Kind::truth, "", "Nothing steers: it was not renewed in time"},
      [](const StateRecord& record) { return record.state.setpoint_lapsed; });
  return table;
}

}  // namespace

const Columns<StateRecord>& state_columns() {
  static const StateTable kTable = make_state_columns();
  return kTable;
}

}  // namespace cargobay::hal
