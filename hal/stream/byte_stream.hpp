// The one virtual interface of the HAL: bytes to and from a robot, and the clock they go by. A real
// port, a pseudo-terminal and the virtual Create in virtual time are all of this kind; nothing
// above it asks which.
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
    timed_out,  // the deadline passed; fewer bytes than the threshold may be there
    hung_up,    // the other side is gone, and stays gone
  };
  struct Transfer {
    std::size_t count = 0;  // bytes moved; 0 with error 0 where nothing was there
    int error = 0;          // errno, 0 where nothing failed
  };

  // For the control thread. None of these allocates or locks.
  // Blocks until bytes are there or the deadline, on this stream's clock, has passed.
  virtual Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING = 0;
  // What has arrived, up to the size of `bytes`; does not block.
  virtual Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING = 0;
  // Queues all of `bytes` or, where the queue is full, the first of them; does not block.
  virtual Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING = 0;
  virtual rt::TimePoint now() const CARGOBAY_NONBLOCKING = 0;
  // Whether what is written still goes to the port that was opened: a program may close the
  // descriptors of its libraries, and open files under the same numbers. One system call, for
  // writes that do not answer a frame that was just read from the port.
  virtual bool still_open() const CARGOBAY_NONBLOCKING { return true; }

  // The terminal that the bytes go through, for a guard to share (hal/guard/guard.hpp); -1 where
  // there is none.
  struct Terminal {
    int descriptor = -1;
    const PortLock* lock = nullptr;
  };
  virtual Terminal terminal() const { return {}; }

  // A stream that does the same as long as the rate stays, with nothing in between that is not
  // needed at this rate: for a loop, which asks once and not in each cycle.
  virtual ByteStream& at_this_rate() { return *this; }

  // For set-up and shutdown; these may block and allocate.
  virtual std::uint32_t baud() const = 0;
  // After an error the former rate holds.
  [[nodiscard]] virtual std::error_code set_baud(std::uint32_t baud) = 0;
  // wait() reports ready when this many bytes are there (1 to 255): one wake-up a frame.
  [[nodiscard]] virtual std::error_code set_wake_threshold(std::size_t bytes) = 0;
  // Drops what has arrived and was not read.
  virtual void discard_input() = 0;
  // Blocks until all that was written has left, or `timeout` has passed (false).
  [[nodiscard]] virtual bool drain(rt::Duration timeout) = 0;
  // Lets so much of this stream's time pass; what arrives meanwhile stays.
  virtual void sleep(rt::Duration duration) = 0;
};

}  // namespace cargobay::hal
