// The one virtual interface of the HAL: bytes to and from a robot, and the clock they go by. A real
// port, a pseudo-terminal and the virtual Create in virtual time all implement it; nothing above
// needs to know which.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <system_error>

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

class PortLock;

class ByteStream {
 public:
  ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  virtual ~ByteStream() = default;

  enum class Wait : std::uint8_t {
    ready,      // at least the wake threshold can be read
    timed_out,  // the deadline passed; fewer bytes than the threshold may have arrived
    hung_up,    // the other side is gone and will not come back
    left,       // not over: in virtual time, while another stream moves it; wait again
  };
  struct Transfer {
    std::size_t count = 0;  // bytes moved; 0 with error 0 if there was nothing to move
    int error = 0;          // errno; 0 if nothing failed
  };

  // For the control thread. None of these allocates or locks.
  // Blocks until bytes have arrived or the deadline, on this stream's clock, has passed.
  virtual Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING = 0;
  // What has arrived, up to the size of `bytes`; does not block.
  virtual Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING = 0;
  // Queues all of `bytes`, or the first of them if the queue is full; does not block.
  virtual Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING = 0;
  virtual rt::TimePoint now() const CARGOBAY_NONBLOCKING = 0;
  // Whether writes still go to the port that was opened: a program may close the descriptors of its
  // libraries and open files under the same numbers. One system call, for writes that do not answer
  // a frame just read from the port.
  virtual bool still_open() const CARGOBAY_NONBLOCKING { return true; }

  // The terminal that the bytes go through, for a guard to share (hal/guard/guard.hpp); -1 if there
  // is none.
  struct Terminal {
    int descriptor = -1;
    const PortLock* lock = nullptr;
  };
  virtual Terminal terminal() const { return {}; }

  // A stream that does the same while the rate does not change, without any layer that this rate
  // does not need: for a loop, which asks once and not in each cycle.
  virtual ByteStream& at_this_rate() { return *this; }

  // For set-up and shutdown; these may block and allocate.
  virtual std::uint32_t baud() const = 0;
  // After an error the previous rate still applies.
  [[nodiscard]] virtual std::error_code set_baud(std::uint32_t baud) = 0;
  // wait() reports ready when this many bytes have arrived (1 to 255): one wake-up per frame.
  [[nodiscard]] virtual std::error_code set_wake_threshold(std::size_t bytes) = 0;
  // Drops what has arrived and has not been read.
  virtual void discard_input() = 0;
  // Blocks until all that was written has left, or until `timeout` has passed (false).
  [[nodiscard]] virtual bool drain(rt::Duration timeout) = 0;
  // Sets an output of the port that a pin of the robot may be wired to. Asserted is 0 V at a TTL
  // cable. From the first call on, the port keeps the level when it is closed. After an error, such
  // as ENOTTY of a pseudo-terminal, which has none, nothing has changed.
  enum class ModemLine : std::uint8_t { rts, dtr };
  [[nodiscard]] virtual std::error_code set_modem_line(ModemLine line, bool asserted) {
    (void)line;
    (void)asserted;
    return std::make_error_code(std::errc::inappropriate_io_control_operation);
  }
  // Lets `duration` pass on this stream's clock; what arrives meanwhile is kept.
  virtual void sleep(rt::Duration duration) = 0;
};

}  // namespace cargobay::hal
