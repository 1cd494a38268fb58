#include "hal/bring_up/open_pins.hpp"

#include <utility>

namespace cargobay::hal {
namespace {

using gpio::Level;

Result<void> open_pin(const PinSetting& setting, Level released,
                      std::unique_ptr<gpio::Output>& pin) {
  if (!setting.wired() || setting.modem_line()) return {};
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

// What a setting of an output of the port asks for, if it can be had.
Result<PortPin> port_pin(const PinSetting& setting) {
  if (setting.drive != gpio::Drive::push_pull || setting.bias != gpio::Bias::as_is) {
    return Failure{"RTS and DTR have neither open drain nor bias; put a transistor between " +
                       setting.address.line + " and the pin",
                   std::make_error_code(std::errc::invalid_argument)};
  }
  return PortPin{.line = *setting.modem_line(), .polarity = setting.polarity};
}

Result<void> note_port_pins(const PinSettings& settings, OpenPins& pins) {
  if (settings.brc.modem_line()) {
    const auto pin = port_pin(settings.brc);
    if (!pin) return pin.failure();
    pins.brc_of_port = *pin;
  }
  if (!settings.power_toggle.modem_line()) return {};
  const auto pin = port_pin(settings.power_toggle);
  if (!pin) return pin.failure();
  // Opening a port asserts both lines.
  if (pin->polarity == gpio::Polarity::inverted) {
    return Failure{"through an inverter, " + settings.power_toggle.address.line +
                       " would switch the robot on or off each time that the port is opened; wire "
                       "it to the power toggle without one",
                   std::make_error_code(std::errc::invalid_argument)};
  }
  if (pins.brc_of_port && pins.brc_of_port->line == pin->line) {
    return Failure{"BRC and the power toggle are both on " + settings.brc.address.line +
                       " of the port; use the other line for one of them",
                   std::make_error_code(std::errc::invalid_argument)};
  }
  pins.power_toggle_of_port = *pin;
  return {};
}

}  // namespace

std::optional<ByteStream::ModemLine> PinSetting::modem_line() const {
  if (!address.chip.empty()) return std::nullopt;
  if (address.line == "rts" || address.line == "RTS") return ByteStream::ModemLine::rts;
  if (address.line == "dtr" || address.line == "DTR") return ByteStream::ModemLine::dtr;
  return std::nullopt;
}

Result<OpenPins> open_pins(const PinSettings& settings) {
  OpenPins pins;
  if (const auto done = note_port_pins(settings, pins); !done) return done.failure();
  if (const auto done = open_pin(settings.brc, Level::high, pins.brc); !done) return done.failure();
  if (const auto done = open_pin(settings.power_toggle, Level::low, pins.power_toggle); !done)
    return done.failure();
  if (const auto done = open_pin(settings.power_sense, pins.power_sense); !done)
    return done.failure();
  if (const auto done = open_pin(settings.charging, pins.charging); !done) return done.failure();
  return pins;
}

}  // namespace cargobay::hal
