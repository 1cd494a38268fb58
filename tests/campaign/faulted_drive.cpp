#include "tests/campaign/faulted_drive.hpp"

#include <cmath>
#include <memory>
#include <utility>

#include "hal/bring_up/bring_up.hpp"
#include "hal/guard/farewell.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/random.hpp"
#include "hal/sim/robot/pins.hpp"
#include "hal/sim/robot/uart_line.hpp"
#include "hal/stream/spaced_stream.hpp"
#include "rt/unchecked.hpp"
#include "tests/campaign/faulted_stream.hpp"

namespace cargobay::campaign {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

rt::Duration drawn(hal::sim::Random& random, rt::Duration least, rt::Duration most) {
  const auto span_ns = static_cast<double>((most - least).count());
  return least + rt::Duration{static_cast<std::int64_t>(random.uniform() * span_ns)};
}

// Everything in flight from the robot to the host; at a tick, its newest frame last.
std::vector<std::uint8_t> on_the_line(const hal::sim::Device& device) {
  std::vector<std::uint8_t> bytes;
  hal::sim::UartLine line = device.output();
  while (const auto arrival = line.pop(rt::Duration::max(), device.baud())) {
    bytes.push_back(arrival->value);
  }
  return bytes;
}

class FaultedDrive {
 public:
  explicit FaultedDrive(const DriveCase& which)
      : case_{which},
        device_{{.remainder = which.remainder, .seed = which.seed}},
        link_{device_},
        stream_{link_} {
    device_.surroundings = [this](const hal::sim::Device&, const hal::sim::Inputs&) {
      const hal::sim::DeviceFaults& faults = device_.faults();
      robot_faulty_ = faults.garbled_frames > 0 || faults.junk_readings > 0;
    };
    device_.on_tick = [this](const hal::sim::Device&) { see_tick(); };
    device_.on_drive = [this](const hal::sim::DriveRecord& record) {
      if (watching_) seen_.obeyed.push_back(record.tick);
    };
  }

  Observations run() {
    seen_.brought_up = bring_up();
    if (!seen_.brought_up) return std::move(seen_);
    plan();
    first_cycle();
    if (seen_.end != hal::CycleEnd::asked) second_cycle();
    seen_.passive_at_last = device_.mode() == oi::Mode::passive;
    seen_.commanded_at_last = device_.commanded();
    return std::move(seen_);
  }

 private:
  bool bring_up() {
    (void)spaced_.set_wake_threshold(1);  // in range
    return static_cast<bool>(
        hal::bring_up(spaced_, {.packets = oi::kCreate.list(oi::FrameList::reading)}));
  }

  // A robot that was told to wait for something is deaf until that comes.
  bool bring_up_by_toggle() {
    seen_.toggled = true;
    hal::sim::Pins pins{[this](const auto& change) { change(device_); }};
    return static_cast<bool>(
        hal::bring_up(spaced_, {.packets = oi::kCreate.list(oi::FrameList::reading),
                                .pins = {.power_toggle = &pins.power_toggle}}));
  }

  // When the fault begins and ends, and how long to drive after it.
  void plan() {
    hal::sim::Random random{case_.seed};
    const rt::TimePoint begin = stream_.now() + drawn(random, 500ms, 2500ms);
    const rt::TimePoint end = begin + drawn(random, case_.fault.shortest, case_.fault.longest);
    stream_.changes.push_back({.time = begin, .fault = case_.fault.begin});
    if (!case_.fault.end.empty())
      stream_.changes.push_back({.time = end, .fault = case_.fault.end});
    clean_from_ = end + case_.fault.lingers;
    drive_until_ = end + (case_.fault.course == Course::either ? 5s : 3s);
  }

  void first_cycle() {
    stream_.received.clear();
    stream_.drives.clear();
    watching_ = true;
    const auto cycle = make_cycle({.function = &FaultedDrive::first_control, .context = this});
    seen_.end = cycle->run();
    watching_ = false;
    seen_.ended = stream_.now();
    seen_.last_tick = device_.ticks();
    seen_.commanded = device_.commanded();
    seen_.backlog = !on_the_line(device_).empty();
    seen_.frames = cycle->frames();
    hal::CycleState state;
    while (cycle->next_state(state)) seen_.states.push_back(state);
    seen_.received = std::move(stream_.received);
    for (const rt::TimePoint at : stream_.drives) {
      seen_.written.push_back(static_cast<std::uint64_t>(at.time_since_epoch() / oi::kTick));
    }
    leave();
  }

  void second_cycle() {
    seen_.restarted = true;
    wait_for_the_end();
    seen_.brought_up_again = bring_up() || bring_up_by_toggle();
    if (!seen_.brought_up_again) return;
    const auto cycle = make_cycle({.function = &FaultedDrive::second_control, .context = this});
    seen_.second_end = cycle->run();
    seen_.second_frames = cycle->frames();
    leave();
  }

  // A fault that damaged commands may have lasting effects.
  void wait_for_the_end() {
    const rt::TimePoint end = stream_.changes.back().time;
    while (stream_.now() < end && stream_.wait(end) == hal::ByteStream::Wait::ready) {
      stream_.discard_input();
    }
  }

  // Also makes it the cycle_. On the heap: it holds a minute of states.
  std::unique_ptr<hal::ControlCycle> make_cycle(const hal::ControlFunction& control) {
    (void)spaced_.set_wake_threshold(oi::kCreate.frame_bytes);  // in range
    hal::ControlCycle::Parameters parameters;
    parameters.loop.estimator.input_delay_s =
        rt::seconds(oi::wire_time(oi::kCreate.frame_bytes + oi::kDriveDirectBytes, stream_.baud()));
    auto cycle = std::make_unique<hal::ControlCycle>(spaced_, parameters);
    cycle->set_control(control);
    cycle_ = cycle.get();
    return cycle;
  }

  void leave() {
    (void)spaced_.set_wake_threshold(1);  // in range
    (void)hal::farewell(spaced_);         // see_tick() and run() look at the robot itself
  }

  static hal::ControlAnswer first_control(void* context, const hal::CycleState& state,
                                          double seconds) CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<FaultedDrive*>(context);
    // It records on the heap, in virtual time.
    rt::unchecked([&self, &state] { self.see_answer(state); });
    return self.case_.profile->at(seconds);
  }
  static hal::ControlAnswer second_control(void* context, const hal::CycleState& /*state*/,
                                           double /*seconds*/) CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<FaultedDrive*>(context);
    if (++self.second_frames_ == kSecondFrames) self.cycle_->request_stop();
    self.seen_.second_truth = self.truth_;
    return rt::WheelSpeeds{kSecondSpeed, kSecondSpeed};
  }

  void see_answer(const hal::CycleState& state) {
    seen_.answers.push_back({device_.ticks(), state, cycle_->frames()});
    if (stream_.now() >= drive_until_) cycle_->request_stop();
  }

  void see_tick() {
    truth_ = device_.truth().speeds;
    if (!watching_) return;
    const bool frame = device_.counters().frames_sent != frames_sent_;
    seen_.ticks.push_back(
        {.tick = device_.ticks(),
         .frame = frame,
         .clean = frame && !robot_faulty_ && stream_.now() >= clean_from_,
         .waits = device_.bytes_awaited() > 0,
         .mode = device_.mode(),
         .battery_mv = static_cast<std::int32_t>(std::lrint(device_.battery().voltage_mv())),
         .truth = truth_});
    see_sent();
    frames_sent_ = device_.counters().frames_sent;
  }

  void see_sent() {
    const std::uint64_t count = device_.counters().bytes_sent - bytes_sent_;
    bytes_sent_ += count;
    if (!case_.fault.damages_frames || count == 0) return;
    const std::vector<std::uint8_t> line = on_the_line(device_);
    const auto fresh = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(count, line.size()));
    seen_.sent.insert(seen_.sent.end(), line.end() - fresh, line.end());
  }

  DriveCase case_;
  hal::sim::Device device_;
  hal::sim::VirtualLink link_;
  FaultedStream stream_;
  hal::SpacedStream spaced_{stream_};  // as open_port() does
  hal::ControlCycle* cycle_ = nullptr;
  Observations seen_{};
  bool watching_ = false;
  rt::TimePoint clean_from_{};
  rt::TimePoint drive_until_{};
  rt::WheelSpeeds truth_{};
  std::uint64_t frames_sent_ = 0;
  std::uint64_t bytes_sent_ = 0;
  bool robot_faulty_ = false;  // while it makes the frame of this tick
  int second_frames_ = 0;
};

}  // namespace

Observations drive(const DriveCase& which) { return std::make_unique<FaultedDrive>(which)->run(); }

}  // namespace cargobay::campaign
