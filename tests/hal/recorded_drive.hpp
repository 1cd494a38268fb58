// A drive of the virtual Create in virtual time, recorded, and its recording as a file.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording.hpp"
#include "hal/recording/recording_stream.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "rt/unchecked.hpp"
#include "tests/hal/damaged_stream.hpp"

namespace cargobay::hal::test {

class RecordedDrive {
 public:
  explicit RecordedDrive(const sim::Parameters& plant = {},
                         std::size_t recorder_bytes = FlightRecorder::kDefaultBytes)
      : device{plant}, link{device}, recorder{recorder_bytes} {}

  // Called once a frame on the control thread.
  std::function<void(int frame)> on_frame{};

  // Drives for `frames` frames, to and fro.
  void run(int frames) {
    frames_left_ = frames;
    EXPECT_TRUE(bring_up(line, {.packets = oi::kCreate.list(oi::FrameList::reading)}));
    EXPECT_FALSE(link.set_wake_threshold(oi::kCreate.frame_bytes));
    RecordingStream recorded{line, recorder};
    const auto cycle = std::make_unique<ControlCycle>(recorded, header.parameters);
    header.baud = link.baud();
    cycle_ = cycle.get();
    cycle->set_control({.function = &RecordedDrive::control_of, .context = this});
    cycle->set_observer({.function = &RecordedDrive::record,
                         .context = this,
                         .request = &RecordedDrive::record_request,
                         .event = &RecordedDrive::record_event});
    end = cycle->run();
    recorder.ended(end);
  }

  // Header and blocks, as in a file.
  std::vector<std::uint8_t> file() const {
    std::vector<std::uint8_t> bytes = encode(header);
    FlightRecorder::Cursor cursor;
    FlightRecorder::Block block;
    while (recorder.next(cursor, block)) {
      const std::vector<std::uint8_t> more = encode(block);
      bytes.insert(bytes.end(), more.begin(), more.end());
    }
    return bytes;
  }

  sim::Device device;
  sim::VirtualLink link;
  DamagedStream line{link};  // undamaged by default
  FlightRecorder recorder;
  RecordingHeader header{.software = "test", .note = "to and fro"};
  CycleEnd end = CycleEnd::asked;
  std::vector<CycleState> states{};
  std::vector<Event> events{};
  // While it runs, for on_frame.
  ControlCycle& cycle() { return *cycle_; }

 private:
  static ControlAnswer control_of(void* context, const CycleState& /*state*/, double seconds)
      CARGOBAY_NONBLOCKING {
    // A test's own function, in virtual time: it may allocate.
    return rt::unchecked([=] { return static_cast<RecordedDrive*>(context)->control(seconds); });
  }
  static void record(void* context, const CycleState& state) CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<RecordedDrive*>(context);
    self.recorder.state(state);
    rt::unchecked([&] { self.states.push_back(state); });
  }
  static void record_event(void* context, const Event& event) CARGOBAY_NONBLOCKING {
    rt::unchecked([&] { static_cast<RecordedDrive*>(context)->events.push_back(event); });
  }
  static void record_request(void* context, const Request& request) CARGOBAY_NONBLOCKING {
    static_cast<RecordedDrive*>(context)->recorder.asked(request);
  }
  rt::WheelSpeeds control(double seconds) {
    if (on_frame) on_frame(++frame_);
    if (--frames_left_ <= 0) cycle_->request_stop();
    const bool forth = static_cast<std::int64_t>(seconds / 3.0) % 2 == 0;
    return forth ? rt::WheelSpeeds{200.0, 150.0} : rt::WheelSpeeds{-100.0, -120.0};
  }

  ControlCycle* cycle_ = nullptr;
  int frames_left_ = 0;
  int frame_ = 0;
};

}  // namespace cargobay::hal::test
