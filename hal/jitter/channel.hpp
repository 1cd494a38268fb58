// What the timing-jitter benchmark measures, one thing a channel: the control loop on a robot, the
// control loop on frames that come as fast as they are wanted, and beside them what the same kernel
// does at its best: a bare answer through a pseudo-terminal, the same through a pipe, and a sleep.
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

// Instants on the way of one frame, each counted from when the frame was complete: when it is
// handed to the kernel whole, or, on a robot, its last byte has come over the wire.
enum class Stage : std::uint8_t {
  woken,    // the thread that waited for it runs again; of a sleep: from when it was due
  decided,  // the user's control function is called
  written,  // the command has been given to the kernel
  arrived,  // the command's last byte is at the other end
};
inline constexpr std::array kStages{Stage::woken, Stage::decided, Stage::written, Stage::arrived};
std::string_view name(Stage stage);

// All channels are measured in slices, in turn, so that what the machine does meanwhile meets them
// all. What a slice gave.
struct Slice {
  std::vector<std::uint32_t>
      headline_ns;  // of the channel's own stage, in order; 2^32-1: or longer
};

struct Measured {
  std::string name{};
  Stage headline = Stage::written;  // the figure that stands for the channel
  rt::Duration period{};
  std::uint64_t frames = 0;  // answered
  std::uint64_t missed = 0;  // not before the next was due: the next answer is theirs as well
  std::array<rt::Histogram, kStages.size()> stages{};  // corrected for coordinated omission
  std::array<bool, kStages.size()> seen{};             // which of them this channel has
  rt::Histogram raw{};                                 // the headline's, as measured
  rt::Histogram interval_ns{};                         // between two answers
  std::vector<Slice> slices{};

  const rt::Histogram& headline_ns() const { return stages[static_cast<std::size_t>(headline)]; }
};

struct Settings {
  rt::Duration period = std::chrono::milliseconds{1};  // of the channels that have no robot
  int priority = 80;
  // Of the measured thread, and of the far end of a line without a robot. Where threads may wander
  // a wake-up on the same processor takes half as long as one on another: two slices would differ
  // by more than what is looked for. Nothing where there is only one processor.
  std::optional<int> cpu{};
  std::optional<int> source_cpu{};
  std::size_t warm_up = 50;  // frames at the beginning of each slice that are not counted
  std::size_t slice_frames = 500;
};

// Of one frame, on CLOCK_MONOTONIC; 0 for a stage that was not seen.
struct Instants {
  std::int64_t complete_ns = 0;
  std::array<std::int64_t, kStages.size()> stage_ns{};
  std::uint32_t missed = 0;  // frames before it that nobody answered: this answer is theirs too

  std::int64_t at(Stage stage) const CARGOBAY_NONBLOCKING {
    return stage_ns[static_cast<std::size_t>(stage)];
  }
  void set(Stage stage, std::int64_t at_ns) CARGOBAY_NONBLOCKING {
    stage_ns[static_cast<std::size_t>(stage)] = at_ns;
  }
};

// Books the frames of one slice. One thread; take() does not allocate.
class Recorder {
 public:
  // Begins a slice in `measured`, which outlives it; allocates for all its frames.
  Recorder(Measured& measured, const Settings& settings);
  void take(const Instants& frame) CARGOBAY_NONBLOCKING;
  // A frame that nobody answered, and no answer behind it.
  void miss() CARGOBAY_NONBLOCKING { ++measured_.missed; }

 private:
  void headline(std::uint64_t value) CARGOBAY_NONBLOCKING;

  Measured& measured_;
  std::size_t warm_up_;
  std::size_t frames_ = 0;
  std::int64_t last_ns_ = 0;
};

// Fills in the processors that are not set: the last that this process may use for what is
// measured, the first other one for the far end.
void choose_processors(Settings& settings);

class Channel {
 public:
  virtual ~Channel() = default;
  // Measures one slice; blocks for as long as it takes, or until `stop` is set, from any thread.
  // What was measured until then counts.
  virtual std::optional<Failure> run_slice(const std::atomic<bool>& stop) = 0;
  const Measured& measured() const { return measured_; }
  const rt::RealtimeGrant& grant() const { return grant_; }

 protected:
  explicit Channel(std::string name) { measured_.name = std::move(name); }
  Measured measured_{};
  rt::RealtimeGrant grant_{};
};

}  // namespace cargobay::hal::jitter
