#include "hal/cli/send/send_plan.hpp"

#include <algorithm>
#include <variant>

#include <fmt/format.h>

#include "oi/dialect.hpp"
#include "oi/extensions.hpp"
#include "oi/stream_budget.hpp"
#include "oi/text/create_2.hpp"
#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

bool starts_demo(const PlannedCommand& command) {
  if (const auto* demo = std::get_if<oi::Demo>(&command.command))
    return demo->demo != oi::DemoNumber::abort;
  return std::holds_alternative<oi::Spot>(command.command) ||
         std::holds_alternative<oi::Cover>(command.command) ||
         std::holds_alternative<oi::CoverAndDock>(command.command);
}

// Whether the command leaves the wheels turning; nothing if it does not set their speed.
std::optional<bool> turns_wheels(const PlannedCommand& command) {
  if (const auto* drive = std::get_if<oi::Drive>(&command.command))
    return drive->velocity != oi::MmPerSec{0};
  if (const auto* direct = std::get_if<oi::DriveDirect>(&command.command))
    return direct->left != oi::MmPerSec{0} || direct->right != oi::MmPerSec{0};
  return std::nullopt;
}

bool waits(const PlannedCommand& command) {
  return std::holds_alternative<oi::WaitTime>(command.command) ||
         std::holds_alternative<oi::WaitDistance>(command.command) ||
         std::holds_alternative<oi::WaitAngle>(command.command) ||
         std::holds_alternative<oi::WaitEvent>(command.command);
}

bool is_extension(std::span<const std::uint8_t> bytes) {
  return bytes.size() == 1 && oi::find_extension(bytes[0]) != nullptr;
}

bool resets(const PlannedCommand& command) {
  return command.bytes == std::vector{oi::kSoftResetOpcode};
}

// Whether raw bytes may turn the wheels: with an opcode that does, of this robot or the Create 2.
bool may_turn_wheels(const std::vector<std::uint8_t>& raw) {
  return std::ranges::any_of(raw, [](std::uint8_t byte) {
    switch (byte) {
      case oi::Spot::kOpcode:
      case oi::Cover::kOpcode:
      case oi::Demo::kOpcode:
      case oi::Drive::kOpcode:
      case oi::CoverAndDock::kOpcode:
      case oi::DriveDirect::kOpcode:
      case oi::Script::kOpcode:
      case oi::PlayScript::kOpcode:
      case oi::create_2::kDrivePwm: return true;
      default: return false;
    }
  });
}

ScriptWaits waits_of(const std::vector<PlannedCommand>& script) {
  ScriptWaits all;
  for (const PlannedCommand& command : script) {
    if (std::holds_alternative<oi::PlayScript>(command.command) && !command.is_raw()) {
      return {.any = true, .duration = std::nullopt};  // it begins again
    }
    if (command.is_raw() || !waits(command)) continue;
    all.any = true;
    const auto* time = std::get_if<oi::WaitTime>(&command.command);
    if (time == nullptr) {
      all.duration = std::nullopt;
    } else if (all.duration) {
      *all.duration += std::chrono::milliseconds{100} * time->time.value;
    }
  }
  return all;
}

oi::Mode after(oi::ModeChange change, oi::Mode before) {
  switch (change) {
    case oi::ModeChange::none: return before;
    case oi::ModeChange::to_passive: return oi::Mode::passive;
    case oi::ModeChange::to_safe: return oi::Mode::safe;
    case oi::ModeChange::to_full: return oi::Mode::full;
  }
  return before;
}

std::string too_many_packets(const oi::Stream& stream, std::uint32_t baud) {
  return fmt::format(
      "stream: frames of {} bytes every 15 ms do not fit {} baud, which carries {}; ask for fewer "
      "packets, or once with query_list",
      oi::frame_bytes(stream.packets), baud, oi::bytes_per_tick(baud));
}

}  // namespace

bool stops_wheels(const PlannedCommand& command) {
  return !command.is_raw() && turns_wheels(command) == false;
}

std::vector<PlannedCommand> divide(std::span<const std::uint8_t> bytes) {
  std::vector<PlannedCommand> commands;
  while (!bytes.empty()) {
    const oi::ParseResult parsed = oi::parse_command(bytes);
    // A command cut short is all that is left.
    const std::size_t length = parsed.length != 0 ? parsed.length : bytes.size();
    const auto command = bytes.first(length);
    bytes = bytes.subspan(length);
    if (parsed.outcome == oi::ParseResult::Outcome::command) {
      commands.push_back({parsed.info, {command.begin(), command.end()}, parsed.command});
    } else if (commands.empty() || !commands.back().is_raw() || is_extension(command) ||
               is_extension(commands.back().bytes)) {
      commands.push_back({nullptr, {command.begin(), command.end()}, {}});
    } else {
      commands.back().bytes.insert(commands.back().bytes.end(), command.begin(), command.end());
    }
  }
  return commands;
}

void Expectation::take(const PlannedCommand& command) {
  if (command.is_raw()) {
    if (may_turn_wheels(command.bytes)) motion_ = Motion::drive;
    // The robot restarts, in Off and at its own rate; one that does not know the opcode goes on.
    if (resets(command)) mode_ = oi::Mode::off;
    has_moved_ = has_moved_ || motion_ != Motion::none;
    return;
  }
  mode_ = after(command.info->change, mode_);
  if (const std::optional<bool> turning = turns_wheels(command))
    motion_ = *turning ? Motion::drive : Motion::none;
  if (starts_demo(command)) motion_ = Motion::demo;
  // Abort ends a demo, but not a script that is waiting.
  if (std::holds_alternative<oi::Demo>(command.command) && !starts_demo(command) &&
      motion_ == Motion::demo) {
    motion_ = Motion::none;
  }
  if (const auto* baud = std::get_if<oi::Baud>(&command.command))
    baud_ = oi::kCreate.baud_rates[baud->code];
  if (const auto* script = std::get_if<oi::Script>(&command.command)) script_ = *script;
  if (std::holds_alternative<oi::PlayScript>(command.command)) play_script();
  has_moved_ = has_moved_ || motion_ != Motion::none;
}

// A script can do what any command does, only later. A script that is not known may do anything.
void Expectation::play_script() {
  if (!script_) {
    motion_ = Motion::script;
    waits_ = ScriptWaits{.any = true, .duration = std::nullopt};
    return;
  }
  const std::vector<PlannedCommand> commands = divide(script_->body);
  for (const PlannedCommand& command : commands) {
    if (command.is_raw()) {
      if (may_turn_wheels(command.bytes)) motion_ = Motion::script;
      continue;
    }
    mode_ = after(command.info->change, mode_);
    if (turns_wheels(command).value_or(false) || starts_demo(command)) motion_ = Motion::script;
  }
  waits_ = waits_of(commands);
}

void Expectation::script_ended() {
  waits_.reset();
  if (!script_ || motion_ != Motion::script) return;
  motion_ = Motion::none;
  for (const PlannedCommand& command : divide(script_->body)) {
    if (command.is_raw()) {
      if (may_turn_wheels(command.bytes)) motion_ = Motion::drive;
      continue;
    }
    if (const std::optional<bool> turning = turns_wheels(command))
      motion_ = *turning ? Motion::drive : Motion::none;
    if (starts_demo(command)) motion_ = Motion::demo;
  }
}

std::optional<std::string> objection(const std::vector<PlannedCommand>& commands,
                                     std::optional<oi::Mode> mode, std::uint32_t baud) {
  Expectation robot{mode.value_or(oi::Mode::full), baud};
  bool known = mode.has_value();
  for (const PlannedCommand& command : commands) {
    if (command.is_raw()) {
      robot.take(command);
      known = known || resets(command);
      continue;
    }
    if (waits(command)) {
      return fmt::format(
          "{} is for scripts: outside one the robot goes deaf until it is over, and cannot be "
          "stopped; write: script {{ ... {} ... }}; play_script",
          command.info->key, command.info->key);
    }
    if (known && !stops_wheels(command) && !command.info->available_in(robot.mode())) {
      return fmt::format("the robot is in {} mode and would ignore {}; put '{};' before it",
                         oi::name(robot.mode()), command.info->key,
                         robot.mode() == oi::Mode::off ? "start" : "safe");
    }
    if (const auto* stream = std::get_if<oi::Stream>(&command.command);
        stream != nullptr && !stream->packets.empty() && !oi::fits(stream->packets, robot.baud())) {
      return too_many_packets(*stream, robot.baud());
    }
    robot.take(command);
    known = known || command.info->change != oi::ModeChange::none;
  }
  return std::nullopt;
}

}  // namespace cargobay::cli
