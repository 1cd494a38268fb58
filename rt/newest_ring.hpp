// The newest values of something, numbered from 1, from any thread to any number of others, who
// take none away from each other: each says which number it has seen, and asks for the next.
//
// A sequence lock for each slot, over atomic words, as in rt/mailbox.hpp. Putting never waits for
// a reader, and two threads that put at once meet only if one of them was held up while the others
// put a whole ring full: then a value is dropped, which its missing number shows.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

#include "rt/nonblocking.hpp"

namespace cargobay::rt {

template <typename T, std::size_t kCapacity>
class NewestRing {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(std::has_single_bit(kCapacity), "the capacity is a power of two");

 public:
  using Number = std::int64_t;
  struct Entry {
    Number number = 0;
    T value{};
  };

  // From any thread. Lock-free. Returns its number, 1 for the first.
  Number put(const T& value) CARGOBAY_NONBLOCKING {
    const Number number = last_.fetch_add(1, std::memory_order_relaxed) + 1;
    Slot& slot = slots_[index(number)];
    std::uint64_t version = slot.version.load(std::memory_order_relaxed);
    // Odd: its writer was held up for a whole round. Acquire pairs with the release below.
    if (version % 2 == 1 ||
        !slot.version.compare_exchange_strong(version, version + 1, std::memory_order_acquire,
                                              std::memory_order_relaxed)) {
      return number;
    }
    const Entry entry{.number = number, .value = value};
    const auto* from = reinterpret_cast<const unsigned char*>(&entry);
    for (std::size_t i = 0; i < kWords; ++i) {
      std::uint64_t word = 0;
      std::memcpy(&word, from + i * sizeof word,
                  std::min(sizeof word, sizeof(Entry) - i * sizeof word));
      slot.words[i].store(word, std::memory_order_release);  // as in rt/mailbox.hpp
    }
    slot.version.store(version + 2, std::memory_order_release);  // pairs with get()
    return number;
  }

  // The number given out last; 0: none.
  Number last() const CARGOBAY_NONBLOCKING { return last_.load(std::memory_order_acquire); }

  // From any thread. The newest that is complete; nothing if there is none. Lock-free.
  std::optional<Entry> newest() const CARGOBAY_NONBLOCKING {
    const Number last = this->last();
    const Number oldest = std::max<Number>(last - static_cast<Number>(kCapacity), 0);
    for (Number number = last; number > oldest; --number) {
      if (const std::optional<Entry> entry = at(number)) return entry;
    }
    return std::nullopt;
  }

  // From any thread. The first that is there after number `after`, and complete; nothing if there
  // is none. Lock-free: retries while a slot is written.
  std::optional<Entry> next(Number after) const CARGOBAY_NONBLOCKING {
    constexpr auto kRoom = static_cast<Number>(kCapacity);
    const Number last = this->last();
    if (after >= last) return std::nullopt;
    // What is still being put while half a ring has followed it counts as dropped.
    for (Number number = std::max(after + 1, last - kRoom + 1); number <= last; ++number) {
      const std::optional<Entry> entry = at(number);
      if (entry && entry->number >= number) return entry;
      if (last - number < kRoom / 2) return std::nullopt;
    }
    return std::nullopt;
  }

 private:
  static constexpr std::size_t kWords = (sizeof(Entry) + 7) / 8;
  struct Slot {
    std::atomic<std::uint64_t> version{0};  // odd while it is written
    std::array<std::atomic<std::uint64_t>, kWords> words{};
  };

  static std::size_t index(Number number) CARGOBAY_NONBLOCKING {
    return static_cast<std::size_t>(number) % kCapacity;
  }

  // What is in the slot of this number; nothing if it was never written.
  std::optional<Entry> at(Number number) const CARGOBAY_NONBLOCKING {
    const Slot& slot = slots_[index(number)];
    std::array<std::uint64_t, kWords> words{};
    for (int tries = 0; tries < kTries; ++tries) {
      const std::uint64_t before = slot.version.load(std::memory_order_acquire);
      if (before == 0) return std::nullopt;
      for (std::size_t i = 0; i < kWords; ++i) {
        words[i] = slot.words[i].load(std::memory_order_acquire);
      }
      if (before % 2 == 0 && slot.version.load(std::memory_order_relaxed) == before) {
        Entry entry{};
        std::memcpy(static_cast<void*>(&entry), words.data(), sizeof entry);
        return entry;
      }
    }
    return std::nullopt;  // its writer was held up in the middle
  }

  static constexpr int kTries = 100;

  std::atomic<Number> last_{0};
  std::array<Slot, kCapacity> slots_{};
};

}  // namespace cargobay::rt
