// The far end of a line without a robot: sends a frame each period, on absolute time, and reads the
// command that answers it. Like a robot, it streams the list that it is told to, and does not wait:
// if a frame is not answered before the next is due, the next answer counts for its wait too.
#pragma once

#include <atomic>
#include <cstdint>

#include "hal/jitter/channel.hpp"

namespace cargobay::hal::jitter {

// When the measured thread did what; only that thread writes, in this order, the count last.
struct Stamps {
  std::atomic<std::int64_t> woken_ns{0};
  std::atomic<std::int64_t> decided_ns{0};
  std::atomic<std::int64_t> written_ns{0};
  std::atomic<std::uint64_t> answers{0};
};

// The source's two ends of the line; they may be one descriptor, and are non-blocking.
struct Line {
  int to_measured = -1;
  int from_measured = -1;
};

// Frames delayed on purpose, to check that the report shows it.
struct HeldFrame {
  std::size_t every = 0;  // every Nth; 0: none
  rt::Duration by{};      // how long after it is complete it is handed over
};

// Sends `settings.warm_up + settings.slice_frames` frames on the calling thread, which should have
// real-time rights; ends early if `stop` is set. `recorder` gets each answered frame.
void send_frames(const Line& line, const Settings& settings, const HeldFrame& held, Stamps& stamps,
                 Recorder& recorder, const std::atomic<bool>& stop);

}  // namespace cargobay::hal::jitter
