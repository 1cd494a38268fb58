#include "hal/bring_up/robot_pins.hpp"

namespace cargobay::hal {

BoundPins::BoundPins(const RobotPins& pins, ByteStream& stream) : pins_{pins} {
  if (pins.brc_of_port) brc_.emplace(stream, *pins.brc_of_port);
  if (pins.power_toggle_of_port) power_toggle_.emplace(stream, *pins.power_toggle_of_port);
}

std::error_code BoundPins::release() {
  if (brc_) {
    if (const std::error_code error = brc_->set(gpio::Level::high)) return error;
  }
  return power_toggle_ ? power_toggle_->set(gpio::Level::low) : std::error_code{};
}

}  // namespace cargobay::hal
