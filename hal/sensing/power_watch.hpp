// Battery, charger and overcurrents: reports each change once.
#pragma once

#include "hal/sensing/events.hpp"
#include "oi/fixed_list.hpp"
#include "oi/sensors.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// One thread; no clock, no allocation.
class PowerWatch {
 public:
  // Low below either of the low limits; recovered above both of the others. A robot with ordinary
  // batteries in its holder knows no capacity: then the voltage alone decides.
  struct Limits {
    std::int32_t low_mv = 13'200;  // 1.1 V for each of twelve cells
    std::int32_t recovered_mv = 13'800;
    double low_part = 0.10;  // of the capacity
    double recovered_part = 0.15;
  };
  // This many readings in a row, about a second apart: wheels that start pull the voltage down for
  // a moment.
  static constexpr int kReadings = 3;
  static constexpr std::size_t kMostNews = 4;
  using News = oi::FixedList<Event, kMostNews>;  // without tick and time

  explicit PowerWatch(const Limits& limits) : limits_{limits} {}

  // Call for each frame. Returns what to report; valid until the next call.
  const News& see(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING;
  // Those of the last frame that has them.
  oi::BitSet<oi::Overcurrent> overcurrents() const CARGOBAY_NONBLOCKING { return overcurrents_; }
  // All 0 until the first frame that has them.
  const BatteryState& battery() const CARGOBAY_NONBLOCKING { return battery_; }

 private:
  void see_overcurrents(oi::BitSet<oi::Overcurrent> now) CARGOBAY_NONBLOCKING;
  void see_battery(const BatteryState& now) CARGOBAY_NONBLOCKING;
  bool is_low(const BatteryState& battery) const CARGOBAY_NONBLOCKING;
  bool has_recovered(const BatteryState& battery) const CARGOBAY_NONBLOCKING;

  Limits limits_;
  BatteryState battery_{};
  bool low_ = false;
  int otherwise_ = 0;  // readings in a row that contradict low_
  oi::BitSet<oi::Overcurrent> overcurrents_{};
  News news_{};
};

}  // namespace cargobay::hal
