// The lines that lead to the robot's pins: of a GPIO chip, or of the port itself.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "gpio/line.hpp"
#include "hal/bring_up/robot_pins.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

struct PinSetting {
  gpio::LineAddress address{};
  gpio::Polarity polarity = gpio::Polarity::direct;
  gpio::Drive drive = gpio::Drive::push_pull;  // of an output
  gpio::Bias bias = gpio::Bias::as_is;

  bool wired() const { return !address.line.empty(); }
  // The line "rts" or "dtr" without a chip is that output of the robot's own port.
  std::optional<ByteStream::ModemLine> modem_line() const;
};

struct PinSettings {
  PinSetting brc{};
  PinSetting power_toggle{};
  PinSetting power_sense{};
  PinSetting charging{};
};

// The lines, held until this is destroyed; then each output is released.
struct OpenPins {
  std::unique_ptr<gpio::Output> brc{};
  std::unique_ptr<gpio::Output> power_toggle{};
  std::unique_ptr<gpio::Input> power_sense{};
  std::unique_ptr<gpio::Input> charging{};
  std::optional<PortPin> brc_of_port{};
  std::optional<PortPin> power_toggle_of_port{};

  // Valid as long as this object.
  RobotPins pins() const {
    return {.brc = brc.get(),
            .power_toggle = power_toggle.get(),
            .power_sense = power_sense.get(),
            .charging = charging.get(),
            .brc_of_port = brc_of_port,
            .power_toggle_of_port = power_toggle_of_port};
  }
};

// Opens those that are wired to a GPIO chip; those of the port are only noted. After a
// failure none is held. Blocks for a few ms; allocates.
Result<OpenPins> open_pins(const PinSettings& settings);

}  // namespace cargobay::hal
