// Memory that stays where it is, so that who touches it takes no page fault: as much as the kernel
// allows, and never so that a later allocation fails for it, the program's own included.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rt/rights.hpp"

namespace cargobay::rt {

using Memory = std::span<const std::byte>;

// All functions from one thread.
class MemoryLock {
 public:
  enum class Extent : std::uint8_t {
    none,
    needed,  // what was asked for, and of the program's code what fits
    all,     // of the process, at present or from now on
  };

  MemoryLock() = default;
  // Unlocks what was locked piece by piece, but for the code.
  ~MemoryLock() { unlock(); }
  MemoryLock(const MemoryLock&) = delete;
  MemoryLock& operator=(const MemoryLock&) = delete;

  // Locks and touches `needed`, and more of the process where that harms nobody:
  // - without a limit all of it, what is allocated later included;
  // - with a limit that CAP_IPC_LOCK lifts, all that is there now. Not what comes later: a program
  //   that gives up its rights would then get no memory beyond the limit. For the same reason the
  //   stack of the main thread may still grow;
  // - with a limit that holds, `needed`, and this library's code as far as three quarters of the
  //   limit go.
  // Returns an errno; nothing is locked then. Blocks until the memory is there; allocates. Once.
  [[nodiscard]] int lock(const std::vector<Memory>& needed, const Rights& rights);
  // What other locks have of the same pages at either end stays locked.
  void unlock();

  Extent extent() const { return extent_; }
  std::size_t bytes() const { return bytes_; }  // of `needed`: in whole pages

 private:
  int lock_pieces(const std::vector<Memory>& needed, std::uint64_t limit);

  Extent extent_ = Extent::none;
  std::size_t bytes_ = 0;
  std::vector<Memory> pieces_{};
};

}  // namespace cargobay::rt
