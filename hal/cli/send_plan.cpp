#include "hal/cli/send_plan.hpp"

#include <variant>

#include <fmt/format.h>

#include "oi/dialect.hpp"
#include "oi/stream_budget.hpp"
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

std::vector<PlannedCommand> divide(std::span<const std::uint8_t> bytes) {
  std::vector<PlannedCommand> commands;
  while (!bytes.empty()) {
    const oi::ParseResult parsed = oi::parse_command(bytes);
    if (parsed.outcome != oi::ParseResult::Outcome::command) break;
    const auto command = bytes.first(parsed.length);
    commands.push_back({parsed.info, {command.begin(), command.end()}, parsed.command});
    bytes = bytes.subspan(parsed.length);
  }
  return commands;
}

void Expectation::take(const PlannedCommand& command) {
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
    return;
  }
  for (const PlannedCommand& command : divide(script_->body)) {
    mode_ = after(command.info->change, mode_);
    if (turns_wheels(command).value_or(false) || starts_demo(command)) motion_ = Motion::script;
  }
}

std::optional<std::string> objection(const std::vector<PlannedCommand>& commands,
                                     std::optional<oi::Mode> mode, std::uint32_t baud) {
  Expectation robot{mode.value_or(oi::Mode::full), baud};
  bool known = mode.has_value();
  for (const PlannedCommand& command : commands) {
    if (waits(command)) {
      return fmt::format(
          "{} is for scripts: outside one the robot goes deaf until it is over, and cannot be "
          "stopped; write: script {{ ... {} ... }}; play_script",
          command.info->key, command.info->key);
    }
    if (known && robot.mode() == oi::Mode::passive && turns_wheels(command) == false) {
      return fmt::format(
          "the robot is in passive mode and would ignore {}, a stop of the wheels: nothing but a "
          "demo moves it now, and this ends one: demo abort",
          command.info->key);
    }
    if (known && !command.info->available_in(robot.mode())) {
      return fmt::format("the robot is in {} mode and would ignore {}; put 'safe;' before it",
                         oi::name(robot.mode()), command.info->key);
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
