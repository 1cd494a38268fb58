// What a control thread leaves for a feed, without knowing who reads it or whether anybody does.
#pragma once

#include <cstddef>

#include "hal/cycle/cycle_state.hpp"
#include "hal/sensing/event_log.hpp"
#include "rt/newest_ring.hpp"
#include "rt/nonblocking.hpp"
#include "rt/realtime.hpp"

namespace cargobay::hal {

class FeedTap {
 public:
  static constexpr std::size_t kStates = 256;  // four seconds

  // For RobotOptions::observers; this must outlive the robot. Wait-free, no system call.
  StateObserver observer() {
    return {.function =
                [](void* tap, const CycleState& state)
                    CARGOBAY_NONBLOCKING { (void)static_cast<FeedTap*>(tap)->states_.put(state); },
            .context = this,
            .event = [](void* tap, const Event& event)
                         CARGOBAY_NONBLOCKING { static_cast<FeedTap*>(tap)->events_.put(event); }};
  }
  // To be locked with the loop's.
  rt::Memory memory() const { return {reinterpret_cast<const std::byte*>(this), sizeof *this}; }

  // For any thread.
  const rt::NewestRing<CycleState, kStates>& states() const { return states_; }
  const EventLog& events() const { return events_; }

 private:
  rt::NewestRing<CycleState, kStates> states_{};
  EventLog events_{};
};

}  // namespace cargobay::hal
