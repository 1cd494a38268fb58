// A list with room for a fixed number of elements, kept in place: no heap. A contiguous range, so
// it converts to std::span by itself.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <span>

namespace cargobay::oi {

template <typename T, std::size_t kCapacity>
class FixedList {
 public:
  using value_type = T;

  constexpr FixedList() = default;

  static constexpr std::size_t capacity() { return kCapacity; }
  constexpr std::size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr bool full() const { return size_ == kCapacity; }

  // False, with nothing changed, if the list is full.
  [[nodiscard]] constexpr bool push_back(const T& element) {
    if (full()) return false;
    elements_[size_++] = element;
    return true;
  }
  // False, with nothing changed, if they do not all fit.
  [[nodiscard]] constexpr bool append(std::span<const T> elements) {
    if (elements.size() > kCapacity - size_) return false;
    std::copy(elements.begin(), elements.end(),
              elements_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += elements.size();
    return true;
  }
  constexpr void clear() { size_ = 0; }

  constexpr const T& operator[](std::size_t index) const {
    assert(index < size_);
    return elements_[index];
  }
  constexpr T& operator[](std::size_t index) {
    assert(index < size_);
    return elements_[index];
  }
  constexpr const T* data() const { return elements_.data(); }
  constexpr const T* begin() const { return elements_.data(); }
  constexpr const T* end() const { return elements_.data() + size_; }

  friend constexpr bool operator==(const FixedList& a, const FixedList& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  std::array<T, kCapacity> elements_{};
  std::size_t size_ = 0;
};

// Makes a list of the elements; their number must fit at compile time.
template <typename T, std::size_t kCapacity, typename... Elements>
constexpr FixedList<T, kCapacity> list_of(Elements... elements) {
  static_assert(sizeof...(Elements) <= kCapacity);
  FixedList<T, kCapacity> list;
  ((void)list.push_back(static_cast<T>(elements)), ...);  // cannot be full: asserted above
  return list;
}

}  // namespace cargobay::oi
