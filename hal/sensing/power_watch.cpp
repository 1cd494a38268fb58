#include "hal/sensing/power_watch.hpp"

namespace cargobay::hal {
namespace {

// A battery that waits to be charged, or cannot be, does not count as charging.
bool charges(const BatteryState& battery) CARGOBAY_NONBLOCKING {
  using oi::ChargingState;
  return battery.charging == ChargingState::reconditioning ||
         battery.charging == ChargingState::full || battery.charging == ChargingState::trickle;
}

}  // namespace

const PowerWatch::News& PowerWatch::see(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  news_.clear();
  if (frame.has(oi::PacketId::overcurrents)) see_overcurrents(frame.overcurrents());
  if (frame.has(oi::PacketId::battery_charge)) {
    see_battery({.voltage_mv = frame.raw(oi::PacketId::voltage),
                 .charge_mah = frame.raw(oi::PacketId::battery_charge),
                 .capacity_mah = frame.raw(oi::PacketId::battery_capacity),
                 .charging = frame.charging_state()});
  }
  return news_;
}

void PowerWatch::see_overcurrents(oi::BitSet<oi::Overcurrent> now) CARGOBAY_NONBLOCKING {
  const oi::BitSet<oi::Overcurrent> begun{
      static_cast<std::uint8_t>(now.raw() & ~overcurrents_.raw())};
  const bool ended = overcurrents_.any() && !now.any();
  overcurrents_ = now;
  if (begun.any()) {
    (void)news_.push_back({.what = EventKind::overcurrent_began, .overcurrents = begun});
  } else if (ended) {
    (void)news_.push_back({.what = EventKind::overcurrent_ended});
  }  // has room for one from each watch: kMostNews
}

void PowerWatch::see_battery(const BatteryState& now) CARGOBAY_NONBLOCKING {
  if (charges(now) != charges(battery_)) {
    const EventKind what = charges(now) ? EventKind::charging_began : EventKind::charging_ended;
    (void)news_.push_back({.what = what, .battery = now});
  }
  battery_ = now;
  const bool otherwise = low_ ? has_recovered(now) : is_low(now);
  otherwise_ = otherwise ? otherwise_ + 1 : 0;
  if (otherwise_ < kReadings) return;
  low_ = !low_;
  otherwise_ = 0;
  (void)news_.push_back(
      {.what = low_ ? EventKind::battery_low : EventKind::battery_recovered, .battery = now});
}

bool PowerWatch::is_low(const BatteryState& battery) const CARGOBAY_NONBLOCKING {
  return battery.voltage_mv < limits_.low_mv ||
         battery.charge_mah < limits_.low_part * battery.capacity_mah;
}

bool PowerWatch::has_recovered(const BatteryState& battery) const CARGOBAY_NONBLOCKING {
  return battery.voltage_mv > limits_.recovered_mv &&
         battery.charge_mah >= limits_.recovered_part * battery.capacity_mah;
}

}  // namespace cargobay::hal
