// The far end of a line without a robot: sends a frame each period, on absolute time, and looks for
// the command that answers it. Like a robot it streams the list that it is told to, and does not
// wait: a frame that is not answered before the next is due leaves its wait to the next answer.
#pragma once

#include <atomic>
#include <cstdint>

#include "hal/jitter/channel.hpp"

namespace cargobay::hal::jitter {

// When the measured thread did what; it alone writes, in this order, and counts last.
struct Stamps {
  std::atomic<std::int64_t> woken_ns{0};
  std::atomic<std::int64_t> decided_ns{0};
  std::atomic<std::int64_t> written_ns{0};
  std::atomic<std::uint64_t> answers{0};
};

// Both ends of the line that the source has; they may be one descriptor, and do not block.
struct Line {
  int to_measured = -1;
  int from_measured = -1;
};

// A frame that is held back on purpose, so that the report can be held against it.
struct HeldFrame {
  std::size_t every = 0;  // each so manieth; 0: none
  rt::Duration by{};      // longer than its time: so much later than it was complete at the source
};

// Sends `settings.warm_up + settings.slice_frames` frames on the calling thread, which should have
// real-time rights; ends early where `stop` is set. `recorder` gets each answered frame.
void send_frames(const Line& line, const Settings& settings, const HeldFrame& held, Stamps& stamps,
                 Recorder& recorder, const std::atomic<bool>& stop);

}  // namespace cargobay::hal::jitter
