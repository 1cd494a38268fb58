#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <concepts>

#include "hal/columns/flag_names.hpp"
#include "hal/columns/records.hpp"
#include "oi/limits.hpp"
#include "oi/value_names.hpp"
#include "rt/remainder.hpp"

namespace cargobay::hal {
namespace {

using Kind = ColumnInfo::Kind;
using StateTable = Columns<StateRecord>;

struct BeliefName {
  rt::RemainderBelief belief;
  std::string_view name;
};
constexpr auto kBeliefs = std::to_array<BeliefName>({{rt::RemainderBelief::unknown, "unknown"},
                                                     {rt::RemainderBelief::carried, "carried"},
                                                     {rt::RemainderBelief::lost, "lost"}});

Value value_of(bool truth) { return truth; }
Value value_of(double number) { return number; }
Value value_of(std::integral auto number) { return std::int64_t{number}; }

void put_into(bool& truth, const Value& value) { truth = std::get<bool>(value); }
void put_into(double& number, const Value& value) { number = std::get<double>(value); }
template <std::signed_integral Number>
void put_into(Number& number, const Value& value) {
  const std::int64_t wide = std::get<std::int64_t>(value);
  if (std::in_range<Number>(wide)) number = static_cast<Number>(wide);
}

// `in` gives the member of a state that the column is.
void add(StateTable& table, const ColumnInfo& info, auto in) {
  table.push_back(
      {info, [in](const StateRecord& record) -> Value { return value_of(in(record.state)); },
       [in](StateRecord& record, const Value& value) { put_into(in(record.state), value); }});
}
// One that is known of a whole state.
void add_whole(StateTable& table, const ColumnInfo& info, auto in) {
  table.push_back(
      {info,
       [in](const StateRecord& record) -> Value {
         if (record.extent != StateRecord::Extent::whole) return {};
         return value_of(in(record.state));
       },
       [in](StateRecord& record, const Value& value) { put_into(in(record.state), value); }});
}
// One that follows from others.
void add_made(StateTable& table, const ColumnInfo& info, auto get) {
  table.push_back(
      {info, [get](const StateRecord& record) -> Value { return get(record); }, nullptr});
}
// The names of flags, known of a whole state.
template <typename Flag>
void add_names(StateTable& table, const std::string& path, const std::string& meaning,
               oi::BitSet<Flag> CycleState::* flags) {
  table.push_back({{path, Kind::words, "", meaning},
                   [flags](const StateRecord& record) -> Value {
                     if (record.extent != StateRecord::Extent::whole) return {};
                     return names_of(record.state.*flags);
                   },
                   [flags](StateRecord& record, const Value& value) {
                     record.state.*flags = flags_named<Flag>(value);
                   }});
}

void add_wheels(StateTable& table, const std::string& key, const std::string& meaning,
                rt::WheelSpeeds CycleState::* speeds) {
  add(table, {key + ".left", Kind::number, "mm/s", "Left wheel: " + meaning},
      [speeds](auto& state) -> auto& { return (state.*speeds).left_mm_s; });
  add(table, {key + ".right", Kind::number, "mm/s", "Right wheel: " + meaning},
      [speeds](auto& state) -> auto& { return (state.*speeds).right_mm_s; });
}

void add_time(StateTable& table) {
  add(table,
      {"tick", Kind::whole, "15 ms",
       "Of the robot, since the first frame. The same as before if this frame had been given up, "
       "and came after all"},
      [](auto& state) -> auto& { return state.tick; });
  add_made(table, {"robot_time_s", Kind::number, "s", "The robot's time at the tick"},
           [](const StateRecord& record) { return robot_time_s(record.state.tick); });
}

void add_mode(StateTable& table) {
  table.push_back(
      {{"mode", Kind::text, "", "off, passive, safe or full"},
       [](const StateRecord& record) { return std::string{oi::name(record.state.mode)}; },
       [](StateRecord& record, const Value& value) {
         if (const auto mode = oi::value_named<oi::Mode>(std::get<std::string>(value)))
           record.state.mode = *mode;
       }});
}

void add_speeds(StateTable& table) {
  add_wheels(table, "target_mm_s", "the speed that was asked for; 0 if nothing valid was",
             &CycleState::target);
  add_wheels(table, "set_mm_s", "the target after the limits of acceleration and jerk",
             &CycleState::set);
  add_wheels(table, "estimate_mm_s", "estimated true speed", &CycleState::estimate);
  add_wheels(table, "command_mm_s", "as sent to the robot", &CycleState::command);
  add_made(table, {"velocity_mm_s", Kind::number, "mm/s", "Forward speed, of the estimate"},
           [](const StateRecord& record) {
             const rt::WheelSpeeds& speeds = record.state.estimate;
             return (speeds.left_mm_s + speeds.right_mm_s) / 2.0;
           });
  add_made(
      table,
      {"turn_rate_rad_s", Kind::number, "rad/s", "Turn rate of the estimate, counter-clockwise"},
      [](const StateRecord& record) {
        const rt::WheelSpeeds& speeds = record.state.estimate;
        return (speeds.right_mm_s - speeds.left_mm_s) / record.wheel_base_mm;
      });
}

void add_pose(StateTable& table) {
  add_whole(table, {"pose.x_mm", Kind::number, "mm", "Odometry: ahead at heading 0"},
            [](auto& state) -> auto& { return state.pose.x_mm; });
  add_whole(table, {"pose.y_mm", Kind::number, "mm", "Odometry: to the left of that"},
            [](auto& state) -> auto& { return state.pose.y_mm; });
  add_whole(table,
            {"pose.heading_rad", Kind::number, "rad", "Odometry: counter-clockwise, not wrapped"},
            [](auto& state) -> auto& { return state.pose.heading_rad; });
  add_whole(table,
            {"distance_mm", Kind::number, "mm", "Travelled; driving backwards counts negative"},
            [](auto& state) -> auto& { return state.distance_mm; });
  struct Entry {
    const char* name;
    const char* unit;
    const char* meaning;
    double rt::PoseCovariance::* value;
  };
  using Covariance = rt::PoseCovariance;
  for (const Entry& entry :
       {Entry{"xx_mm2", "mm^2", "variance of x", &Covariance::xx},
        Entry{"xy_mm2", "mm^2", "covariance of x and y", &Covariance::xy},
        Entry{"xh_mm_rad", "mm rad", "of x and heading", &Covariance::xh},
        Entry{"yy_mm2", "mm^2", "variance of y", &Covariance::yy},
        Entry{"yh_mm_rad", "mm rad", "of y and heading", &Covariance::yh},
        Entry{"hh_rad2", "rad^2", "variance of the heading", &Covariance::hh}}) {
    add_whole(table,
              {std::string{"covariance."} + entry.name, Kind::number, entry.unit,
               std::string{"Of the pose: "} + entry.meaning},
              [value = entry.value](auto& state) -> auto& { return state.pose_covariance.*value; });
  }
}

void add_reading(StateTable& table, const char* path, const char* unit,
                 std::optional<int> rt::WheelEstimator::Reading::* counter) {
  table.push_back({{path, Kind::whole, unit, "Counter, if this frame reads it"},
                   [counter](const StateRecord& record) -> Value {
                     const std::optional<int>& read = record.state.reading.*counter;
                     if (record.extent != StateRecord::Extent::whole || !read) return {};
                     return std::int64_t{*read};
                   },
                   [counter](StateRecord& record, const Value& value) {
                     put_into((record.state.reading.*counter).emplace(), value);
                   }});
}

void add_sensed(StateTable& table) {
  add_names(table, "hazards", "What this frame reports of them", &CycleState::hazards);
  add_names(table, "bumps", "Sides of the bumper, as last reported", &CycleState::bumps);
  add_names(table, "limits", "What keeps the wheels from the target", &CycleState::limits);
  add_reading(table, "reading.distance_mm", "mm", &rt::WheelEstimator::Reading::distance_mm);
  add_reading(table, "reading.angle_deg", "deg", &rt::WheelEstimator::Reading::angle_deg);
  table.push_back(
      {{"battery_mv", Kind::whole, "mV", "As last reported"},
       [](const StateRecord& record) -> Value {
         if (record.state.battery_mv == 0) return {};  // not yet
         return std::int64_t{record.state.battery_mv};
       },
       [](StateRecord& record, const Value& value) { put_into(record.state.battery_mv, value); }});
}

void add_remainder(StateTable& table) {
  table.push_back({{"remainder", Kind::text, "",
                    "The kind of robot as far as it is known: carried, lost or unknown"},
                   [](const StateRecord& record) -> Value {
                     const auto* const found =
                         std::ranges::find(kBeliefs, record.state.remainder, &BeliefName::belief);
                     if (found == kBeliefs.end()) return {};
                     return std::string{found->name};
                   },
                   [](StateRecord& record, const Value& value) {
                     const auto* const found = std::ranges::find(
                         kBeliefs, std::get<std::string>(value), &BeliefName::name);
                     if (found != kBeliefs.end()) record.state.remainder = found->belief;
                   }});
}

StateTable make_state_columns() {
  StateTable table = stamp_columns<StateRecord>();
  add_time(table);
  add_mode(table);
  add_speeds(table);
  add_pose(table);
  add_sensed(table);
  add_remainder(table);
  add(table, {"setpoint_lapsed", Kind::truth, "", "Nothing steers: it was not renewed in time"},
      [](auto& state) -> auto& { return state.setpoint_lapsed; });
  return table;
}

}  // namespace

double robot_time_s(std::int64_t tick) {
  static_assert(oi::kTick % std::chrono::milliseconds{1} == std::chrono::nanoseconds{0});
  constexpr std::int64_t kTickMs = oi::kTick / std::chrono::milliseconds{1};
  return static_cast<double>(tick * kTickMs) / 1000.0;
}

// In two parts: all of it in nanoseconds is more than a double holds.
std::int64_t unix_ns(double unix_time_s) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  constexpr double kMostSeconds = 4e9;
  if (!(unix_time_s >= 0.0 && unix_time_s < kMostSeconds)) return 0;
  const double whole_s = std::floor(unix_time_s);
  return std::llround(whole_s) * kSecond + std::llround((unix_time_s - whole_s) * 1e9);
}

const Columns<StateRecord>& state_columns() {
  static const StateTable kTable = make_state_columns();
  return kTable;
}

}  // namespace cargobay::hal
