#include "hal/recording/recording_format.hpp"

namespace cargobay::hal {
namespace {

constexpr std::array<std::uint32_t, 256> crc_table() {
  constexpr std::uint32_t kPolynomial = 0xEDB88320;
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ (value % 2 == 1 ? kPolynomial : 0);
    table[i] = value;
  }
  return table;
}

constexpr std::array<std::uint32_t, 256> kCrcTable = crc_table();

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t before) noexcept {
  std::uint32_t crc = ~before;
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ kCrcTable[(crc ^ byte) & 0xFF];
  return ~crc;
}

bool ByteReader::take_short(std::uint64_t& value) {
  constexpr unsigned kMostBytes = 10;  // of 64 bits
  value = 0;
  for (unsigned i = 0; i < kMostBytes; ++i) {
    std::uint8_t byte = 0;
    if (!take(byte)) return false;
    const std::uint64_t bits = byte & 0x7FU;
    if (i == kMostBytes - 1 && bits > 1) return false;
    value |= bits << 7 * i;
    if (byte < 0x80) return true;
  }
  return false;
}

}  // namespace cargobay::hal
