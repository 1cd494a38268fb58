// The one clock: CLOCK_MONOTONIC, which std::chrono::steady_clock is on Linux. Virtual time uses
// the same type with its own origin.
#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>

namespace cargobay::rt {

using Clock = std::chrono::steady_clock;
using TimePoint = Clock::time_point;
using Duration = std::chrono::nanoseconds;

constexpr std::int64_t nanoseconds(TimePoint time) {
  return std::chrono::duration_cast<Duration>(time.time_since_epoch()).count();
}
constexpr double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}
// As system calls take it; `duration` must not be negative.
constexpr timespec as_timespec(Duration duration) {
  return {.tv_sec = static_cast<time_t>(duration.count() / 1'000'000'000),
          .tv_nsec = static_cast<long>(duration.count() % 1'000'000'000)};
}

}  // namespace cargobay::rt
