// Characters into a caller's buffer, one after another: no heap, never past the end.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "oi/text/text_slice.hpp"

namespace cargobay::oi {

class TextWriter {
 public:
  constexpr explicit TextWriter(std::span<char> out) : out_{out} {}

  // What has been written, cut off at the end of the buffer.
  constexpr std::string_view text() const { return {out_.data(), size_}; }
  constexpr std::size_t size() const { return size_; }
  // False once something did not fit.
  constexpr bool fits() const { return fits_; }
  constexpr void clear() {
    size_ = 0;
    fits_ = true;
  }

  constexpr void put(std::string_view text) {
    const std::size_t count = std::min(text.size(), out_.size() - size_);
    std::copy_n(text.begin(), count, out_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += count;
    if (count < text.size()) fits_ = false;
  }
  constexpr void put_number(std::int64_t number) {
    std::array<char, 20> digits{};
    std::size_t at = digits.size();
    std::uint64_t left =
        number < 0 ? 0 - static_cast<std::uint64_t>(number) : static_cast<std::uint64_t>(number);
    do {
      digits[--at] = static_cast<char>('0' + left % 10);
      left /= 10;
    } while (left != 0);
    if (number < 0) put("-");
    put({digits.data() + at, digits.size() - at});
  }
  // Two digits, lower case.
  constexpr void put_hex(std::uint8_t byte) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    put(slice(kDigits, byte >> 4U, 1));
    put(slice(kDigits, byte & 0xfU, 1));
  }

 private:
  std::span<char> out_;
  std::size_t size_ = 0;
  bool fits_ = true;
};

}  // namespace cargobay::oi
