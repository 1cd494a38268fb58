// The latest value of each packet, and the tick of the frame that carried it: one atomic word per
// packet, from the control thread to any number of others, which see whole frames: a sequence lock
// as in rt/mailbox.hpp.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "oi/extensions.hpp"
#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// What the board showed after one frame.
struct SensorReadings {
  static constexpr std::size_t kSlots = oi::kLastPacket + 1U;  // by the packet's number
  static constexpr std::int64_t kNever = -1;

  std::array<std::int32_t, kSlots> value{};
  std::array<std::int64_t, kSlots> tick{};
  // Of all frames: what the counters of distance and angle add up to.
  std::int64_t distance_sum_mm = 0;
  std::int64_t angle_sum_deg = 0;
};

class SensorBoard {
 public:
  static constexpr std::size_t kSlots = SensorReadings::kSlots;

  // From the control thread. Wait-free. Ticks count to 2^32, two years.
  void see(const oi::SensorValues& frame, std::int64_t at) CARGOBAY_NONBLOCKING {
    const std::uint64_t tick = static_cast<std::uint64_t>(at + 1) << 32U;  // 0: never
    sequence_.store(sequence_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    // Whoever sees a word of this frame also sees the odd sequence number.
    std::atomic_thread_fence(std::memory_order_release);
    frame.visit([&](oi::PacketId packet, std::int32_t value) CARGOBAY_NONBLOCKING {
      const auto id = static_cast<std::size_t>(packet);
      words_[id].store(tick | static_cast<std::uint32_t>(value), std::memory_order_relaxed);
    });
    add(distance_sum_mm_, frame.raw(oi::PacketId::distance));  // 0 if the frame has none
    add(angle_sum_deg_, frame.raw(oi::PacketId::angle));
    // Pairs with readings().
    sequence_.store(sequence_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }
  // From any thread: the last value of one packet; 0 if there is none. Wait-free.
  std::int32_t value(oi::PacketId packet) const CARGOBAY_NONBLOCKING {
    const std::uint64_t word =
        words_[static_cast<std::size_t>(packet)].load(std::memory_order_acquire);
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(word));
  }
  // From any thread. Lock-free: retries while a frame is being seen.
  SensorReadings readings() const CARGOBAY_NONBLOCKING {
    SensorReadings read;
    for (;;) {
      const std::uint32_t before = sequence_.load(std::memory_order_acquire);
      for (std::size_t id = 0; id < kSlots; ++id) {
        const std::uint64_t word = words_[id].load(std::memory_order_acquire);
        read.value[id] = static_cast<std::int32_t>(static_cast<std::uint32_t>(word));
        read.tick[id] = static_cast<std::int64_t>(word >> 32U) + SensorReadings::kNever;
      }
      read.distance_sum_mm = distance_sum_mm_.load(std::memory_order_acquire);
      read.angle_sum_deg = angle_sum_deg_.load(std::memory_order_acquire);
      if (before % 2 == 0 && sequence_.load(std::memory_order_relaxed) == before) return read;
    }
  }

 private:
  // Only the control thread adds.
  static void add(std::atomic<std::int64_t>& sum, std::int32_t more) CARGOBAY_NONBLOCKING {
    sum.store(sum.load(std::memory_order_relaxed) + more, std::memory_order_relaxed);
  }

  // Those of a later robot too, so that see() need not ask.
  std::array<std::atomic<std::uint64_t>, oi::kPacketsWithRawCounts.size()> words_{};
  std::atomic<std::int64_t> distance_sum_mm_{0};
  std::atomic<std::int64_t> angle_sum_deg_{0};
  std::atomic<std::uint32_t> sequence_{0};  // odd while a frame is being seen
};

}  // namespace cargobay::hal
