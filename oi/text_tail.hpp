// The last printable bytes seen between frames: what a robot that is off, booting or charging
// says about itself.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace cargobay::oi {

constexpr bool is_text(std::uint8_t byte) {
  return (byte >= 0x20 && byte < 0x7f) || byte == '\r' || byte == '\n';
}

class TextTail {
 public:
  static constexpr std::size_t kCapacity = 256;

  constexpr void push(std::uint8_t byte) noexcept {
    bytes_[pushed_ % kCapacity] = static_cast<char>(byte);
    ++pushed_;
  }
  // How many bytes have ever been pushed.
  constexpr std::uint64_t pushed() const { return pushed_; }
  // Copies the last of them, oldest first, as many as there are and fit. Returns how many.
  constexpr std::size_t copy(std::span<char> out) const {
    std::uint64_t count = std::min<std::uint64_t>(pushed_, kCapacity);
    count = std::min<std::uint64_t>(count, out.size());
    for (std::size_t i = 0; i < count; ++i) out[i] = bytes_[(pushed_ - count + i) % kCapacity];
    return static_cast<std::size_t>(count);
  }

 private:
  std::array<char, kCapacity> bytes_{};
  std::uint64_t pushed_ = 0;
};

}  // namespace cargobay::oi
