// A terminal device taken for this process alone.
#pragma once

#include <termios.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "hal/file/port_descriptor.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

class PortLock {
 public:
  // Opens `path`, without waiting for the device, and locks it before changing anything: by
  // flock(), which keeps out root too, and by TIOCEXCL, which keeps out programs that do not check
  // for locks. If only a guard has the port, because it is stopping the robot of a program that
  // died, waits until it has finished, 6 s at most. If no process can be seen to have it, it may
  // have been released meanwhile: tries again for 0.2 s. A failure leaves the port as it was.
  static Result<std::unique_ptr<PortLock>> take(const std::string& path);
  // Sets the port as it was found, and releases it; does nothing if the descriptor is no longer the
  // port's.
  ~PortLock();
  PortLock(const PortLock&) = delete;
  PortLock& operator=(const PortLock&) = delete;

  int descriptor() const { return descriptor_.number(); }
  // Whether descriptor() is still the port's. One system call.
  bool still_open() const noexcept { return descriptor_.still_open(); }
  const termios& found() const { return found_; }
  std::optional<std::uint32_t> found_speed() const { return found_speed_; }
  // RTS and DTR keep their levels when the last descriptor of the port is closed, also after the
  // port is set as it was found: a pin of the robot hangs on one of them.
  [[nodiscard]] std::error_code keep_modem_lines();
  // For a library that opens the port itself: no longer locked, until hand_over(). libserialport
  // locks by flock() too, from 0.1.2 on, and our lock would be in its way.
  void let_go() const;
  // Moves the lock and descriptor() to this other open file of the port. Fails with
  // EBUSY if another process got in between. `descriptor` stays open, and still belongs to its
  // library.
  [[nodiscard]] std::error_code hand_over(int descriptor);

 private:
  static Result<std::unique_ptr<PortLock>> take_now(const std::string& path);
  explicit PortLock(PortDescriptor descriptor) : descriptor_{std::move(descriptor)} {}
  std::error_code lock();

  PortDescriptor descriptor_;
  bool ours_ = false;
  termios found_{};  // how the port was found and will be left
  std::optional<std::uint32_t> found_speed_{};
};

// One line for an error from opening the port.
Failure cannot_open(const std::string& path, std::error_code error);

}  // namespace cargobay::hal
