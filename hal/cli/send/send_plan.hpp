// What a sequence of commands will do, as far as that is known before a byte is sent.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "oi/command_table.hpp"
#include "oi/parse.hpp"

namespace cargobay::cli {

struct PlannedCommand {
  const oi::CommandInfo* info = nullptr;  // null for raw bytes
  std::vector<std::uint8_t> bytes{};
  oi::Command command{};  // nothing for raw bytes

  // Not a whole command of the manual with values in range.
  bool is_raw() const { return info == nullptr; }
};

// Whether it tells the wheels to stand still. Everyone may, in any mode: it is never refused.
bool stops_wheels(const PlannedCommand& command);

// Divides the bytes of encode_or_explain() as the robot does. Raw bytes next to each other are one,
// except for the opcodes of extensions.
std::vector<PlannedCommand> divide(std::span<const std::uint8_t> bytes);

// What may be turning the wheels.
enum class Motion : std::uint8_t { none, drive, demo, script };

// What is known of the waits in a script.
struct ScriptWaits {
  bool any = false;  // or the script is not known
  // How long they take, if all of them are Wait Time; else nothing.
  std::optional<std::chrono::milliseconds> duration{std::chrono::milliseconds{0}};
};

// Mode, motion and stream of a robot that obeys every command passed to take().
class Expectation {
 public:
  explicit Expectation(oi::Mode mode, std::uint32_t baud) : mode_{mode}, baud_{baud} {}

  void take(const PlannedCommand& command);

  oi::Mode mode() const { return mode_; }
  std::uint32_t baud() const { return baud_; }
  Motion motion() const { return motion_; }
  // Whether anything so far has set the wheels turning, or may have.
  bool has_moved() const { return has_moved_; }
  // Of the script that was started and has not been seen to end.
  const std::optional<ScriptWaits>& waits() const { return waits_; }
  // The script has ended: what it left turning is known if the script is.
  void script_ended();

 private:
  void play_script();

  oi::Mode mode_;
  std::uint32_t baud_;
  Motion motion_ = Motion::none;
  bool has_moved_ = false;
  std::optional<oi::Script> script_{};  // nothing if another program stored it
  std::optional<ScriptWaits> waits_{};
};

// Why these commands must not be sent to a robot in this mode at this rate; nothing if they may be.
// Without a mode: what holds in any mode.
std::optional<std::string> objection(const std::vector<PlannedCommand>& commands,
                                     std::optional<oi::Mode> mode, std::uint32_t baud);

}  // namespace cargobay::cli
