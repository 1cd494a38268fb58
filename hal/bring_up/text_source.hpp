// Whose text it is that arrives on the robot's line.
#pragma once

#include <cstdint>
#include <string_view>

namespace cargobay::hal {

enum class TextSource : std::uint8_t {
  unknown,
  robot,  // what it prints while it is off, boots or charges
  login_prompt,
  shell,
  kernel,
  boot_loader,  // of a computer
  gps,
  modem,
};

// By one line, without its end; `unknown` unless it is one of the known lines. Damage elsewhere in
// the line does not matter. Thread-safe; does not allocate.
TextSource text_source(std::string_view line);

// The same for a line that has not ended: only prompts, which never do.
TextSource prompt_source(std::string_view line);

// Known, and not the robot.
constexpr bool is_stranger(TextSource source) {
  return source != TextSource::unknown && source != TextSource::robot;
}

// For a message: "a login prompt". Empty for `unknown`.
std::string_view describe(TextSource source);

}  // namespace cargobay::hal
