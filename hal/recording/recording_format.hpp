// The bytes of a recording: what the flight recorder keeps in memory and `cargobay drive --record`
// writes to a file. Version 1; all numbers are little endian, times are nanoseconds.
//
//   file    header, then blocks up to the end
//   header  magic(8) version(2) length of the rest(4) rest CRC-32(4)
//           rest: the fields in hal/recording/recording_header.cpp
//   block   length of the entries(4) number(4) time(8) entries CRC-32(4)
//           number: from 0, one more for each; if one is missing, the recording has a gap
//           time: what the clock last said before the block; only differences mean anything
//   entry   kind(1), then the fields listed below, as hal/recording/byte_archive.hpp puts them
//
// A CRC-32 is that of Ethernet and zip, over everything before it in its header or block.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/cycle/cycle_state.hpp"
#include "hal/recording/byte_archive.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// The last four bytes are there to be spoilt by anything that takes the file for text.
inline constexpr std::array<std::uint8_t, 8> kRecordingMagic{'C',  'B',  'R',  'E',
                                                             '\r', '\n', 0x1A, '\n'};
inline constexpr std::uint16_t kRecordingVersion = 3;
inline constexpr std::size_t kMostHeaderBytes = 65536;  // of its rest
inline constexpr std::size_t kBlockHeadBytes = 16;
inline constexpr std::size_t kMostBlockBytes = 2048;     // of its entries
inline constexpr std::size_t kMostTransferBytes = 1024;  // of one read or write
inline constexpr std::size_t kChecksumBytes = 4;
inline constexpr int kMostErrno = 4095;  // the kernel's bound
// Beyond any machine's uptime, and far from where sums of times overflow.
inline constexpr std::int64_t kMostTime = std::int64_t{1} << 60U;

inline constexpr auto kCrcTable = [] {
  constexpr std::uint32_t kPolynomial = 0xEDB88320;
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    table[i] = i;
    for (int bit = 0; bit < 8; ++bit)
      table[i] = table[i] >> 1 ^ (table[i] % 2 == 1 ? kPolynomial : 0);
  }
  return table;
}();
// CRC-32 of these bytes; `before` is that of what precedes them.
constexpr std::uint32_t crc32(std::span<const std::uint8_t> bytes,
                              std::uint32_t before = 0) noexcept {
  std::uint32_t crc = ~before;
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ kCrcTable[(crc ^ byte) & 0xFF];
  return ~crc;
}

enum class EntryKind : std::uint8_t { waited = 1, clock, read, wrote, state, ended, asked };

// The fields of each kind of entry, in their order. The recorder writes what is listed here, by one
// archive, and a recording is read by another.
inline constexpr auto kWaitedFields = [](auto& io, auto& outcome) {
  io.up_to(outcome, ByteStream::Wait::hung_up);
};
inline constexpr auto kClockFields = [](auto& io, auto& ns_since_asked) {
  io.number(ns_since_asked, kMostTime);
};
inline constexpr auto kReadFields = [](auto& io, auto& error, auto& arrived) {
  io.number(error, kMostErrno);
  io.bytes(arrived, kMostTransferBytes);
};
inline constexpr auto kWroteFields = [](auto& io, auto& transfer, auto& offered) {
  io.number(transfer.error, kMostErrno);
  io.number(transfer.count, kMostTransferBytes);
  io.bytes(offered, kMostTransferBytes);
  io.require(transfer.count <= offered.size());
};
inline constexpr auto kStateFields = [](auto& io, auto& state, auto& ns_since_arrival) {
  io.number(ns_since_arrival, kMostTime);
  io.raw(state.tick);
  io.require(state.tick >= -kMostTime && state.tick <= kMostTime);
  io.raw(state.mode);  // as the robot sent it, known or not
  io.up_to(state.remainder, rt::RemainderBelief::lost);
  io.up_to(state.setpoint_lapsed, true);
  io.raw(state.battery_mv);
  for (auto* speeds : {&state.target, &state.set, &state.estimate, &state.command})
    io.raw(speeds->left_mm_s, speeds->right_mm_s);
};
inline constexpr auto kEndedFields = [](auto& io, auto& end) {
  io.up_to(end, CycleEnd::implausible);
};
inline constexpr auto kAskedFields = [](auto& io, auto& request) {
  io.up_to(request.kind, Request::Kind::pose);
  io.raw(request.extras);
  io.require(request.extras.raw() <= kAllExtraLists.raw());
  io.up_to(request.when_long, Request::WhenLong::pause);
  io.list(request.bytes, request.size);
  io.raw(request.pose.x_mm, request.pose.y_mm, request.pose.heading_rad);
};

}  // namespace cargobay::hal
