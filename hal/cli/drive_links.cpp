#include "hal/cli/drive_links.hpp"

namespace cargobay::cli {

void DriveLinks::begin_link(hal::ControlCycle& cycle) {
  const rt::TimePoint now = rt::Clock::now();
  if (++reconnects_ > 0) {
    latest_without_ = now - last_heard_;
    without_ += latest_without_;
  }
  cycle_ = &cycle;
  ticks_before_ = ticks();
  last_heard_ = now;
}

void DriveLinks::collect() {
  hal::CycleState state;
  while (cycle_->next_state(state)) {
    last_heard_ = state.arrival;
    state.tick += ticks_before_;
    states_.push_back(state);
  }
  hal::Event event;
  while (cycle_->next_event(event)) {
    event.tick += ticks_before_;
    events_.push_back(event);
  }
  if (server_ != nullptr) server_->take_truth(truth_);
}

void DriveLinks::end_link() {
  collect();
  const hal::FrameCounters& frames = cycle_->frames();
  frames_.good += frames.good;
  frames_.bad += frames.bad;
  frames_.lost += frames.lost;
  frames_.late += frames.late;
  const hal::PhaseOverruns& overruns = cycle_->overruns();
  overruns_.wait += overruns.wait;
  overruns_.read += overruns.read;
  overruns_.user += overruns.user;
  overruns_.write += overruns.write;
  refused_controls_ += cycle_->refused_controls();
  events_dropped_ += cycle_->events_dropped();
  period_ns_.merge(cycle_->period_ns());
  frame_to_command_ns_.merge(cycle_->frame_to_command_ns());
  cycle_ = nullptr;
}

}  // namespace cargobay::cli
