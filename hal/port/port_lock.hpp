// A terminal device taken for this process alone.
#pragma once

#include <termios.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "hal/file/port_descriptor.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

class PortLock {
 public:
  // Opens `path`, without waiting for the device, and locks it before anything of it is touched: by
  // flock(), which stops root too, and by TIOCEXCL, which stops those who do not ask. If nobody but
  // a guard has it, which is stopping the robot of a program that died, waits until that is done, 6
  // s at most; if nobody can be seen to have it, which may have let it go meanwhile, asks again for
  // 0.2 s. A failure leaves the port as it was.
  static Result<std::unique_ptr<PortLock>> take(const std::string& path);
  // The port is set as it was found, and free again; nothing is done if the descriptor is no longer
  // the port's.
  ~PortLock();
  PortLock(const PortLock&) = delete;
  PortLock& operator=(const PortLock&) = delete;

  int descriptor() const { return descriptor_.number(); }
  // Whether that still is the port's. One system call.
  bool still_open() const noexcept { return descriptor_.still_open(); }
  const termios& found() const { return found_; }
  std::optional<std::uint32_t> found_speed() const { return found_speed_; }
  // For a library that opens the port itself: not locked any more, until hand_over(). libserialport
  // locks by flock() too, from 0.1.2 on, and would find us in its way.
  void let_go() const;
  // The lock, and descriptor(), are from now on of this other open file of the port: 0, or an
  // errno, EBUSY where somebody came in between. `descriptor` stays open, and its library's.
  [[nodiscard]] int hand_over(int descriptor);

 private:
  static Result<std::unique_ptr<PortLock>> take_now(const std::string& path);
  explicit PortLock(PortDescriptor descriptor) : descriptor_{std::move(descriptor)} {}
  int lock();  // returns an errno

  PortDescriptor descriptor_;
  bool ours_ = false;
  termios found_{};  // how the port was found, and is left
  std::optional<std::uint32_t> found_speed_{};
};

// One line for an errno of opening the port.
Failure cannot_open(const std::string& path, int error);

}  // namespace cargobay::hal
