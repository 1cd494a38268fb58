// Plays a pulse train on a pin, and reports how long each pulse really was.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <span>
#include <system_error>

#include "gpio/pin.hpp"
#include "gpio/pulse_train.hpp"

namespace cargobay::gpio {

// CLOCK_MONOTONIC, or virtual time; and how to wait on it.
class PulseClock {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  PulseClock() = default;
  PulseClock(const PulseClock&) = delete;
  PulseClock& operator=(const PulseClock&) = delete;
  virtual ~PulseClock() = default;
  virtual TimePoint now() = 0;
  // Blocks until `deadline`, not less. False if playing should stop instead.
  [[nodiscard]] virtual bool wait_until(TimePoint deadline) = 0;
};

// The clock itself, waited on with clock_nanosleep; never stops playing.
class MonotonicClock final : public PulseClock {
 public:
  TimePoint now() override;
  [[nodiscard]] bool wait_until(TimePoint deadline) override;
};

struct PlayedPulse {
  Pulse wanted{};
  std::chrono::nanoseconds lasted{0};  // between the ends of the two calls that set the edges
};

struct PlayReport {
  std::array<PlayedPulse, kMostPulses> played{};
  std::size_t count = 0;         // pulses that were played whole
  bool interrupted = false;      // by the clock
  std::error_code line_error{};  // of the pin

  std::span<const PlayedPulse> pulses() const { return {played.data(), count}; }
  bool complete() const { return !interrupted && !line_error; }
};

// Blocks for the train's duration, or until the clock stops it. Each edge has an absolute deadline
// counted from the first edge, so delays do not add up. If an edge is late by over a quarter of the
// pulse that begins with it, the rest is shifted with it, so that this pulse is not cut short.
// However it ends, the pin is set to `released` last.
PlayReport play(const PulseTrain& train, Output& pin, PulseClock& clock, Level released);

}  // namespace cargobay::gpio
