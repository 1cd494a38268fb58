#include "gpio/pulse_player.hpp"

#include <cerrno>
#include <ctime>

namespace cargobay::gpio {
namespace {

// Counted from `scheduled`, unless the edge came so late that the pulse would suffer.
PulseClock::TimePoint end_of(const Pulse& pulse, PulseClock::TimePoint scheduled,
                             PulseClock::TimePoint edge) {
  const bool late = edge - scheduled > pulse.duration / 4;
  return (late ? edge : scheduled) + pulse.duration;
}

}  // namespace

PulseClock::TimePoint MonotonicClock::now() { return std::chrono::steady_clock::now(); }

bool MonotonicClock::wait_until(TimePoint deadline) {
  const auto since_boot =
      std::chrono::duration_cast<std::chrono::nanoseconds>(deadline.time_since_epoch()).count();
  const timespec until{.tv_sec = static_cast<time_t>(since_boot / 1'000'000'000),
                       .tv_nsec = static_cast<long>(since_boot % 1'000'000'000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
  return true;
}

PlayReport play(const PulseTrain& train, Output& pin, PulseClock& clock, Level released) {
  PlayReport report;
  PulseClock::TimePoint deadline = clock.now();
  for (const Pulse& pulse : train.pulses()) {
    report.line_error = pin.set(pulse.level);
    if (report.line_error) break;
    const PulseClock::TimePoint edge = clock.now();
    deadline = end_of(pulse, deadline, edge);
    report.interrupted = !clock.wait_until(deadline);
    if (report.interrupted) break;
    report.played[report.count++] = {.wanted = pulse, .lasted = clock.now() - edge};
  }
  const std::error_code error = pin.set(released);
  if (!report.line_error) report.line_error = error;
  return report;
}

}  // namespace cargobay::gpio
