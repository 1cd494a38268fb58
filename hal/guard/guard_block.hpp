// The memory that the control thread and its guard share. Written by the owner of the robot, but
// for what says otherwise; both are of one build (kVersion).
#pragma once

#include <pthread.h>
#include <sys/types.h>
#include <termios.h>

#include <atomic>
#include <chrono>
#include <cstdint>

#include "hal/guard/farewell.hpp"

namespace cargobay::hal {

// Of what the loop has sent so many bytes may still wait in the port when the guard takes the
// robot: its own commands and a request. Behind more the stop would come late, and the rest is
// dropped.
inline constexpr int kMostBacklog = 64;

// The guard shows as often that it lives.
inline constexpr std::chrono::milliseconds kGuardBeat{20};

// Who has the robot. From `taken` there is no way back but to `released`, the end.
enum class GuardState : std::uint32_t {
  standing_by,  // brought up, or not driven yet
  driving,      // by a thread that holds `alive` and beats
  leaving,      // by the owner: wheels stopped, on its way to Passive
  guard_lost,   // the same, because the guard gave no sign of life
  handed_over,  // by the owner, to whom the robot did not confirm: the guard's turn
  left,         // seen Passive or off, or not to be stopped: only the port is to be put back
  released,     // by the owner, who closes the port: the guard ends
  taken,        // by the guard: the owner sends nothing any more
};

struct GuardBlock {
  // Changes with each change of this structure.
  static constexpr std::uint64_t kVersion = 0x63617267'6f626106;
  // What the guard finds open. The last is the reading end of a pipe whose other end is the owner's
  // alone: it ends when the owner dies, or becomes another program by execve(2).
  static constexpr int kPort = 3;
  static constexpr int kBlock = 4;
  static constexpr int kOwner = 5;

  std::uint64_t version = kVersion;
  pid_t owner = 0;
  std::int32_t priority = 0;        // SCHED_FIFO; 0: none
  std::int64_t deadline_ns = 0;     // between two beats
  termios found{};                  // how the port was found, and is to be left
  std::uint32_t found_baud = 0;     // 0 where it is in `found`
  std::uint32_t wanted_baud = 0;    // that the bring-up brings the robot to
  std::atomic<bool> driven{false};  // brought up by then, and at the port's rate

  // Robust and shared between processes. Held by the control thread while it drives: the kernel
  // tells whoever waits for it that the thread is no more, before it takes the process's memory
  // apart (futex(2), robust_list).
  pthread_mutex_t alive{};
  std::atomic<GuardState> state{GuardState::standing_by};
  std::atomic<std::int64_t> beat_ns{0};  // CLOCK_MONOTONIC
  // Bytes that are being written: the robot may have got a part of them.
  std::atomic<std::uint32_t> in_writing{0};
  std::atomic<bool> demo{false};  // one may be running

  // By the guard.
  std::atomic<bool> ready{false};
  std::atomic<bool> done{false};                       // with a robot that it took
  std::atomic<std::int64_t> guard_beat_ns{0};          // CLOCK_MONOTONIC, every kGuardBeat at least
  std::atomic<Parting> parting{Parting::unconfirmed};  // once it has taken the robot
};
static_assert(std::atomic<GuardState>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

}  // namespace cargobay::hal
