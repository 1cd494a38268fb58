// The latest value of each packet, and the tick of the frame that carried it: one atomic word per
// packet, from the control thread to any number of others.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// What the board showed: each packet on its own, not all from one instant.
struct SensorReadings {
  static constexpr std::size_t kSlots = oi::kLastPacket + 1U;  // by the packet's number
  static constexpr std::int64_t kNever = -1;

  std::array<std::int32_t, kSlots> value{};
  std::array<std::int64_t, kSlots> tick{};
};

class SensorBoard {
 public:
  static constexpr std::size_t kSlots = SensorReadings::kSlots;

  // From the control thread. Wait-free. Ticks count to 2^32, two years.
  void see(const oi::SensorValues& frame, std::int64_t at) CARGOBAY_NONBLOCKING {
    const std::uint64_t tick = static_cast<std::uint64_t>(at + 1) << 32U;  // 0: never
    frame.visit([&](oi::PacketId packet, std::int32_t value) CARGOBAY_NONBLOCKING {
      const auto id = static_cast<std::size_t>(packet);
      if (id >= kSlots) return;  // of a later robot
      // Relaxed: the word is all there is to know about this packet.
      words_[id].store(tick | static_cast<std::uint32_t>(value), std::memory_order_relaxed);
    });
  }
  // From any thread. Wait-free.
  SensorReadings readings() const CARGOBAY_NONBLOCKING {
    SensorReadings read;
    for (std::size_t id = 0; id < kSlots; ++id) {
      const std::uint64_t word = words_[id].load(std::memory_order_relaxed);
      read.value[id] = static_cast<std::int32_t>(static_cast<std::uint32_t>(word));
      read.tick[id] = static_cast<std::int64_t>(word >> 32U) + SensorReadings::kNever;
    }
    return read;
  }

 private:
  std::array<std::atomic<std::uint64_t>, kSlots> words_{};
};

}  // namespace cargobay::hal
