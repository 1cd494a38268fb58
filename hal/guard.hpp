// A small process of its own that has the port's last word. Where the thread that drives dies, by
// whatever cause, or gives no sign of life for too long, the guard completes a half-sent command,
// stops the wheels and makes the robot Passive. It acts once, and never while the thread beats;
// from then on nothing of the thread reaches the robot.
//
// The process is `cargobay-guard`. No signal handler is installed here, and no thread started; the
// guard is a child of this process, which collects it in release(). It is its own session, ignores
// the signals that end programs, and is not held up by what this process does: an image of its own,
// its own locked memory, a higher priority.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <memory>
#include <string>

#include "hal/byte_stream.hpp"
#include "hal/guard_block.hpp"
#include "hal/guard_mark.hpp"
#include "hal/result.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

struct GuardOptions {
  enum class Use : std::uint8_t { required, none };
  Use use = Use::required;
  // Without a sign of life for so long the thread is taken for hung; 40 ms at least, since the loop
  // itself wakes every 15 to 20 ms. As long as the loop waits for a silent robot, by default.
  rt::Duration deadline = std::chrono::milliseconds{150};
  // The program; where empty $CARGOBAY_GUARD, or `cargobay-guard` beside the running program, in
  // the folder above it, or where it is installed.
  std::string program{};
};

class Guard {
 public:
  static constexpr rt::Duration kLeastDeadline = std::chrono::milliseconds{40};

  // Starts the process over the stream's terminal, which outlives the guard, and waits until it is
  // ready: some ms, 2 s at most. `priority` is the control thread's SCHED_FIFO priority, 0 where it
  // has none. Allocates.
  static Result<std::unique_ptr<Guard>> start(const ByteStream::Terminal& terminal,
                                              const GuardOptions& options, int priority);
  // Releases.
  ~Guard();
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  // The control thread, around the cycle: from the first to the second the guard watches that very
  // thread.
  void begin_driving();
  void end_driving();
  GuardMark mark() { return GuardMark{*block_}; }

  // For the owner, once the thread has ended. Whether the guard took the robot; waits until it has
  // finished with it, 1 s at most.
  [[nodiscard]] bool took_robot();
  bool confirmed_passive() const;
  // The robot was left in Passive: the guard ends, and is collected.
  void release();

  // Whether the process is there. From any thread; one system call.
  [[nodiscard]] bool alive() const;

 private:
  explicit Guard(GuardBlock* block) : block_{block} {}
  bool wait_until_ready() const;
  void collect();

  GuardBlock* block_;  // a mapping of its own
  pid_t process_ = -1;
};

}  // namespace cargobay::hal
