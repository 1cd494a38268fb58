// Where a control cycle leaves what other threads read.
#pragma once

#include <cstddef>
#include <cstdint>

#include "hal/cycle/cycle_state.hpp"
#include "hal/sensing/events.hpp"
#include "hal/sensing/sensor_board.hpp"
#include "rt/clock.hpp"
#include "rt/histogram.hpp"
#include "rt/learnt_plant.hpp"
#include "rt/mailbox.hpp"
#include "rt/nonblocking.hpp"
#include "rt/ring.hpp"

namespace cargobay::hal {

// Written by the control thread, without waiting; a comment on each member says who may read it.
struct CycleOutlets {
  static constexpr std::size_t kHistory = 4096;  // about a minute of states

  void publish(const CycleState& now, const CycleCounters& counted) CARGOBAY_NONBLOCKING {
    counters.put(counted);
    state.put(now);
    history.push(now);
  }
  void report(const Event& event) CARGOBAY_NONBLOCKING {
    (void)events.push(event);  // the ring counts what it drops
  }

  SensorBoard board{};                           // any thread
  rt::Mailbox<CycleState> state{};               // any thread
  rt::Mailbox<CycleCounters> counters{};         // any thread
  rt::Mailbox<rt::LearntPlant> learnt{};         // any thread
  rt::Histogram period_ns{};                     // snapshots, any thread
  rt::Histogram frame_to_command_ns{};           // the same
  rt::SpscRing<CycleState, kHistory> history{};  // one other thread
  EventRing events{};                            // one other thread
};

}  // namespace cargobay::hal
