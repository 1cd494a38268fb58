#include "hal/sim/remote/fault_command.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>

#include "hal/sim/words.hpp"
#include "oi/baud.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr rt::Duration kUsbLatency = std::chrono::milliseconds{16};
constexpr double kLongestMs = 3'600'000.0;
constexpr int kMost = 1'000'000;
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

bool set_unplugged(bool unplugged, Cable& cable) {
  cable.faults_to_host().unplugged = unplugged;
  cable.faults_to_robot().unplugged = unplugged;
  return true;
}

// A count of at most a million; `otherwise` where none is given.
std::optional<std::uint32_t> count(std::string_view rest, std::uint32_t otherwise) {
  const std::string_view word = next_word(rest);
  if (word.empty()) return otherwise;
  const std::optional<int> value = to_integer(word, 0, kMost);
  if (!value || !no_more_words(rest)) return std::nullopt;
  return static_cast<std::uint32_t>(*value);
}

bool set_held(std::string_view rest, Cable& cable) {
  const std::optional<int> every = to_integer(next_word(rest), 0, kMost);
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
  const std::optional<int> baud = to_integer(next_word(rest), 0, kMost);
  if (!baud || !no_more_words(rest)) return false;
  const auto rate = static_cast<std::uint32_t>(*baud);
  if (!oi::baud_code(rate)) return false;
  cable.device().set_baud(rate);
  return true;
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): one flat list of names
bool apply(std::string_view name, std::string_view rest, Cable& cable) {
  DeviceFaults& robot = cable.device().faults();
  const bool bare = rest.find_first_not_of(" \t") == std::string_view::npos;
  if (name == "none" && bare) {
    cable.faults_to_host() = {};
    cable.faults_to_robot() = {};
    robot = {};
    return true;
  }
  if (name == "lost") return set_probability(&ByteFaults::lost, rest, cable);
  if (name == "flipped") return set_probability(&ByteFaults::flipped, rest, cable);
  if (name == "duplicated") return set_probability(&ByteFaults::duplicated, rest, cable);
  if (name == "inserted") return set_probability(&ByteFaults::inserted, rest, cable);
  if (name == "held") return set_held(rest, cable);
  if (name == "burst") return set_burst(rest, cable);
  if (name == "wrong-baud") return set_wrong_baud(rest, cable);
  if (name == "unplugged" && bare) return set_unplugged(true, cable);
  if (name == "replugged" && bare) return set_unplugged(false, cable);
  if (name == "brown-out" && bare) {
    cable.device().brown_out();
    return true;
  }
  if (name == "half-command" && bare) {
    cable.device().take_half_command();
    return true;
  }
  if (name == "text") {
    std::string line{bare ? kText : rest.substr(rest.find_first_not_of(" \t"))};
    cable.device().print(line + "\r\n");
    return true;
  }
  if (name == "garbled-frame" || name == "junk-reading") {
    const std::optional<std::uint32_t> wanted = count(rest, name == "garbled-frame" ? 1 : 2);
    if (!wanted) return false;
    (name == "garbled-frame" ? robot.garbled_frames : robot.junk_readings) = *wanted;
    return true;
  }
  if (name == "stalled-stream" || name == "jitter") {
    const std::optional<double> ms = to_number(next_word(rest), 0.0, kLongestMs);
    if (!ms || !no_more_words(rest)) return false;
    if (name == "jitter") {
      cable.faults_to_host().jitter = milliseconds(*ms);
    } else {
      robot.stalled_until = cable.now() + milliseconds(*ms);
    }
    return true;
  }
  return false;
}

}  // namespace

std::string apply_fault(std::string_view command, Cable& cable) {
  std::string_view rest = command;
  const std::string_view name = next_word(rest);
  const auto* const info =
      std::find_if(kFaults.begin(), kFaults.end(),
                   [name](const FaultInfo& fault) { return fault.name == name; });
  if (info == kFaults.end()) {
    std::string message = "no fault is called '" + std::string{name} + "'; there are:";
    for (const FaultInfo& fault : kFaults) message += " " + std::string{fault.name};
    return message;
  }
  if (apply(name, rest, cable)) return {};
  std::string usage{name};
  if (!info->arguments.empty()) usage += " " + std::string{info->arguments};
  return "it is '" + usage + "'";
}

}  // namespace cargobay::hal::sim
