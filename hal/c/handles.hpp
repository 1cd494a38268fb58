// Handles that C programs hold: numbers that look like pointers and are never followed. One that
// was closed, is of another kind, or belongs to the process that this one was forked from is
// recognised as such.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "rt/nonblocking.hpp"

namespace cargobay::c {

// How often this process was forked, counted in the children.
std::uint32_t forks() CARGOBAY_NONBLOCKING;
void count_forks();

// What a handle refers to; a part of its number.
enum class HandleKind : std::uint8_t { none, robot, sim, histogram };

// A pointer has 32 bits on the smaller Pi: 1 marks a handle, 6 are the slot, 2 the kind, the rest
// the generation.
inline constexpr unsigned kSlotBits = 6;
inline constexpr unsigned kKindBits = 2;

// Accepts any pointer; `none` if it is not a handle. Whether it is open does not matter.
constexpr HandleKind kind_of(std::uintptr_t handle) CARGOBAY_NONBLOCKING {
  // Odd: never a pointer to anything.
  if ((handle & 1U) == 0) return HandleKind::none;
  return static_cast<HandleKind>((handle >> 1U >> kSlotBits) % (1U << kKindBits));
}

template <typename Object, HandleKind kKind>
class HandleTable {
  struct Slot {
    // Generation (32), open (1), uses under way (31).
    std::atomic<std::uint64_t> word{0};
    std::atomic<Object*> object{nullptr};
    std::atomic<std::uint32_t> forks{0};
  };

 public:
  static constexpr std::size_t kMost = std::size_t{1} << kSlotBits;

  // The object of a handle, which is not freed while this lives. Empty if the handle is not an open
  // one.
  class Use {
   public:
    Use() = default;
    Use(Slot* slot, Object* object, std::size_t index) noexcept
        : slot_{slot}, object_{object}, index_{index} {}
    ~Use() { end(); }
    Use(Use&& other) noexcept
        : slot_{std::exchange(other.slot_, nullptr)},
          object_{other.object_},
          index_{other.index_} {}
    Use& operator=(Use&& other) noexcept {
      if (this == &other) return *this;
      end();
      slot_ = std::exchange(other.slot_, nullptr);
      object_ = other.object_;
      index_ = other.index_;
      return *this;
    }
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

    explicit operator bool() const CARGOBAY_NONBLOCKING { return slot_ != nullptr; }
    Object* operator->() const CARGOBAY_NONBLOCKING { return object_; }
    Object& operator*() const CARGOBAY_NONBLOCKING { return *object_; }
    std::size_t index() const CARGOBAY_NONBLOCKING { return index_; }

   private:
    void end() CARGOBAY_NONBLOCKING {
      // Pairs with the wait in close(): everything done to the object happens before.
      if (slot_ != nullptr) slot_->word.fetch_sub(1, std::memory_order_release);
      slot_ = nullptr;
    }

    Slot* slot_ = nullptr;
    Object* object_ = nullptr;
    std::size_t index_ = 0;
  };

  // Null if kMost are open already. From then on the table owns the object.
  void* open(std::unique_ptr<Object> object) {
    count_forks();
    const std::lock_guard lock{opening_};
    for (std::size_t i = 0; i < kMost; ++i) {
      Slot& slot = slots_[i];
      const std::uint64_t word = slot.word.load(std::memory_order_acquire);
      // A slot that the parent left open is not for this process to reuse.
      if ((word & (kOpen | kUses)) != 0 || slot.object.load(std::memory_order_relaxed) != nullptr)
        continue;
      const std::uint64_t generation = (word >> kGenerationShift) % kMostGeneration + 1;
      slot.object.store(object.release(), std::memory_order_relaxed);
      slot.forks.store(forks(), std::memory_order_relaxed);
      // Pairs with use(): a thread that sees the slot open sees the object.
      slot.word.store(generation << kGenerationShift | kOpen, std::memory_order_release);
      return handle(generation, i);
    }
    return nullptr;
  }

  // Lock-free.
  Use use(const void* handle) CARGOBAY_NONBLOCKING {
    std::size_t index = 0;
    std::uint64_t generation = 0;
    if (!read(handle, index, generation)) return {};
    Slot& slot = slots_[index];
    std::uint64_t word = slot.word.load(std::memory_order_relaxed);
    do {
      if (word >> kGenerationShift != generation || (word & kOpen) == 0) return {};
      // Acquire pairs with open().
    } while (!slot.word.compare_exchange_weak(word, word + 1, std::memory_order_acquire,
                                              std::memory_order_relaxed));
    Use use{&slot, slot.object.load(std::memory_order_relaxed), index};
    if (slot.forks.load(std::memory_order_relaxed) != forks()) return {};
    return use;
  }

  // Closes the handle at once. Calls `end` on the object, then waits until no thread uses it any
  // longer, and hands it over. Null if the handle is not an open one. If `end` returns false, a
  // thread that may never come back is using the object: that is not waited for, and the object
  // must not be freed.
  template <typename End>
  std::unique_ptr<Object> close(const void* handle, const End& end) {
    Use use = this->use(handle);
    if (!use) return nullptr;
    Slot& slot = slots_[use.index()];
    if ((slot.word.fetch_and(~kOpen, std::memory_order_relaxed) & kOpen) == 0) return nullptr;
    const bool ended = end(*use);
    std::unique_ptr<Object> object{&*use};
    use = Use{};
    // Acquire pairs with the end of each use.
    while (ended && (slot.word.load(std::memory_order_acquire) & kUses) != 0) {
      std::this_thread::sleep_for(std::chrono::microseconds{100});
    }
    slot.object.store(nullptr, std::memory_order_release);
    return object;
  }

 private:
  static constexpr unsigned kGenerationShift = 32;
  static constexpr std::uint64_t kOpen = std::uint64_t{1} << 31U;
  static constexpr std::uint64_t kUses = kOpen - 1;
  static constexpr unsigned kGenerationBits = 22;
  static constexpr std::uint64_t kMostGeneration = (1U << kGenerationBits) - 1;

  static void* handle(std::uint64_t generation, std::size_t index) noexcept {
    const auto kind = static_cast<std::uintptr_t>(kKind);
    const auto number = static_cast<std::uintptr_t>(generation) << kKindBits | kind;
    // NOLINTNEXTLINE(performance-no-int-to-ptr): never followed
    return reinterpret_cast<void*>((number << kSlotBits | index) << 1U | 1U);
  }
  static bool read(const void* handle, std::size_t& index, std::uint64_t& generation)
      CARGOBAY_NONBLOCKING {
    const auto number = reinterpret_cast<std::uintptr_t>(handle);
    index = (number >> 1U) % kMost;
    generation = number >> 1U >> kSlotBits >> kKindBits;
    return kind_of(number) == kKind;
  }

  std::mutex opening_;
  std::array<Slot, kMost> slots_{};
};

}  // namespace cargobay::c
