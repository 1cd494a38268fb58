#include "hal/sim/remote/fault_command.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "hal/sim/next_word.hpp"
#include "oi/dialect.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr rt::Duration kUsbLatency = std::chrono::milliseconds{16};
constexpr double kLongestMs = 3'600'000.0;
constexpr int kMostCount = 1'000'000;
constexpr std::string_view kText = "key-wakeup";

rt::Duration milliseconds(double value) {
  return rt::Duration{static_cast<std::int64_t>(value * 1e6)};
}

bool set_probability(double ByteFaults::* fault, std::string_view rest, Cable& cable) {
  const std::optional<double> probability = to_number(next_word(rest), 0.0, 1.0);
  const std::string_view direction = next_word(rest);
  if (!probability || !no_more_words(rest)) return false;
  const bool both = direction == "both";
  const bool to_host = both || direction.empty() || direction == "to-host";
  const bool to_robot = both || direction == "to-robot";
  if (!to_host && !to_robot) return false;
  if (to_host) cable.faults_to_host().bytes.*fault = *probability;
  if (to_robot) cable.faults_to_robot().bytes.*fault = *probability;
  return true;
}

bool set_plugged(std::string_view rest, bool plugged, Cable& cable) {
  if (!no_more_words(rest)) return false;
  cable.set_plugged(plugged);
  return true;
}

// A count of at most a million; `otherwise` if none is given.
std::optional<std::uint32_t> count(std::string_view rest, std::uint32_t otherwise) {
  const std::string_view word = next_word(rest);
  if (word.empty()) return otherwise;
  const std::optional<int> value = to_integer(word, 0, kMostCount);
  if (!value || !no_more_words(rest)) return std::nullopt;
  return static_cast<std::uint32_t>(*value);
}

bool set_held(std::string_view rest, Cable& cable) {
  const std::optional<int> every = to_integer(next_word(rest), 0, kMostCount);
  if (!every) return false;
  LineFaults& line = cable.faults_to_host();
  if (*every == 0 && no_more_words(rest)) {
    line.held_every = 0;
    return true;
  }
  const std::optional<double> ms = to_number(next_word(rest), 0.0, kLongestMs);
  if (!ms || !no_more_words(rest)) return false;
  line.held_every = static_cast<std::uint32_t>(*every);
  line.held_by = milliseconds(*ms);
  return true;
}

bool set_burst(std::string_view rest, Cable& cable) {
  const std::string_view state = next_word(rest);
  if ((state != "on" && state != "off") || !no_more_words(rest)) return false;
  cable.faults_to_host().latency_timer = state == "on" ? kUsbLatency : rt::Duration{0};
  return true;
}

bool set_wrong_baud(std::string_view rest, Cable& cable) {
  const std::optional<int> baud = to_integer(next_word(rest), 0, kMostCount);
  if (!baud || !no_more_words(rest)) return false;
  const auto rate = static_cast<std::uint32_t>(*baud);
  if (!oi::kCreate.baud_code(rate)) return false;
  cable.device().set_baud(rate);
  return true;
}

bool set_milliseconds(std::string_view rest, rt::Duration& duration) {
  const std::optional<double> ms = to_number(next_word(rest), 0.0, kLongestMs);
  if (!ms || !no_more_words(rest)) return false;
  duration = milliseconds(*ms);
  return true;
}

bool set_count(std::string_view rest, std::uint32_t otherwise, std::uint32_t& number) {
  const std::optional<std::uint32_t> wanted = count(rest, otherwise);
  if (wanted) number = *wanted;
  return wanted.has_value();
}

bool stall_stream(std::string_view rest, Cable& cable) {
  rt::Duration duration{};
  if (!set_milliseconds(rest, duration)) return false;
  cable.device().faults().stalled_until = cable.now() + duration;
  return true;
}

bool print_text(std::string_view rest, Cable& cable) {
  const std::string_view words =
      no_more_words(rest) ? kText : rest.substr(rest.find_first_not_of(" \t"));
  cable.device().print(std::string{words} + "\r\n");
  return true;
}

bool end_all(Cable& cable) {
  cable.faults_to_host() = {};
  cable.faults_to_robot() = {};
  cable.device().faults() = {};
  cable.set_plugged(true);
  return true;
}

constexpr std::array kFaults{
    FaultInfo{
        "none", "", "ends all faults of the line, and those of the robot that last",
        [](std::string_view rest, Cable& cable) { return no_more_words(rest) && end_all(cable); }},
    FaultInfo{"lost", "P [DIRECTION]", "bytes are lost",
              [](std::string_view rest, Cable& cable) {
                return set_probability(&ByteFaults::lost, rest, cable);
              }},
    FaultInfo{"flipped", "P [DIRECTION]", "bytes arrive with one bit flipped",
              [](std::string_view rest, Cable& cable) {
                return set_probability(&ByteFaults::flipped, rest, cable);
              }},
    FaultInfo{"duplicated", "P [DIRECTION]", "bytes arrive twice",
              [](std::string_view rest, Cable& cable) {
                return set_probability(&ByteFaults::duplicated, rest, cable);
              }},
    FaultInfo{"inserted", "P [DIRECTION]", "random bytes arrive after others",
              [](std::string_view rest, Cable& cable) {
                return set_probability(&ByteFaults::inserted, rest, cable);
              }},
    FaultInfo{"garbled-frame", "[COUNT]", "the next stream frames are garbled",
              [](std::string_view rest, Cable& cable) {
                return set_count(rest, 1, cable.device().faults().garbled_frames);
              }},
    FaultInfo{"stalled-stream", "MS", "the stream has no frames for that long", &stall_stream},
    FaultInfo{"burst", "on|off", "bytes arrive as through a USB adapter with a 16 ms timer",
              &set_burst},
    FaultInfo{"jitter", "MS", "each byte arrives up to that much later; 0 ends it",
              [](std::string_view rest, Cable& cable) {
                return set_milliseconds(rest, cable.faults_to_host().jitter);
              }},
    FaultInfo{"held", "N MS",
              "each Nth frame is held back for that long, and what follows queues; 0 ends it",
              &set_held},
    FaultInfo{"unplugged", "", "nothing passes through the line",
              [](std::string_view rest, Cable& cable) { return set_plugged(rest, false, cable); }},
    FaultInfo{"replugged", "", "the line is whole again",
              [](std::string_view rest, Cable& cable) { return set_plugged(rest, true, cable); }},
    FaultInfo{"brown-out", "",
              "the battery fails for an instant: the robot boots and has forgotten everything",
              [](std::string_view rest, Cable& cable) {
                if (!no_more_words(rest)) return false;
                cable.device().brown_out();
                return true;
              }},
    FaultInfo{"wrong-baud", "BAUD", "the robot changes its rate by itself", &set_wrong_baud},
    FaultInfo{"half-command", "", "the robot waits for the data of a command that was never sent",
              [](std::string_view rest, Cable& cable) {
                if (!no_more_words(rest)) return false;
                cable.device().take_half_command();
                return true;
              }},
    FaultInfo{"junk-reading", "[COUNT]", "the next distances and angles read are junk",
              [](std::string_view rest, Cable& cable) {
                return set_count(rest, 2, cable.device().faults().junk_readings);
              }},
    FaultInfo{"text", "[WORDS]", "the robot prints a line, wherever its stream is", &print_text},
};

}  // namespace

std::span<const FaultInfo> faults() { return kFaults; }

std::string apply_fault(std::string_view command, Cable& cable) {
  std::string_view rest = command;
  const std::string_view name = next_word(rest);
  const auto* const info =
      std::find_if(kFaults.begin(), kFaults.end(),
                   [name](const FaultInfo& fault) { return fault.name == name; });
  if (info == kFaults.end()) {
    std::string message = "unknown fault '" + std::string{name} + "'; the faults are:";
    for (const FaultInfo& fault : kFaults) message += " " + std::string{fault.name};
    return message;
  }
  if (info->apply(rest, cable)) return {};
  std::string usage{name};
  if (!info->arguments.empty()) usage += " " + std::string{info->arguments};
  return "the usage is '" + usage + "'";
}

}  // namespace cargobay::hal::sim
