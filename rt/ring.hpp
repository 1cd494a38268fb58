// A queue of fixed capacity from one thread to one other, wait-free at both ends. A value that does
// not fit is dropped and counted: the writer never waits.
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

template <typename T, std::size_t kCapacity>
class SpscRing {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(std::has_single_bit(kCapacity), "the capacity is a power of two");

 public:
  // From the writing thread. If the ring is full: false, and one more dropped.
  bool push(const T& value) CARGOBAY_NONBLOCKING {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    // Acquire pairs with pop()'s release: the slot has been read before it is written again.
    if (head - tail_.load(std::memory_order_acquire) == kCapacity) {
      dropped_.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    slots_[head % kCapacity] = value;
    head_.store(head + 1, std::memory_order_release);  // pairs with pop()'s acquire
    return true;
  }

  // From the reading thread. False if the ring is empty.
  bool pop(T& value) CARGOBAY_NONBLOCKING {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_.load(std::memory_order_acquire)) return false;
    value = slots_[tail % kCapacity];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  // From the reading thread.
  bool empty() const CARGOBAY_NONBLOCKING {
    return tail_.load(std::memory_order_relaxed) == head_.load(std::memory_order_acquire);
  }

  // Values that found the ring full; from any thread.
  std::uint64_t dropped() const CARGOBAY_NONBLOCKING {
    return dropped_.load(std::memory_order_relaxed);
  }

 private:
  static constexpr std::size_t kCacheLine = 64;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
  alignas(kCacheLine) std::atomic<std::uint64_t> dropped_{0};
  std::array<T, kCapacity> slots_{};
};

}  // namespace cargobay::rt
