#include "hal/cli/drive/drive_links.hpp"

namespace cargobay::cli {

void DriveLinks::begin_link(hal::Robot& robot) {
  const rt::TimePoint now = rt::Clock::now();
  if (++reconnects_ > 0) {
    latest_without_ = now - last_heard_;
    without_ += latest_without_;
  }
  robot_ = &robot;
  ticks_before_ = ticks();
  last_heard_ = now;
}

void DriveLinks::collect() {
  hal::CycleState state;
  while (robot_->cycle().next_state(state)) {
    last_heard_ = state.arrival;
    state.tick += ticks_before_;
    states_.push_back(state);
  }
  hal::Event event;
  while (robot_->next_event(event)) {
    event.tick += ticks_before_;
    events_.push_back(event);
  }
  if (server_ != nullptr) server_->take_truth(truth_);
}

void DriveLinks::end_link() {
  collect();
  const hal::ControlCycle& cycle = robot_->cycle();
  const hal::FrameCounters& frames = cycle.frames();
  frames_.good += frames.good;
  frames_.bad += frames.bad;
  frames_.lost += frames.lost;
  frames_.late += frames.late;
  const hal::PhaseOverruns& overruns = cycle.overruns();
  overruns_.wait += overruns.wait;
  overruns_.read += overruns.read;
  overruns_.user += overruns.user;
  overruns_.write += overruns.write;
  refused_controls_ += cycle.refused_controls();
  events_dropped_ += cycle.events_dropped();
  period_ns_.merge(cycle.period_ns());
  frame_to_command_ns_.merge(cycle.frame_to_command_ns());
  robot_ = nullptr;
}

}  // namespace cargobay::cli
