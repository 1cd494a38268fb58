#include "hal/robot/side_command.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <system_error>

#include "hal/cycle/cycle_state.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {

namespace {

// What the loop sends itself, or what would take the robot out of its hands.
bool is_the_loops(const oi::CommandInfo& info) {
  using enum oi::ModeChange;
  if (info.change != none) return true;
  switch (info.opcode) {
    case oi::Drive::kOpcode:
    case oi::DriveDirect::kOpcode:
    case oi::Stream::kOpcode:
    case oi::PauseResumeStream::kOpcode:
    case oi::Sensors::kOpcode:
    case oi::QueryList::kOpcode:
    case oi::Baud::kOpcode:
    case oi::ShowScript::kOpcode:  // its answer is not a frame
    case oi::WaitTime::kOpcode:
    case oi::WaitDistance::kOpcode:
    case oi::WaitAngle::kOpcode:
    case oi::WaitEvent::kOpcode: return true;
    default: return false;
  }
}

Failure refusal(std::errc code, std::string message) {
  return {.message = std::move(message), .code = std::make_error_code(code)};
}

}  // namespace

Result<void> leaves_loop_alone(std::span<const std::uint8_t> command) {
  const oi::CommandInfo* const info = oi::kCreate.find_command(command[0]);
  if (info == nullptr) return refusal(std::errc::invalid_argument, "the robot has no such opcode");
  if (!is_the_loops(*info)) return {};
  return refusal(std::errc::invalid_argument,
                 std::string{info->name} +
                     " is for the loop to send, or would take the robot from it; use the function "
                     "for that purpose");
}

Result<Request> side_request(const ControlCycle& cycle, std::span<const std::uint8_t> command,
                             Request::WhenLong when_long) {
  const oi::CommandInfo& info = *oi::kCreate.find_command(command[0]);
  const std::optional<CycleState> state = cycle.state();
  if (state && !info.available_in(state->mode)) {
    return refusal(std::errc::operation_not_permitted,
                   std::string{info.name} + " is not obeyed in " +
                       std::string{oi::name(state->mode)} + " mode (OI p. " +
                       std::to_string(info.page) + "); the robot has left its own");
  }
  const bool pause = when_long == Request::WhenLong::pause;
  const bool stands =
      state && state->command == rt::WheelSpeeds{} && state->set == rt::WheelSpeeds{};
  if (command.size() > cycle.spare_bytes() && !pause && state && !stands) {
    return refusal(std::errc::no_buffer_space, std::to_string(command.size()) +
                                                   " bytes do not fit next to the loop's own, " +
                                                   std::to_string(cycle.spare_bytes()) +
                                                   " do; send them while the wheels are stopped");
  }
  Request request;
  request.kind = Request::Kind::command;
  request.when_long = when_long;
  request.size = static_cast<std::uint8_t>(command.size());
  std::ranges::copy(command, request.bytes.begin());
  return request;
}

}  // namespace cargobay::hal
