// What a signal is played on and read from: a GPIO line, or a pin of the virtual Create.
#pragma once

#include <optional>
#include <system_error>

#include "gpio/pulse_train.hpp"

namespace cargobay::gpio {

// Levels are those at the robot's pin, whatever is between it and the line.
class Output {
 public:
  Output() = default;
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  virtual ~Output() = default;
  // Returns at once. After an error the pin's level is unknown.
  [[nodiscard]] virtual std::error_code set(Level level) = 0;
};

class Input {
 public:
  Input() = default;
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  virtual ~Input() = default;
  // Returns at once; nothing if the level cannot be read.
  virtual std::optional<Level> level() = 0;
};

}  // namespace cargobay::gpio
