// The program cargobay-gamepad as a child: it reads the gamepad, so that the command need not link
// libevdev, and prints a line each time (hal/gamepad/gamepad.hpp).
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <string_view>

#include "hal/cli/live/wish.hpp"
#include "hal/file/descriptor.hpp"
#include "hal/result.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {

// One thread. Allocates.
class GamepadHelper {
 public:
  // What was said last counts for so long: the program repeats itself more often than that.
  static constexpr rt::Duration kCounts = std::chrono::milliseconds{400};

  // Starts it on this device; if empty, on the first gamepad there is. What it complains about goes
  // to standard error. Does not wait until it has found one.
  static hal::Result<GamepadHelper> start(const std::string& device);
  ~GamepadHelper();  // ends it
  GamepadHelper(GamepadHelper&& other) noexcept;
  GamepadHelper& operator=(GamepadHelper&&) = delete;
  GamepadHelper(const GamepadHelper&) = delete;
  GamepadHelper& operator=(const GamepadHelper&) = delete;

  // To be polled for input.
  int descriptor() const { return lines_.number(); }
  // Takes what it has printed, without waiting. Fails when it has ended: the gamepad is gone.
  hal::Result<void> take(rt::TimePoint now);
  // Forgets what it has printed so far, and what that asked for.
  void skip_to_now();
  // Nothing while the button that is to be held is not.
  Wish wish(rt::TimePoint now) const;
  // Nothing has moved on it while its button is held: it may be out of range.
  bool is_silent() const { return silent_; }
  // Its name, once the program has found it.
  const std::string& name() const { return name_; }

 private:
  GamepadHelper(pid_t process, hal::Descriptor lines);
  void hear(std::string_view line, rt::TimePoint now);

  pid_t process_ = -1;
  hal::Descriptor lines_;
  std::string received_{};
  std::string name_{};
  Wish wish_{};
  bool silent_ = false;
  rt::TimePoint until_{};
};

}  // namespace cargobay::cli
