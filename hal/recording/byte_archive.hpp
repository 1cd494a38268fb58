// Numbers and bytes as a recording has them. A list of fields (hal/recording/recording_format.hpp)
// is told once, and goes through any of three archives, which write it, read it, or find out how
// long it may become:
//
//   raw(values...)         as many bytes as they have, the least first
//   up_to(value, last)     one byte, from 0 to `last`
//   number(value, most)    the form (n), from 0 to `most`
//   bytes(span, most)      how many(n), then these; at most `most`
//   list(array, size)      the same, kept at the front of an array
//   require(condition)     what holds for the fields so far, unless the recording is damaged
//
// (n): unsigned, seven bits a byte, the least first, the top bit set in all but the last.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "rt/nonblocking.hpp"

namespace cargobay::hal {

inline constexpr std::size_t kMostNumberBytes = 10;  // of the form (n): 64 bits

// The unsigned integer of a value's size.
template <typename T>
using Bits = std::conditional_t<
    sizeof(T) == 1, std::uint8_t,
    std::conditional_t<sizeof(T) == 2, std::uint16_t,
                       std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>>>;

template <typename Sink>  // called with bytes
class ByteWriter {
 public:
  explicit ByteWriter(Sink sink) : sink_{sink} {}

  template <typename... T>
  void raw(const T&... values) {
    (put(std::bit_cast<Bits<T>>(values)), ...);
  }
  template <typename T>
  void up_to(const T& value, T /*last*/) {
    put(static_cast<std::uint8_t>(value));
  }
  template <std::integral T>
  void number(T value, std::uint64_t /*most*/) {
    std::uint64_t left = static_cast<std::make_unsigned_t<T>>(value);
    for (; left >= 0x80; left >>= 7U)  // at most nine times
      put(static_cast<std::uint8_t>(left | 0x80U));
    put(static_cast<std::uint8_t>(left));
  }
  void bytes(std::span<const std::uint8_t> bytes, std::size_t most) {
    number(bytes.size(), most);
    sink_(bytes);
  }
  void list(std::span<const std::uint8_t> array, std::uint8_t size) {
    bytes(array.first(size), array.size());
  }
  void require(bool /*condition*/) {}

 private:
  template <std::unsigned_integral T>
  void put(T value) {
    std::array<std::uint8_t, sizeof(T)> bytes{};
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bytes[i] = static_cast<std::uint8_t>(value >> 8 * i);
    sink_(bytes);
  }

  Sink sink_;
};

// Writes to the end of `out`, which must outlive it.
inline auto writer_to(std::vector<std::uint8_t>& out) {
  return ByteWriter{[&out](std::span<const std::uint8_t> bytes) {
    out.insert(out.end(), bytes.begin(), bytes.end());
  }};
}

// Takes values from the front of some bytes. Once too few are left or a value is impossible, it is
// no longer sound, takes no more, and what it gave means nothing.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_{bytes} {}

  bool sound() const { return sound_; }
  std::span<const std::uint8_t> rest() const { return rest_; }

  template <typename... T>
  void raw(T&... values) {
    ((values = std::bit_cast<T>(take<Bits<T>>())), ...);
  }
  template <typename T>
  void up_to(T& value, T last) {
    const auto byte = take<std::uint8_t>();
    require(byte <= static_cast<std::uint8_t>(last));
    if (sound_) value = static_cast<T>(byte);
  }
  template <std::integral T>
  void number(T& value, std::uint64_t most) {
    std::uint64_t all = 0;
    std::uint8_t byte = 0x80;
    for (std::size_t i = 0; byte >= 0x80 && sound_; ++i) {
      byte = take<std::uint8_t>();
      require(i < kMostNumberBytes - 1 || (i == kMostNumberBytes - 1 && byte <= 1));
      if (sound_) all |= std::uint64_t{byte & 0x7FU} << 7 * i;
    }
    require(all <= most);
    if (sound_) value = static_cast<T>(all);
  }
  void bytes(std::span<const std::uint8_t>& bytes, std::size_t most) {
    std::size_t size = 0;
    number(size, most);
    bytes = take(size);
  }
  void list(std::span<std::uint8_t> array, std::uint8_t& size) {
    std::span<const std::uint8_t> bytes;
    this->bytes(bytes, array.size());
    std::ranges::copy(bytes, array.begin());
    size = static_cast<std::uint8_t>(bytes.size());
  }
  void require(bool condition) { sound_ = sound_ && condition; }

  // None if there are not so many.
  std::span<const std::uint8_t> take(std::size_t count) {
    require(count <= rest_.size());
    const auto bytes = rest_.first(sound_ ? count : 0);
    rest_ = rest_.subspan(bytes.size());
    return bytes;
  }

 private:
  template <std::unsigned_integral T>
  T take() {
    T value = 0;
    const auto bytes = take(sizeof(T));
    for (std::size_t i = 0; i < bytes.size(); ++i)
      value = static_cast<T>(value | static_cast<T>(static_cast<T>(bytes[i]) << 8 * i));
    return value;
  }

  std::span<const std::uint8_t> rest_;
  bool sound_ = true;
};

// How many bytes a list of fields takes at most.
class MostBytes {
 public:
  std::size_t count() const { return count_; }

  template <typename... T>
  void raw(const T&... /*values*/) {
    count_ += (sizeof(T) + ...);
  }
  template <typename T>
  void up_to(const T& /*value*/, T /*last*/) {
    ++count_;
  }
  void number(std::integral auto /*value*/, std::uint64_t /*most*/) { count_ += kMostNumberBytes; }
  void bytes(std::span<const std::uint8_t> bytes, std::size_t /*most*/) {
    count_ += kMostNumberBytes + bytes.size();
  }
  void list(std::span<const std::uint8_t> array, std::uint8_t /*size*/) { bytes(array, 0); }
  void require(bool /*condition*/) {}

 private:
  std::size_t count_ = 0;
};

}  // namespace cargobay::hal
