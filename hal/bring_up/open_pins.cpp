#include "hal/bring_up/open_pins.hpp"

#include <array>
#include <utility>

namespace cargobay::hal {
namespace {

using gpio::Level;

Result<void> open_pin(const PinSetting& setting, Level released,
                      std::unique_ptr<gpio::Output>& pin) {
  if (!setting.wired()) return {};
  gpio::LineError error;
  pin = gpio::open_output(setting.address,
                          {.released = released,
                           .polarity = setting.polarity,
                           .drive = setting.drive,
                           .bias = setting.bias},
                          error);
  if (pin) return {};
  return Failure{gpio::explain(error), {error.error, std::generic_category()}};
}

Result<void> open_pin(const PinSetting& setting, std::unique_ptr<gpio::Input>& pin) {
  if (!setting.wired()) return {};
  gpio::LineError error;
  pin = gpio::open_input(setting.address, {.polarity = setting.polarity, .bias = setting.bias},
                         error);
  if (pin) return {};
  return Failure{gpio::explain(error), {error.error, std::generic_category()}};
}

}  // namespace

Result<OpenPins> open_pins(const PinSettings& settings) {
  OpenPins pins;
  if (const auto done = open_pin(settings.brc, Level::high, pins.brc); !done) return done.failure();
  if (const auto done = open_pin(settings.power_toggle, Level::low, pins.power_toggle); !done)
    return done.failure();
  if (const auto done = open_pin(settings.power_sense, pins.power_sense); !done)
    return done.failure();
  if (const auto done = open_pin(settings.charging, pins.charging); !done) return done.failure();
  return pins;
}

}  // namespace cargobay::hal
