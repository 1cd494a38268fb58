// GPIO lines of the kernel, by chip label or name, never by a chip's number: numbers change with
// the kernel. The same over libgpiod 1.6 (line_v1.cpp) and 2.x (line_v2.cpp). None of this is for
// the control thread. Each object belongs to one thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gpio/pin.hpp"

namespace cargobay::gpio {

// The name under which the kernel lists us as the holder of a line.
inline constexpr const char* kConsumer = "cargobay";

struct LineAddress {
  // The chip's label ("pinctrl-bcm2835"), name ("gpiochip0") or path. Empty: the one chip that has
  // a line of that name.
  std::string chip{};
  std::string line{};  // the line's name ("GPIO17"), or its offset in decimal
};

// direct: a high level at the robot is a high level on the line. inverted ("active low"): a
// transistor between them inverts it.
enum class Polarity : std::uint8_t { direct, inverted };
enum class Drive : std::uint8_t { push_pull, open_drain };
enum class Bias : std::uint8_t { as_is, disabled, pull_up, pull_down };

struct OutputOptions {
  Level released = Level::high;  // the level from the request on, and the one it is left with
  Polarity polarity = Polarity::direct;
  Drive drive = Drive::push_pull;
  Bias bias = Bias::as_is;
};

struct InputOptions {
  Polarity polarity = Polarity::direct;
  Bias bias = Bias::as_is;
  enum class Edges : std::uint8_t { none, both } edges = Edges::none;
};

struct LineInfo {
  std::string name{};  // empty if it has none
  bool used = false;
  std::string consumer{};  // who holds it; may be empty even if it is used
};

struct ChipInfo {
  std::string path{};
  std::string name{};
  std::string label{};
  std::vector<LineInfo> lines{};  // by offset
  int error = 0;                  // errno if it cannot be opened: then only the path is known
  std::string group{};            // the group that owns its device file; empty if unknown
};

// Why there is no line.
struct LineError {
  enum class Kind : std::uint8_t {
    no_chips,  // this machine has none
    no_such_chip,
    ambiguous_chip,  // several have that label
    no_such_line,
    ambiguous_line,  // several have that name
    busy,
    no_permission,
    system,  // see `error`
  };
  Kind kind = Kind::system;
  LineAddress address{};
  std::vector<std::string> candidates{};  // what there is, or what it could mean
  std::string holder{};                   // busy: the consumer; empty if the kernel has no name
  std::string path{};                     // of the chip
  std::string group{};                    // no_permission: the group that owns the device file
  int error = 0;
};

// One line: what is wrong, and what to do about it.
std::string explain(const LineError& error);

// Every /dev/gpiochip* of this machine, except links. Blocks for a few ms; allocates.
std::vector<ChipInfo> chips();

class InputLine : public Input {
 public:
  struct EdgeEvent {
    Level level = Level::low;  // from now on
    std::chrono::steady_clock::time_point time{};
  };
  // If edges were asked for: blocks until one comes, or until the deadline has passed (nothing).
  // Edges since the last call come first. If the chip is unplugged: nothing, at once.
  virtual std::optional<EdgeEvent> wait_for_edge(
      std::chrono::steady_clock::time_point deadline) = 0;
};

// Requests the line for this process alone, at its released level from the first instant. When the
// object is destroyed, it sets the line to that level again and gives it back: many drivers, the
// Pi's among them, then make it an input, so a resistor should hold the released level too.
// Nothing, with `error` set, if the line is not available. Blocks for a few ms; allocates.
std::unique_ptr<Output> open_output(const LineAddress& address, const OutputOptions& options,
                                    LineError& error);
std::unique_ptr<InputLine> open_input(const LineAddress& address, const InputOptions& options,
                                      LineError& error);

}  // namespace cargobay::gpio
