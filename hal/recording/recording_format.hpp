// The bytes of a recording: what the flight recorder keeps in memory and `cargobay drive --record`
// writes to a file. Version 1; all numbers are little endian, times are nanoseconds.
//
//   file    header, then blocks up to the end
//   header  magic(8) version(2) length of the rest(4) rest CRC-32(4)
//           rest: baud(4) start, since 1970 UTC(8) software(text) note(text) the parameters of the
//           control cycle, in the order of hal/recording/recording_header.cpp
//           text: length(2) UTF-8
//   block   length of the entries(4) number(4) time(8) entries CRC-32(4)
//           number: from 0, one more for each; if one is missing, the recording has a gap
//           time: what the clock last said before the block; only differences mean anything
//   entry   kind(1) and
//           waited  outcome(1): 0 ready, 1 timed out, 2 hung up
//           clock   nanoseconds since the clock was last asked(n)
//           read    errno(n) count(n) the bytes that had arrived
//           wrote   errno(n) bytes taken(n) bytes offered(n) the bytes offered
//           state   nanoseconds since its arrival(n) tick(8) mode(1) remainder(1) lapsed(1)
//                   battery in mV(4) target, set, estimate, command: left and right(8 each), IEEE
//           ended   why(1), as enum class CycleEnd
//           asked   for what(1), which extra lists(1), what if long(1): hal/cycle/request.hpp;
//                   count(n) the bytes of a command; x, y, heading(8 each, IEEE)
//           (n): unsigned, seven bits a byte, the least first, the top bit set in all but the last
//
// A CRC-32 is that of Ethernet and zip, over everything before it in its header or block.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// The last four bytes are there to be spoilt by anything that takes the file for text.
inline constexpr std::array<std::uint8_t, 8> kRecordingMagic{'C',  'B',  'R',  'E',
                                                             '\r', '\n', 0x1A, '\n'};
inline constexpr std::uint16_t kRecordingVersion = 1;
inline constexpr std::size_t kMostHeaderBytes = 65536;  // of its rest
inline constexpr std::size_t kBlockHeadBytes = 16;
inline constexpr std::size_t kMostBlockBytes = 2048;     // of its entries
inline constexpr std::size_t kMostTransferBytes = 1024;  // of one read or write
inline constexpr std::size_t kChecksumBytes = 4;

enum class EntryKind : std::uint8_t { waited = 1, clock, read, wrote, state, ended, asked };

// CRC-32 of these bytes; `before` is that of what precedes them.
std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t before = 0) noexcept;

template <std::unsigned_integral T>
constexpr std::array<std::uint8_t, sizeof(T)> little_endian(T value) CARGOBAY_NONBLOCKING {
  std::array<std::uint8_t, sizeof(T)> bytes{};
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = static_cast<std::uint8_t>(value >> 8 * i);
  return bytes;
}

// Takes values from the front of some bytes. Each function returns false, with nothing to rely on,
// if too few bytes are left or their value is impossible.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_{bytes} {}

  std::span<const std::uint8_t> rest() const { return rest_; }

  template <std::unsigned_integral T>
  [[nodiscard]] bool take(T& value) {
    std::span<const std::uint8_t> bytes;
    if (!take(sizeof(T), bytes)) return false;
    value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[i]) << 8 * i));
    return true;
  }
  [[nodiscard]] bool take(std::int32_t& value) { return take_as<std::uint32_t>(value); }
  [[nodiscard]] bool take(std::int64_t& value) { return take_as<std::uint64_t>(value); }
  [[nodiscard]] bool take(double& value) { return take_as<std::uint64_t>(value); }
  [[nodiscard]] bool take(bool& value) {
    std::uint8_t byte = 0;
    if (!take(byte) || byte > 1) return false;
    value = byte == 1;
    return true;
  }
  // An enumerator from 0 to `last`.
  template <typename T>
    requires std::is_enum_v<T>
  [[nodiscard]] bool take(T& value, T last) {
    std::uint8_t byte = 0;
    if (!take(byte) || byte > static_cast<std::uint8_t>(last)) return false;
    value = static_cast<T>(byte);
    return true;
  }
  [[nodiscard]] bool take(std::size_t count, std::span<const std::uint8_t>& bytes) {
    if (count > rest_.size()) return false;
    bytes = rest_.first(count);
    rest_ = rest_.subspan(count);
    return true;
  }
  // A number of the form (n).
  [[nodiscard]] bool take_short(std::uint64_t& value);

 private:
  template <typename Bits, typename T>
  bool take_as(T& value) {
    Bits bits = 0;
    if (!take(bits)) return false;
    value = std::bit_cast<T>(bits);
    return true;
  }

  std::span<const std::uint8_t> rest_;
};

}  // namespace cargobay::hal
