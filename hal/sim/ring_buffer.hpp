// A queue that allocates once: no heap after construction. For one thread.
#pragma once

#include <cassert>
#include <cstddef>
#include <vector>

namespace cargobay::hal::sim {

template <typename T>
class RingBuffer {
 public:
  // `capacity` is not 0.
  explicit RingBuffer(std::size_t capacity) : slots_(capacity) { assert(capacity != 0); }

  std::size_t capacity() const { return slots_.size(); }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  bool full() const { return size_ == slots_.size(); }

  // False if it is full; nothing changes then.
  [[nodiscard]] bool push_back(const T& element) {
    if (full()) return false;
    slots_[wrapped(size_)] = element;
    ++size_;
    return true;
  }
  void pop_front() {
    assert(!empty());
    first_ = wrapped(1);
    --size_;
  }
  void pop_back() {
    assert(!empty());
    --size_;
  }
  void clear() {
    first_ = 0;
    size_ = 0;
  }

  // Counted from the oldest element.
  const T& operator[](std::size_t index) const {
    assert(index < size_);
    return slots_[wrapped(index)];
  }
  T& operator[](std::size_t index) {
    assert(index < size_);
    return slots_[wrapped(index)];
  }
  const T& front() const { return (*this)[0]; }
  const T& back() const { return (*this)[size_ - 1]; }
  T& back() { return (*this)[size_ - 1]; }

 private:
  std::size_t wrapped(std::size_t index) const {
    const std::size_t sum = first_ + index;
    return sum < slots_.size() ? sum : sum - slots_.size();
  }

  std::vector<T> slots_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

}  // namespace cargobay::hal::sim
