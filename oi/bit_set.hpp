// Bits of one byte, each named by an enumerator whose value is the bit's number.
#pragma once

#include <cstdint>

namespace cargobay::oi {

template <typename Flag>
class BitSet {
 public:
  constexpr BitSet() = default;
  constexpr explicit BitSet(std::uint8_t raw) : raw_{raw} {}

  constexpr std::uint8_t raw() const { return raw_; }
  constexpr bool has(Flag flag) const { return (raw_ & mask(flag)) != 0; }
  constexpr bool any() const { return raw_ != 0; }
  // This set with the flag added.
  constexpr BitSet with(Flag flag) const {
    return BitSet{static_cast<std::uint8_t>(raw_ | mask(flag))};
  }
  constexpr BitSet without(Flag flag) const {
    return BitSet{static_cast<std::uint8_t>(raw_ & ~mask(flag))};
  }
  friend constexpr bool operator==(BitSet, BitSet) = default;
  friend constexpr BitSet operator&(BitSet a, BitSet b) {
    return BitSet{static_cast<std::uint8_t>(a.raw_ & b.raw_)};
  }

 private:
  static constexpr std::uint8_t mask(Flag flag) {
    return static_cast<std::uint8_t>(1U << static_cast<unsigned>(flag));
  }
  std::uint8_t raw_ = 0;
};

}  // namespace cargobay::oi
