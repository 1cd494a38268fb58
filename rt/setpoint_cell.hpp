// The set speed, from any thread to the control thread, in one atomic word: wait-free to read, and
// never half of one setpoint and half of another.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>

#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

class SetpointCell {
 public:
  static constexpr double kMaxSpeed = 511.0;           // mm/s
  static constexpr double kResolution = 1.0 / 1024.0;  // mm/s

  struct Setpoint {
    WheelSpeeds speeds{};
    std::uint32_t serial = 0;  // 24 bits; 0 before the first put(), changed by each
  };

  // From any thread. False, with nothing changed, for a speed that is not a number or beyond
  // kMaxSpeed.
  [[nodiscard]] bool put(const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
    if (!(std::abs(speeds.left_mm_s) <= kMaxSpeed) || !(std::abs(speeds.right_mm_s) <= kMaxSpeed)) {
      return false;
    }
    const std::uint64_t payload = pack(speeds.left_mm_s) << 44U | pack(speeds.right_mm_s) << 24U;
    std::uint64_t old = word_.load(std::memory_order_relaxed);
    // Relaxed is enough: the word is all there is to know.
    while (
        !word_.compare_exchange_weak(old, payload | next_serial(old), std::memory_order_relaxed)) {
    }
    return true;
  }

  // From any thread. Wait-free.
  Setpoint get() const CARGOBAY_NONBLOCKING {
    const std::uint64_t word = word_.load(std::memory_order_relaxed);
    return {.speeds = {.left_mm_s = unpack(word >> 44U), .right_mm_s = unpack(word >> 24U)},
            .serial = static_cast<std::uint32_t>(word & kSerialMask)};
  }

 private:
  static constexpr std::uint64_t kSerialMask = (1U << 24U) - 1;
  static constexpr std::uint64_t kSpeedMask = (1U << 20U) - 1;

  static std::uint64_t next_serial(std::uint64_t word) CARGOBAY_NONBLOCKING {
    const std::uint64_t serial = (word + 1) & kSerialMask;
    return serial == 0 ? 1 : serial;
  }
  static std::uint64_t pack(double speed_mm_s) CARGOBAY_NONBLOCKING {
    return static_cast<std::uint64_t>(
               static_cast<std::int64_t>(std::lrint(speed_mm_s / kResolution))) &
           kSpeedMask;
  }
  static double unpack(std::uint64_t bits) CARGOBAY_NONBLOCKING {
    auto value = static_cast<std::int32_t>(bits & kSpeedMask);
    if (value >= 1 << 19) value -= 1 << 20;
    return value * kResolution;
  }

  std::atomic<std::uint64_t> word_{0};
};

}  // namespace cargobay::rt
