// The memory that the control thread and its guard share. Written by the robot's owner unless noted
// otherwise; both sides must come from the same build (kVersion).
#pragma once

#include <pthread.h>
#include <sys/types.h>
#include <termios.h>

#include <atomic>
#include <chrono>
#include <cstdint>

#include "hal/guard/farewell.hpp"

namespace cargobay::hal {

// How many bytes of what the loop sent may still be queued in the port when the guard takes the
// robot: the loop's own commands and a request. After a larger backlog the stop would come late, so
// the backlog is dropped.
inline constexpr int kMostBacklog = 64;

// How often the guard shows that it lives, and looks after its owner.
inline constexpr std::chrono::milliseconds kGuardBeat{20};
// The same while an owner that tells nothing to move is not driving. Shorter than the silence after
// which the owner gives the guard up.
inline constexpr std::chrono::milliseconds kIdleGuardBeat{200};

// Who has the robot. The only way out of `taken` is `released`, the end.
enum class GuardState : std::uint32_t {
  standing_by,  // brought up, or not driven yet
  driving,      // by a thread that holds `alive` and beats
  leaving,      // by the owner: wheels stopped, on its way to Passive
  guard_lost,   // the same, because the guard showed no sign of life
  handed_over,  // by the owner, to which the robot did not confirm: the guard's turn
  left,         // seen Passive or off, or not to be stopped: only the port remains to be restored
  released,     // by the owner, which closes the port: the guard ends
  taken,        // by the guard: the owner no longer sends anything
};

struct GuardBlock {
  // Changes with every change to this structure.
  static constexpr std::uint64_t kVersion = 0x63617267'6f626107;
  // The descriptors that the guard finds open. The last is the reading end of a pipe whose other
  // end only the owner has: it closes when the owner dies, or becomes another program through
  // execve(2). A byte in it wakes the guard, which looks at the state.
  static constexpr int kPort = 3;
  static constexpr int kBlock = 4;
  static constexpr int kOwner = 5;

  std::uint64_t version = kVersion;
  pid_t owner = 0;
  std::int32_t priority = 0;        // SCHED_FIFO; 0: none
  std::int64_t deadline_ns = 0;     // between two beats
  termios found{};                  // how the port was found, and is to be left
  std::uint32_t found_baud = 0;     // 0 if it is in `found`
  std::uint32_t wanted_baud = 0;    // that the bring-up brings the robot to
  std::int64_t idle_beat_ns = 0;    // while the owner is not driving
  std::atomic<bool> driven{false};  // brought up by then, and at the port's rate

  // Robust and shared between processes. Held by the control thread while it drives: when that
  // thread dies, the kernel reports it to the waiting guard before it takes the process's memory
  // apart (futex(2), robust_list).
  pthread_mutex_t alive{};
  std::atomic<GuardState> state{GuardState::standing_by};
  std::atomic<std::int64_t> beat_ns{0};  // CLOCK_MONOTONIC
  // Bytes being written: the robot may have received part of them.
  std::atomic<std::uint32_t> in_writing{0};
  std::atomic<bool> demo{false};  // one may be running

  // Written by the guard.
  std::atomic<bool> ready{false};
  std::atomic<bool> done{false};                       // with a robot that it took
  std::atomic<std::int64_t> guard_beat_ns{0};          // CLOCK_MONOTONIC, once a beat at least
  std::atomic<Parting> parting{Parting::unconfirmed};  // once it has taken the robot
};
static_assert(std::atomic<GuardState>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

}  // namespace cargobay::hal
