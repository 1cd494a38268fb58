// The latest value of each packet, and the tick of the frame that told it.
#pragma once

#include <array>
#include <cstdint>

#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

struct SensorBoard {
  static constexpr std::size_t kSlots = oi::kLastPacket + 1U;  // by the packet's number
  static constexpr std::int64_t kNever = -1;

  std::array<std::int32_t, kSlots> value{};
  std::array<std::int64_t, kSlots> tick = [] {
    std::array<std::int64_t, kSlots> none{};
    none.fill(kNever);
    return none;
  }();

  void see(const oi::SensorValues& frame, std::int64_t at) noexcept CARGOBAY_NONBLOCKING {
    for (std::size_t id = oi::kFirstSinglePacket; id < kSlots; ++id) {
      const oi::PacketId packet{static_cast<std::uint8_t>(id)};
      if (!frame.has(packet)) continue;
      value[id] = frame.raw(packet);
      tick[id] = at;
    }
  }
};

}  // namespace cargobay::hal
