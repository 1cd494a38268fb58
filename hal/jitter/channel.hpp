// What the timing-jitter benchmark measures, one thing per channel: the control loop on a robot,
// the control loop on frames that come as fast as wanted, and for comparison the best that the same
// kernel can do: a bare answer through a pseudo-terminal, the same through a pipe, and a sleep.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.hpp"
#include "rt/clock.hpp"
#include "rt/histogram.hpp"
#include "rt/nonblocking.hpp"
#include "rt/realtime.hpp"

namespace cargobay::hal::jitter {

// Instants on the way of one frame, each counted from the moment the frame was complete: handed to
// the kernel as a whole or, on a robot, its last byte received over the wire.
enum class Stage : std::uint8_t {
  woken,    // the thread that waits for it runs again; for a sleep: from when it was due
  decided,  // the user's control function is called
  written,  // the command has been given to the kernel
  arrived,  // the command's last byte has reached the other end
};
inline constexpr std::array kStages{Stage::woken, Stage::decided, Stage::written, Stage::arrived};
std::string_view name(Stage stage);

// What one slice gave. The channels take turns, slice by slice, so that whatever else the machine
// does affects them all.
struct Slice {
  // Of the channel's own stage, in order, as measured. In float, because there are millions: exact
  // to 16 ms, and to 1 part in 16 million beyond.
  std::vector<float> headline_ns{};
};

struct Measured {
  std::string name{};
  Stage headline = Stage::written;  // the figure that represents the channel
  rt::Duration period{};
  std::uint64_t frames = 0;  // answered
  std::uint64_t missed = 0;  // not answered in time: the next answer is for them too
  std::array<rt::Histogram, kStages.size()> stages{};    // corrected for coordinated omission
  std::array<bool, kStages.size()> seen{};               // which of them this channel has
  std::array<std::uint64_t, kStages.size()> least_ns{};  // of each, as measured
  rt::Histogram raw{};                                   // the headline's, as measured
  rt::Histogram interval_ns{};                           // between two answers
  std::vector<Slice> slices{};

  const rt::Histogram& headline_ns() const { return stages[static_cast<std::size_t>(headline)]; }
};

struct Settings {
  rt::Duration period = std::chrono::milliseconds{1};  // of the channels that have no robot
  int priority = 80;
  // Of the measured thread, and of the far end of a line without a robot. If threads may migrate, a
  // wake-up on the same processor takes half as long as one on another: two slices would differ by
  // more than the effect of interest. Nothing if there is only one processor.
  std::optional<int> cpu{};
  std::optional<int> source_cpu{};
  std::size_t warm_up = 50;  // frames at the beginning of each slice that are not counted
  std::size_t slice_frames = 500;
};

// The instants of one frame, on CLOCK_MONOTONIC; 0 for a stage that was not seen.
struct Instants {
  std::int64_t complete_ns = 0;
  std::array<std::int64_t, kStages.size()> stage_ns{};
  std::uint32_t missed = 0;  // unanswered frames before it: this answer is for them too

  std::int64_t at(Stage stage) const CARGOBAY_NONBLOCKING {
    return stage_ns[static_cast<std::size_t>(stage)];
  }
  void set(Stage stage, std::int64_t at_ns) CARGOBAY_NONBLOCKING {
    stage_ns[static_cast<std::size_t>(stage)] = at_ns;
  }
};

// Records the frames of one slice. One thread; take() does not allocate.
class Recorder {
 public:
  // Begins a slice in `measured`, which outlives it; allocates for all its frames.
  Recorder(Measured& measured, const Settings& settings);
  void take(const Instants& frame) CARGOBAY_NONBLOCKING;
  // A frame without an answer, and none after it.
  void miss() CARGOBAY_NONBLOCKING { ++measured_.missed; }

 private:
  void headline(std::uint64_t value) CARGOBAY_NONBLOCKING;

  Measured& measured_;
  std::size_t warm_up_;
  std::size_t frames_ = 0;
  std::int64_t last_ns_ = 0;
};

// Whether the kernel lets this process run on that processor.
bool may_run_on(int cpu);

// Fills in the processors that are not set: the last that this process may use for the measured
// thread, the first other one for the far end.
void choose_processors(Settings& settings);

class Channel {
 public:
  virtual ~Channel() = default;
  // Measures one slice; blocks until it is done, or until `stop` is set, from any thread. What was
  // measured until then counts.
  virtual Result<void> run_slice(const std::atomic<bool>& stop) = 0;
  const Measured& measured() const { return measured_; }
  const rt::RealtimeGrant& grant() const { return grant_; }

 protected:
  explicit Channel(std::string name) { measured_.name = std::move(name); }
  Measured measured_{};
  rt::RealtimeGrant grant_{};
};

}  // namespace cargobay::hal::jitter
