// Drives the virtual Create in virtual time through the shipping path: bring-up, control cycle,
// leaving.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/cycle/request.hpp"
#include "hal/guard/farewell.hpp"
#include "hal/sensing/sensor_board.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "oi/stream_budget.hpp"
#include "rt/unchecked.hpp"
#include "tests/hal/damaged_stream.hpp"

namespace cargobay::hal::test {

struct Tick {
  CycleState state{};
  rt::WheelSpeeds truth{};  // at the tick of the robot that sent this frame
};

struct DriveResult {
  bool brought_up = false;
  CycleEnd end = CycleEnd::asked;
  bool confirmed_passive = false;
  FrameCounters frames{};
  std::vector<Tick> ticks{};
  std::vector<sim::DriveRecord> commands{};
  std::vector<Event> events{};
  std::uint64_t events_dropped = 0;
  PhaseOverruns overruns{};
  std::uint64_t refused_controls = 0;
  std::uint64_t unsent_commands = 0;
  Hazards causes{};  // of the loss of the mode
};

// A target: straight ahead.
inline rt::WheelSpeeds forward(double /*seconds*/) { return {200.0, 200.0}; }

class VirtualDrive {
 public:
  explicit VirtualDrive(const sim::Parameters& plant) : device{plant}, link{device} {
    device.on_tick = [this](const sim::Device& it) { truth_ = it.truth().speeds; };
    device.on_drive = [this](const sim::DriveRecord& record) {
      result_.commands.push_back(record);
    };
  }

  // Called once a frame on the control thread, before the target is asked for.
  std::function<void(int frame, ControlCycle&)> on_frame{};

  // Drives by `target` (robot time in seconds to wheel speeds) for `frames` frames.
  DriveResult run(int frames, std::function<ControlAnswer(double)> target,
                  ControlCycle::Parameters parameters = {}) {
    target_ = std::move(target);
    frames_left_ = frames;
    const oi::Dialect& dialect = *parameters.dialect;
    const auto report = bring_up(line, {.dialect = &dialect,
                                        .mode = parameters.drive_mode,
                                        .packets = dialect.list(FrameList::reading)});
    result_.brought_up = static_cast<bool>(report);
    if (!report) return result_;
    parameters.loop.estimator.input_delay_s =
        rt::seconds(oi::wire_time(dialect.frame_bytes + oi::kDriveDirectBytes, link.baud()));
    EXPECT_FALSE(link.set_wake_threshold(dialect.frame_bytes));
    const auto cycle = std::make_unique<ControlCycle>(line, parameters);
    cycle_ = cycle.get();
    cycle_->set_control({.function = &VirtualDrive::control_of, .context = this});
    result_.end = cycle_->run();
    EXPECT_FALSE(link.set_wake_threshold(1));
    line.damage = {};
    line.carry = {};
    result_.confirmed_passive =
        farewell(line, {.bytes = cycle_->owed_bytes()}) == Parting::standing;
    expect_one_command_a_tick();
    collect();
    return result_;
  }

  sim::Device device;
  sim::VirtualLink link;
  DamagedStream line{link};  // undamaged by default
  // The rest of a command that was cut may then be sent in the tick of the next one.
  bool cuts_commands = false;

 private:
  // In every drive, whatever else happens to its line. A stop need not wait for a tick.
  void expect_one_command_a_tick() const {
    if (cuts_commands) return;
    std::optional<std::uint64_t> last_tick;
    for (const sim::DriveRecord& record : result_.commands) {
      if (record.command == sim::WheelSpeeds{}) continue;
      EXPECT_NE(last_tick, record.tick) << "two commands in one tick";
      last_tick = record.tick;
    }
  }
  void collect() {
    result_.frames = cycle_->frames();
    result_.overruns = cycle_->overruns();
    result_.refused_controls = cycle_->refused_controls();
    result_.unsent_commands = cycle_->unsent_commands();
    result_.causes = cycle_->mode_loss_causes();
    result_.events_dropped = cycle_->events_dropped();
    Event event;
    while (cycle_->next_event(event)) result_.events.push_back(event);
    CycleState state;
    for (std::size_t i = 0; cycle_->next_state(state) && i < truths_.size(); ++i) {
      result_.ticks.push_back({state, truths_[i]});
    }
  }
  static ControlAnswer control_of(void* context, const CycleState& /*state*/, double seconds)
      CARGOBAY_NONBLOCKING {
    // A test's own function, in virtual time: it may allocate.
    return rt::unchecked(
        [context, seconds] { return static_cast<VirtualDrive*>(context)->control(seconds); });
  }
  ControlAnswer control(double seconds) {
    truths_.push_back(truth_);
    if (on_frame) on_frame(static_cast<int>(truths_.size()), *cycle_);
    if (--frames_left_ <= 0) cycle_->request_stop();
    return target_(seconds);
  }

  std::function<ControlAnswer(double)> target_;
  int frames_left_ = 0;
  ControlCycle* cycle_ = nullptr;
  rt::WheelSpeeds truth_{};
  std::vector<rt::WheelSpeeds> truths_;
  DriveResult result_;
};

inline void expect_stopped(const VirtualDrive& drive) {
  EXPECT_EQ(drive.device.mode(), oi::Mode::passive);
  EXPECT_EQ(drive.device.commanded(), rt::WheelSpeeds{});
}

}  // namespace cargobay::hal::test
