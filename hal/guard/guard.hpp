// A small separate process that has the last word on the port. It begins before the first byte of a
// bring-up, and ends when the robot has been seen Passive or off, or when the port is gone for its
// own descriptor too. If the program or the thread that drives dies or hangs, or if the robot did
// not confirm to them that it is Passive, the guard completes a half-sent command, stops the wheels
// and makes the robot Passive. It acts once, and never while the thread beats; from then on nothing
// from the thread reaches the robot. The thread in turn watches the guard
// (hal/guard/guard_mark.hpp).
//
// The process is `cargobay-guard`. No signal handler is installed and no thread started in this
// process; the guard is its child, which release() collects. The guard has its own session, ignores
// the signals that end programs, and cannot be held up by what this process does: it has its own
// image, its own locked memory and a higher priority.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <memory>
#include <span>
#include <string>

#include "hal/file/port_descriptor.hpp"
#include "hal/guard/farewell.hpp"
#include "hal/guard/guard_block.hpp"
#include "hal/guard/guard_mark.hpp"
#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

struct GuardOptions {
  enum class Use : std::uint8_t { required, none };
  Use use = Use::required;
  // After this long without a sign of life, the thread counts as hung. At least 40 ms, since the
  // loop itself wakes only every 15 to 20 ms. The default is how long the loop waits for a silent
  // robot.
  rt::Duration deadline = std::chrono::milliseconds{150};
  // `nothing`: the owner tells the robot nothing that moves it, and does not drive. The guard then
  // looks after it every 200 ms instead of every 20; it still learns of its death at once, unless a
  // forked child of the owner keeps the owner's descriptors.
  enum class Moves : std::uint8_t { anything, nothing };
  Moves moves = Moves::anything;
  std::string program{};  // as for guard_program() (hal/guard/guard_program.hpp)
};

class Guard {
 public:
  // Starts the process on the stream's terminal, which must outlive the guard, and waits until it
  // is ready: some ms, 2 s at most. `priority` is the control thread's SCHED_FIFO priority, 0 if it
  // has none. `baud` is the rate that the bring-up brings the robot to. Allocates.
  static Result<std::unique_ptr<Guard>> start(const ByteStream::Terminal& terminal,
                                              const GuardOptions& options, int priority,
                                              std::uint32_t baud);
  // Releases.
  ~Guard();
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;

  // For the control thread, around the cycle: between the two calls the guard watches the calling
  // thread.
  void begin_driving();
  void end_driving();
  // For the owner, in place of a control thread that never reaches end_driving(): from now on the
  // guard leaves the robot to the owner, unless it has already taken it.
  void take_over();
  // Whether the guard has taken the robot, and may still be busy with it. From any thread; no
  // system call.
  [[nodiscard]] bool has_taken() const;
  GuardMark mark() { return GuardMark{*block_, process_}; }
  // The memory that the control thread touches; valid as long as the guard.
  std::span<const std::byte> memory() const { return std::as_bytes(std::span{block_, 1}); }

  // The robot is being told to run a demo, which must be aborted in the end.
  void expect_demo() { block_->demo.store(true, std::memory_order_release); }

  // For the owner, once the thread has ended or been given up. Whether the guard took the robot;
  // waits until the guard has finished with it, 4 s at most.
  [[nodiscard]] bool took_robot();
  // The robot did not confirm: tells the guard to stop it now. Waits for that, 4 s at most. After
  // this call, this process must send nothing.
  Parting hand_over();
  // How that ended.
  Parting parting() const;
  // The robot stands, or should not be stopped: if this program dies now, the guard only restores
  // the port's settings.
  void robot_is_left();
  // The port is about to be closed: the guard ends and is collected.
  void release();

  // Whether the process exists. From any thread; one system call.
  [[nodiscard]] bool alive() const;

 private:
  explicit Guard(GuardBlock* block) : block_{block} {}
  bool wait_until_ready() const;
  bool beats() const;
  void wait_until_done() const;
  void collect();
  void wake() const;

  GuardBlock* block_;  // a mapping of its own, which forked children do not get
  pid_t process_ = -1;
  PortDescriptor owner_{};    // the owner's end of the pipe that ends with this program
  PortDescriptor watched_{};  // the guard's end: a write after the guard's death is not a SIGPIPE
};

}  // namespace cargobay::hal
