// The robot's pins besides its serial lines, each on whatever it is wired to.
#pragma once

#include <optional>
#include <system_error>

#include "gpio/line.hpp"
#include "gpio/pin.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

// A pin on an output of the port itself, as USB cables have them.
struct PortPin {
  ByteStream::ModemLine line = ByteStream::ModemLine::rts;
  gpio::Polarity polarity = gpio::Polarity::direct;
};

// Null or empty if not wired. The objects are borrowed for the call.
struct RobotPins {
  gpio::Output* brc = nullptr;           // pin 15 of the cargo bay, 5 of the mini-DIN; high at rest
  gpio::Output* power_toggle = nullptr;  // pin 3; low at rest
  gpio::Input* power_sense = nullptr;    // switched 5 V, pin 8: high while the robot is on
  gpio::Input* charging = nullptr;       // pin 13: high while it charges
  // Instead of `brc` and `power_toggle`.
  std::optional<PortPin> brc_of_port{};
  std::optional<PortPin> power_toggle_of_port{};

  bool any_of_port() const { return brc_of_port || power_toggle_of_port; }
};

// RTS or DTR of a stream as an output: asserted is low at the cable.
class PortOutput final : public gpio::Output {
 public:
  // `stream` outlives it.
  PortOutput(ByteStream& stream, PortPin pin) : stream_{stream}, pin_{pin} {}
  // One system call.
  std::error_code set(gpio::Level level) override {
    const bool low_at_cable =
        (level == gpio::Level::low) == (pin_.polarity == gpio::Polarity::direct);
    return stream_.set_modem_line(pin_.line, low_at_cable);
  }

 private:
  ByteStream& stream_;
  PortPin pin_;
};

// The pins during one conversation over `stream`. Borrows both.
class BoundPins {
 public:
  BoundPins(const RobotPins& pins, ByteStream& stream);
  ~BoundPins() = default;
  BoundPins(const BoundPins&) = delete;
  BoundPins& operator=(const BoundPins&) = delete;

  // Brings those of the port to their levels at rest: opening a port asserts both lines. Those of a
  // GPIO chip have theirs from the request on.
  [[nodiscard]] std::error_code release();

  gpio::Output* brc() { return brc_ ? &*brc_ : pins_.brc; }
  gpio::Output* power_toggle() { return power_toggle_ ? &*power_toggle_ : pins_.power_toggle; }
  bool has_brc() const { return brc_ || pins_.brc != nullptr; }
  bool has_power_toggle() const { return power_toggle_ || pins_.power_toggle != nullptr; }
  bool has_power_sense() const { return pins_.power_sense != nullptr; }
  // Nothing if it is not wired, or cannot be read.
  std::optional<gpio::Level> power_sense() const { return look(pins_.power_sense); }
  std::optional<gpio::Level> charging() const { return look(pins_.charging); }

 private:
  static std::optional<gpio::Level> look(gpio::Input* pin) {
    return pin == nullptr ? std::nullopt : pin->level();
  }

  const RobotPins& pins_;
  std::optional<PortOutput> brc_{};
  std::optional<PortOutput> power_toggle_{};
};

}  // namespace cargobay::hal
