// The battery and its charging: packets 21 to 26 (OI p. 19).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

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

class Battery {
 public:
  explicit Battery(const BatteryParameters& parameters) : parameters_{parameters} {}

  // `load_ma` is drawn; what charges does so only where it may: Safe and Full end it (OI p. 6).
  void advance(rt::Duration period, double load_ma, bool source, bool may_charge) {
    state_ = !source || !may_charge                     ? oi::ChargingState::not_charging
             : charge_mah() >= parameters_.capacity_mah ? oi::ChargingState::trickle
             : charge_mah() < kDeeplyDischarged * parameters_.capacity_mah
                 ? oi::ChargingState::reconditioning
                 : oi::ChargingState::full;
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
    parameters_.charge_mah = std::clamp(charge_mah, 0.0, parameters_.capacity_mah);
  }
  double charge_mah() const { return parameters_.charge_mah; }
  double capacity_mah() const { return parameters_.capacity_mah; }
  double current_ma() const { return current_ma_; }
  double temperature_deg_c() const { return parameters_.temperature_deg_c; }
  // Twelve cells: from 13.2 V empty to 16.2 V full, less 0.2 ohm times what is drawn.
  double voltage_mv() const {
    return 13200.0 + 3000.0 * charge_mah() / capacity_mah() + 0.2 * current_ma_;
  }
  oi::ChargingState state() const { return state_; }
  bool charging() const { return state_ != oi::ChargingState::not_charging; }
  rt::Duration charging_time() const { return charging_time_; }
  bool empty() const { return charge_mah() <= 0.0; }

 private:
  static constexpr double kDeeplyDischarged = 0.02;

  BatteryParameters parameters_;
  oi::ChargingState state_ = oi::ChargingState::not_charging;
  double current_ma_ = 0.0;
  rt::Duration charging_time_{0};
};

}  // namespace cargobay::hal::sim
