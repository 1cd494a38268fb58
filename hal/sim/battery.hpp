// The battery and its charging: packets 21 to 26 (OI p. 19).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>

#include "oi/sensors.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

struct BatteryParameters {
  double capacity_mah = 2696.0;
  double charge_mah = 2200.0;
  double temperature_deg_c = 24.0;
  double charging_ma = 1270.0;
  double trickle_ma = 40.0;
};

// What is in the battery compartment (OI p. 19).
enum class BatteryPack : std::uint8_t { rechargeable, alkaline };

constexpr std::string_view name(BatteryPack pack) {
  return pack == BatteryPack::alkaline ? "alkaline" : "rechargeable";
}

// Why a charger does not charge: packet 21 has numbers for it, the manual gives no reasons.
enum class ChargingTrouble : std::uint8_t { none, waiting, fault };

class Battery {
 public:
  explicit Battery(const BatteryParameters& parameters) : parameters_{parameters} {}

  // The robot draws `load_ma`. A charger charges only if it may: Safe and Full end it (OI p. 6).
  void advance(rt::Duration period, double load_ma, bool source, bool may_charge) {
    state_ = source && may_charge ? state_at_source() : oi::ChargingState::not_charging;
    current_ma_ = -load_ma;
    if (charging()) {
      current_ma_ =
          state_ == oi::ChargingState::trickle ? parameters_.trickle_ma : parameters_.charging_ma;
    } else if (source) {
      current_ma_ = 0.0;  // the source carries the load
    }
    const double hours = rt::seconds(period) / 3600.0;
    set_charge_mah(charge_mah() + current_ma_ * hours);
    charging_time_ = charging() ? charging_time_ + period : rt::Duration{0};
  }

  void set_charge_mah(double charge_mah) {
    parameters_.charge_mah = std::clamp(charge_mah, 0.0, capacity_mah());
  }
  // Inserts a full battery.
  void insert(BatteryPack pack) {
    pack_ = pack;
    set_charge_mah(capacity_mah());
  }
  void set_trouble(ChargingTrouble trouble) { trouble_ = trouble; }

  BatteryPack pack() const { return pack_; }
  double charge_mah() const { return parameters_.charge_mah; }
  double capacity_mah() const {
    return pack_ == BatteryPack::alkaline ? kAlkalineMah : parameters_.capacity_mah;
  }
  // Packets 25 and 26. The robot counts down from the capacity of its own pack; with alkaline cells
  // both are wrong, as the manual warns.
  double reported_charge_mah() const {
    return std::max(0.0, reported_capacity_mah() - (capacity_mah() - charge_mah()));
  }
  double reported_capacity_mah() const { return parameters_.capacity_mah; }
  double current_ma() const { return current_ma_; }
  double temperature_deg_c() const { return parameters_.temperature_deg_c; }
  // Twelve cells: from 13.2 V empty to 16.2 V full, alkaline ones from 10.8 V to 18 V, less 0.2 ohm
  // times the current drawn.
  double voltage_mv() const {
    const double part = charge_mah() / capacity_mah();
    const double at_rest_mv =
        pack_ == BatteryPack::alkaline ? 10800.0 + 7200.0 * part : 13200.0 + 3000.0 * part;
    return at_rest_mv + 0.2 * current_ma_;
  }
  oi::ChargingState state() const { return state_; }
  bool charging() const {
    return state_ == oi::ChargingState::reconditioning || state_ == oi::ChargingState::full ||
           state_ == oi::ChargingState::trickle;
  }
  rt::Duration charging_time() const { return charging_time_; }
  bool empty() const { return charge_mah() <= 0.0; }

 private:
  static constexpr double kDeeplyDischarged = 0.02;
  static constexpr double kAlkalineMah = 2000.0;  // twelve AA cells, roughly

  oi::ChargingState state_at_source() const {
    // Cells that cannot be charged are not charged.
    if (trouble_ == ChargingTrouble::fault || pack_ == BatteryPack::alkaline)
      return oi::ChargingState::fault;
    if (trouble_ == ChargingTrouble::waiting) return oi::ChargingState::waiting;
    if (charge_mah() >= capacity_mah()) return oi::ChargingState::trickle;
    return charge_mah() < kDeeplyDischarged * capacity_mah() ? oi::ChargingState::reconditioning
                                                             : oi::ChargingState::full;
  }

  BatteryParameters parameters_;
  BatteryPack pack_ = BatteryPack::rechargeable;
  ChargingTrouble trouble_ = ChargingTrouble::none;
  oi::ChargingState state_ = oi::ChargingState::not_charging;
  double current_ma_ = 0.0;
  rt::Duration charging_time_{0};
};

}  // namespace cargobay::hal::sim
