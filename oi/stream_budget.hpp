// What a stream or a command costs on the wire: 8N1, ten bits a byte.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/dialect.hpp"
#include "oi/frame.hpp"
#include "oi/limits.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::oi {

inline constexpr std::uint64_t kBitsPerByte = 10;
inline constexpr std::size_t kDriveDirectBytes = 5;

// How long `bits` take, rounded up. `baud` is not 0.
constexpr std::chrono::nanoseconds bit_time(std::uint64_t bits, std::uint32_t baud) {
  return std::chrono::nanoseconds{
      static_cast<std::int64_t>((bits * 1'000'000'000U + baud - 1) / baud)};
}

// From the first start bit to the last stop bit of `bytes` without gaps, rounded up.
constexpr std::chrono::nanoseconds wire_time(std::size_t bytes, std::uint32_t baud) {
  return bit_time(bytes * kBitsPerByte, baud);
}

// The least time from the first start bit to the last stop bit of `bytes` sent to the robot: at
// 115200 baud with the spacing that it needs.
constexpr std::chrono::nanoseconds command_time(std::size_t bytes, std::uint32_t baud) {
  if (bytes == 0 || !needs_spacing(baud)) return wire_time(bytes, baud);
  return static_cast<std::int64_t>(bytes - 1) * kByteSpacingAt115200 + wire_time(1, baud);
}

// Whole bytes that the line carries in one 15 ms tick, each way.
constexpr std::size_t bytes_per_tick(std::uint32_t baud) {
  const auto tick_us = std::chrono::duration_cast<std::chrono::microseconds>(kTick).count();
  return static_cast<std::size_t>(baud * static_cast<std::uint64_t>(tick_us) /
                                  (kBitsPerByte * 1'000'000U));
}

// Bytes of the stream frame of this list; more than kMaxFrameBytes if no frame can hold it. An id
// that is not a packet counts as its id alone; an empty list has no frame and gives 0.
constexpr std::size_t frame_bytes(std::span<const PacketId> packets,
                                  const Dialect& dialect = kCreate) {
  if (packets.empty()) return 0;
  std::size_t sum = kFrameOverhead;
  for (const PacketId packet : packets) {
    const PacketInfo* info = dialect.find_packet(static_cast<std::uint8_t>(packet));
    sum += 1U + (info != nullptr ? info->size : 0U);
  }
  return sum;
}

// Whether the robot can send the frame of this list every tick.
constexpr bool fits(std::span<const PacketId> packets, std::uint32_t baud,
                    const Dialect& dialect = kCreate) {
  const std::size_t bytes = frame_bytes(packets, dialect);
  return bytes <= kMaxFrameBytes && bytes <= bytes_per_tick(baud);
}

// A PL011, the Raspberry Pi's full UART, wakes its driver when half of its FIFO is full, otherwise
// after 32 bit times without a byte.
inline constexpr std::size_t kPl011HalfFifoPi0To3 = 8;
inline constexpr std::size_t kPl011HalfFifoPi4And5 = 16;
inline constexpr std::uint64_t kPl011TimeoutBits = 32;

// How long after a frame's last bit the PL011 reports it: at once if the frame ends at a multiple
// of half the FIFO, otherwise after the receive time-out.
constexpr std::chrono::nanoseconds pl011_delay(std::size_t frame, std::uint32_t baud,
                                               std::size_t half_fifo) {
  if (frame % half_fifo == 0) return std::chrono::nanoseconds{0};
  return bit_time(kPl011TimeoutBits, baud);
}

// From a frame's first bit to the last bit of the DriveDirect that answers it, without any
// software: the least latency that the controller has to live with.
constexpr std::chrono::nanoseconds control_delay(std::size_t frame, std::uint32_t baud,
                                                 std::size_t half_fifo) {
  return wire_time(frame, baud) + pl011_delay(frame, baud, half_fifo) +
         command_time(kDriveDirectBytes, baud);
}

}  // namespace cargobay::oi
