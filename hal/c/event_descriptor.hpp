// A descriptor to poll, which says that there is something to look at.
#pragma once

#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <mutex>

#include "hal/file/port_descriptor.hpp"
#include "rt/nonblocking.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::c {

class EventDescriptor {
 public:
  // The number; made at the first call. Negative: errno. From any thread; locks.
  int number() {
    const std::lock_guard lock{making_};
    if (made_.load(std::memory_order_relaxed)) return descriptor_.number();
    const int made = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (made < 0) return -errno;
    descriptor_ = hal::PortDescriptor::adopt(made);
    made_.store(true, std::memory_order_release);
    return descriptor_.number();
  }

  // Makes it readable. Does nothing if nobody has asked for it, or if the program closed it: its
  // number may be another file's by now. From any thread; does not block.
  void signal() const CARGOBAY_NONBLOCKING {
    if (!made_.load(std::memory_order_acquire)) return;
    rt::unchecked([this]() noexcept {
      constexpr std::uint64_t kOne = 1;
      if (descriptor_.still_open()) (void)!write(descriptor_.number(), &kOne, sizeof kOne);
    });
  }

 private:
  std::mutex making_;
  hal::PortDescriptor descriptor_{};
  std::atomic<bool> made_{false};
};

}  // namespace cargobay::c
