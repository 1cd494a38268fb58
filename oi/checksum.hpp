// The checksum that ends a stream frame: it makes the low byte of a sum zero (OI p. 14).
//
// The manual leaves the header 19 out of that sum; real robots include it.
#pragma once

#include <cstdint>
#include <span>

namespace cargobay::oi {

enum class Checksum : std::uint8_t {
  including_header,  // what real robots send
  excluding_header,  // what the manual describes
  automatic,         // for a decoder: whichever the robot is found to use
};

// The low byte of the sum.
constexpr std::uint8_t byte_sum(std::span<const std::uint8_t> bytes) {
  std::uint32_t sum = 0;
  for (const std::uint8_t byte : bytes) sum += byte;
  return static_cast<std::uint8_t>(sum);
}

// The checksum that ends a frame of these bytes, header to last data byte, at least one. Automatic
// counts as including the header.
constexpr std::uint8_t checksum_of(std::span<const std::uint8_t> bytes, Checksum form) {
  const auto summed = form == Checksum::excluding_header ? bytes.subspan(1) : bytes;
  return static_cast<std::uint8_t>(0x100U - byte_sum(summed));
}

// Whether a whole frame, header to checksum, ends in the checksum of that form; automatic: of
// either form. No frame matches both.
constexpr bool checksum_matches(std::span<const std::uint8_t> frame, Checksum form) {
  const std::uint8_t sum = byte_sum(frame);
  const bool including = sum == 0;
  const bool excluding = sum == frame[0];
  switch (form) {
    case Checksum::including_header: return including;
    case Checksum::excluding_header: return excluding;
    case Checksum::automatic: return including || excluding;
  }
  return false;
}

}  // namespace cargobay::oi
