// The rows of the fault matrix: each named fault of the virtual Create
// (hal/sim/remote/fault_command.hpp), how long it lasts, and what must come of it.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>

#include "hal/sim/remote/fault_command.hpp"
#include "rt/clock.hpp"

namespace cargobay::campaign {

enum class Course {
  goes_on,    // the cycle drives through it
  link_lost,  // the cycle ends; the next bring-up brings the robot back
  either,     // the robot did not get all commands, or not as they were sent
};

struct FaultCase {
  std::string_view name{};   // of the row, unique
  std::string_view begin{};  // for sim::apply_fault()
  std::string_view end{};    // the same; empty if the fault ends by itself
  std::string_view lasts{};  // for the table, if it does not
  rt::Duration shortest{0};  // from begin to end; drawn for each drive
  rt::Duration longest{0};   // from begin to end
  rt::Duration lingers{0};   // after the end: the line may still deliver what it held up
  bool damages_frames = false;
  bool damages_commands = false;  // the robot may take one for another, or ignore it
  bool may_silence = false;       // or take it for one that makes it send less, or other frames
  Course course = Course::goes_on;
  // Of an estimate, at any tick: also while nothing is known of the wheels yet.
  double most_error_mm_s = 130.0;
};

namespace detail {

using std::chrono_literals::operator""ms;

// If the robot does not do as it was told, the estimate takes time to find out.
inline constexpr double kAnyError = 1000.0;

// Damage to one byte in fifty, for a while.
constexpr FaultCase to_host(std::string_view name) {
  return {.name = name,
          .begin = name,
          .end = "none",
          .lasts = ", 0.1 to 1 s",
          .shortest = 100ms,
          .longest = 1000ms,
          .damages_frames = true};
}
constexpr FaultCase to_robot(std::string_view name, bool to_host_too) {
  FaultCase fault = to_host(name);
  fault.damages_frames = to_host_too;
  fault.damages_commands = true;
  fault.may_silence = true;
  fault.course = Course::either;
  fault.most_error_mm_s = kAnyError;
  return fault;
}
// All frames come late.
constexpr FaultCase late(std::string_view begin, std::string_view end, rt::Duration most) {
  return {.name = begin,
          .begin = begin,
          .end = end,
          .lasts = ", 0.1 to 1 s",
          .shortest = 100ms,
          .longest = 1000ms,
          .lingers = most};
}
// The robot does it by itself, and ends it by itself.
constexpr FaultCase by_the_robot(std::string_view name, bool damages_frames) {
  return {.name = name, .begin = name, .damages_frames = damages_frames};
}
// A cable pulled out may cut a command in two.
constexpr FaultCase unplugged(std::string_view name, rt::Duration shortest, rt::Duration longest,
                              std::string_view lasts, Course course) {
  return {.name = name,
          .begin = "unplugged",
          .end = "replugged",
          .lasts = lasts,
          .shortest = shortest,
          .longest = longest,
          .damages_frames = true,
          .course = course,
          .most_error_mm_s = kAnyError};
}
constexpr FaultCase ends_the_link(std::string_view name) {
  return {.name = name,
          .begin = name,
          .damages_frames = true,
          .course = Course::link_lost,
          .most_error_mm_s = kAnyError};
}

inline constexpr std::array kFaultCases{
    late("none", "none", 0ms),
    to_host("lost 0.02"),
    to_robot("lost 0.02 to-robot", false),
    to_robot("lost 0.02 both", true),
    to_host("flipped 0.02"),
    to_robot("flipped 0.02 to-robot", false),
    to_robot("flipped 0.02 both", true),
    to_host("duplicated 0.02"),
    to_robot("duplicated 0.02 to-robot", false),
    to_robot("duplicated 0.02 both", true),
    to_host("inserted 0.02"),
    to_robot("inserted 0.02 to-robot", false),
    to_robot("inserted 0.02 both", true),
    by_the_robot("garbled-frame 1", true),
    by_the_robot("garbled-frame 8", true),
    by_the_robot("stalled-stream 100", false),
    by_the_robot("stalled-stream 200", false),
    by_the_robot("stalled-stream 700", false),
    ends_the_link("stalled-stream 2000"),
    late("burst on", "burst off", 16ms),
    late("held 5 10", "held 0", 10ms),
    late("held 9 25", "held 0", 25ms),
    late("jitter 3", "jitter 0", 3ms),
    late("jitter 12", "jitter 0", 12ms),
    unplugged("unplugged, shortly", 1ms, 140ms, ", up to 0.14 s", Course::either),
    unplugged("unplugged", 140ms, 900ms, ", 0.14 to 0.9 s", Course::either),
    unplugged("unplugged, long", 1100ms, 3000ms, ", 1.1 to 3 s", Course::link_lost),
    ends_the_link("brown-out"),
    ends_the_link("wrong-baud 19200"),
    ends_the_link("wrong-baud 115200"),
    FaultCase{.name = "half-command",
              .begin = "half-command",
              .damages_commands = true,
              .course = Course::either,
              .most_error_mm_s = kAnyError},
    by_the_robot("junk-reading 4", false),
    FaultCase{.name = "text", .begin = "text", .lingers = 5ms, .damages_frames = true},
};

inline bool all_named_faults_are_in() {
  return std::ranges::all_of(hal::sim::faults(), [](const hal::sim::FaultInfo& fault) {
    return std::ranges::any_of(kFaultCases, [&fault](const FaultCase& tested) {
      return tested.begin.starts_with(fault.name) || tested.end.starts_with(fault.name);
    });
  });
}

}  // namespace detail

using detail::all_named_faults_are_in;
using detail::kFaultCases;

}  // namespace cargobay::campaign
