// The links of one drive: if the port is lost and comes back, the drive goes on. This sums them up.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/cli/drive/drive_log.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sensing/events.hpp"
#include "hal/sim/line/server.hpp"
#include "rt/clock.hpp"
#include "rt/histogram.hpp"

namespace cargobay::cli {

// Collects what each cycle and the virtual Create report. Ticks are counted on from link to link,
// as if there had been no gap.
class DriveLinks {
 public:
  // `server` may be null; it must outlive this.
  explicit DriveLinks(hal::sim::Server* server) : server_{server} {}

  // Follows `robot`, which has just been started, until end_link().
  void begin_link(hal::Robot& robot);
  // Takes what has arrived; call it now and then while the robot runs.
  void collect();
  // Call it when the robot has stopped running, before it is destroyed.
  void end_link();

  std::int64_t ticks() const { return states_.empty() ? 0 : states_.back().tick; }
  const std::vector<hal::CycleState>& states() const { return states_; }
  std::vector<DriveSample> samples() const { return join(states_, truth_); }
  const std::vector<hal::Event>& events() const { return events_; }
  std::uint64_t events_dropped() const { return events_dropped_; }
  const hal::FrameCounters& frames() const { return frames_; }
  const hal::PhaseOverruns& overruns() const { return overruns_; }
  std::uint64_t refused_controls() const { return refused_controls_; }
  const rt::Histogram& period_ns() const { return period_ns_; }
  const rt::Histogram& frame_to_command_ns() const { return frame_to_command_ns_; }
  int reconnects() const { return reconnects_; }
  // From the last frame of a link to the start of the next: in total, and for the latest gap.
  rt::Duration without() const { return without_; }
  rt::Duration latest_without() const { return latest_without_; }

 private:
  hal::sim::Server* server_;
  hal::Robot* robot_ = nullptr;
  std::int64_t ticks_before_ = 0;  // of the links before this
  rt::TimePoint last_heard_{};
  std::vector<hal::CycleState> states_;
  std::vector<hal::sim::TruthSample> truth_;
  std::vector<hal::Event> events_;
  std::uint64_t events_dropped_ = 0;
  hal::FrameCounters frames_{};
  hal::PhaseOverruns overruns_{};
  std::uint64_t refused_controls_ = 0;
  rt::Histogram period_ns_{};
  rt::Histogram frame_to_command_ns_{};
  int reconnects_ = -1;  // the first link does not count
  rt::Duration without_{0};
  rt::Duration latest_without_{0};
};

}  // namespace cargobay::cli
