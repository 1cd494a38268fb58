// The latest value of something, from one writing thread to any number of reading threads.
//
// A sequence lock over atomic words: writing is wait-free, never blocks on a reader, and costs one
// store per word. Reading retries while a write is in progress. Free of data races in the C++
// memory model, and so under ThreadSanitizer: the words themselves are atomic (H. Boehm, "Can
// seqlocks get along with programming language memory models?", 2012).
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

template <typename T>
class Mailbox {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  // From one thread only. Wait-free.
  void put(const T& value) CARGOBAY_NONBLOCKING {
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    const auto* from = reinterpret_cast<const unsigned char*>(&value);
#pragma GCC unroll 64  // halves its time: tests/bench/cycle_bench.cpp, mailbox_put
    for (std::size_t i = 0; i < kWords; ++i) {
      std::uint64_t word = 0;
      std::memcpy(&word, from + i * sizeof word,
                  std::min(sizeof word, sizeof(T) - i * sizeof word));
      // Release: whoever sees this word also sees the odd sequence number before it.
      words_[i].store(word, std::memory_order_release);
    }
    sequence_.store(sequence + 2, std::memory_order_release);  // pairs with the first load of get()
  }

  // From any thread. Nothing if no value has been put yet. Lock-free: retries during a put.
  std::optional<T> get() const CARGOBAY_NONBLOCKING {
    std::array<std::uint64_t, kWords> words{};
    for (;;) {
      const std::uint64_t before =
          sequence_.load(std::memory_order_acquire);  // pairs with put()'s last store
      if (before == 0) return std::nullopt;
      for (std::size_t i = 0; i < kWords; ++i) {
        words[i] = words_[i].load(std::memory_order_acquire);  // pairs with the stores of the words
      }
      if (before % 2 == 0 && sequence_.load(std::memory_order_relaxed) == before) break;
    }
    T value{};
    std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
    return value;
  }

 private:
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;
  std::atomic<std::uint64_t> sequence_{0};  // odd while a value is being put
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace cargobay::rt
