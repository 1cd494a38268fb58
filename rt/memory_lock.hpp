// Memory that stays resident, so that touching it takes no page fault: as much as the kernel
// allows, but never so much that a later allocation fails because of it, the program's own
// included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <system_error>
#include <vector>

#include "rt/rights.hpp"

namespace cargobay::rt {

using Memory = std::span<const std::byte>;

// Call all functions from one thread.
class MemoryLock {
 public:
  enum class Extent : std::uint8_t {
    none,
    needed,  // what was asked for, and as much of the program's code as fits
    all,     // of the process: what is there now, or also what comes later
  };

  MemoryLock() = default;
  // Unlocks what was locked piece by piece, except the code. All of the process is unlocked by the
  // last that locked it, unless the program had locked memory of its own before the first.
  ~MemoryLock() { unlock(); }
  MemoryLock(const MemoryLock&) = delete;
  MemoryLock& operator=(const MemoryLock&) = delete;

  // Locks and touches `needed`, and more of the process if that does no harm:
  // - without a limit, all of it, later allocations included;
  // - with a limit that CAP_IPC_LOCK lifts, all that is there now. Not what comes later: a program
  //   that gives up its rights would then get no memory beyond the limit. For the same reason the
  //   stack of the main thread may still grow;
  // - with a limit that holds, `needed`, and as much of this library's code as fits into three
  //   quarters of the limit.
  // Call once. If it fails, nothing is locked. Blocks until the memory is there;
  // allocates.
  [[nodiscard]] std::error_code lock(const std::vector<Memory>& needed, const Rights& rights);
  // Pages at either end that another lock shares stay locked.
  void unlock();

  Extent extent() const { return extent_; }
  std::size_t bytes() const { return bytes_; }  // of `needed`, in whole pages

 private:
  std::error_code lock_pieces(const std::vector<Memory>& needed, std::uint64_t limit);

  Extent extent_ = Extent::none;
  std::size_t bytes_ = 0;
  std::vector<Memory> pieces_{};
};

}  // namespace cargobay::rt
