// The virtual Create's pins as GPIO lines: a bring-up that plays pulses on a Pi's lines plays them
// into the robot.
#pragma once

#include <functional>
#include <utility>

#include "gpio/pin.hpp"
#include "hal/sim/robot/device.hpp"

namespace cargobay::hal::sim {

// Runs a change on the robot in its present state: Server::with_device, or the device itself.
using DeviceAccess = std::function<void(const std::function<void(Device&)>&)>;

class Pins {
 public:
  // Everything that `access` uses outlives the pins.
  explicit Pins(const DeviceAccess& access)
      : brc{access}, power_toggle{access}, power_sense{access}, charging{access} {}

  // Pin 15, Baud Rate Change.
  class Brc final : public gpio::Output {
   public:
    explicit Brc(DeviceAccess access) : access_{std::move(access)} {}
    std::error_code set(gpio::Level level) override {
      access_([level](Device& device) { device.set_brc(level == gpio::Level::high); });
      return {};
    }

   private:
    DeviceAccess access_;
  };
  // Pin 3, power control toggle.
  class PowerToggle final : public gpio::Output {
   public:
    explicit PowerToggle(DeviceAccess access) : access_{std::move(access)} {}
    std::error_code set(gpio::Level level) override {
      access_([level](Device& device) { device.set_power_toggle(level == gpio::Level::high); });
      return {};
    }

   private:
    DeviceAccess access_;
  };
  // Pin 8, switched 5 V.
  class PowerSense final : public gpio::Input {
   public:
    explicit PowerSense(DeviceAccess access) : access_{std::move(access)} {}
    std::optional<gpio::Level> level() override {
      bool on = false;
      access_([&on](Device& device) { on = device.power() != Power::off; });
      return on ? gpio::Level::high : gpio::Level::low;
    }

   private:
    DeviceAccess access_;
  };
  // Pin 13, robot charging.
  class Charging final : public gpio::Input {
   public:
    explicit Charging(DeviceAccess access) : access_{std::move(access)} {}
    std::optional<gpio::Level> level() override {
      bool on = false;
      access_([&on](Device& device) { on = device.battery().charging(); });
      return on ? gpio::Level::high : gpio::Level::low;
    }

   private:
    DeviceAccess access_;
  };

  Brc brc;
  PowerToggle power_toggle;
  PowerSense power_sense;
  Charging charging;
};

}  // namespace cargobay::hal::sim
