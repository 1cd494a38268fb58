// A terminal's descriptor as a byte stream: what pseudo-terminals and serial ports have in common,
// and all that the control thread calls. Opening and setting up the port is done elsewhere.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>

#include "hal/port/port_lock.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::hal {

class TtyStream : public ByteStream {
 public:
  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override;
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override;
  bool still_open() const CARGOBAY_NONBLOCKING override;

  Terminal terminal() const override { return {.descriptor = descriptor_, .lock = lock_.get()}; }
  std::uint32_t baud() const override { return baud_; }
  std::error_code set_baud(std::uint32_t baud) override;
  std::error_code set_wake_threshold(std::size_t bytes) override;
  std::error_code set_modem_line(ModemLine line, bool asserted) override;
  void discard_input() override;
  bool drain(rt::Duration timeout) override;
  void sleep(rt::Duration duration) override;

 protected:
  // The descriptor belongs to the lock. Without a lock (in the guard), the process has no other,
  // and nothing else closes it.
  TtyStream(int descriptor, std::uint32_t baud, std::unique_ptr<PortLock> lock)
      : lock_{std::move(lock)}, descriptor_{descriptor}, baud_{baud} {}
  int descriptor() const { return descriptor_; }
  // Sets the driver's rate. Returns the driver's error.
  virtual std::error_code apply_baud(std::uint32_t baud) = 0;

 private:
  std::unique_ptr<PortLock> lock_;
  int descriptor_;
  std::uint32_t baud_;
};

}  // namespace cargobay::hal
