// A recorded drive as records, one after the other.
//
// A recording keeps a part of each state and no events: it determines them. So the loop runs again
// on what it received (hal/recording/replay.hpp), and what it says is passed on as long as that is
// what was recorded, to the last bit. From a gap on, or where another version of the program comes
// to other results, states have only what the file keeps, and there are no events.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>

#include "hal/export/record_sink.hpp"
#include "hal/recording/recording.hpp"
#include "hal/recording/replay.hpp"
#include "oi/command_parser.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

// Makes records of what a flight recorder kept, and of the states and events of the same loop.
// One thread.
class Narrator {
 public:
  struct Origin {
    std::int64_t unix_ns = 0;  // when `time` was
    rt::TimePoint time{};      // where time_s begins
  };
  // How many records there were.
  struct Counts {
    std::uint64_t states = 0;
    std::uint64_t partial_states = 0;  // of these
    std::uint64_t sensors = 0;
    std::uint64_t events = 0;
    std::uint64_t commands = 0;
  };

  // `sink` must outlive it.
  Narrator(RecordSink& sink, const Origin& origin, double wheel_base_mm)
      : sink_{sink}, origin_{origin}, wheel_base_mm_{wheel_base_mm}, time_{origin.time} {}

  // What the loop says, each before the entry of its state is taken.
  void know(const CycleState& state) { states_.push_back(state); }
  void know(const Event& event);
  // What the recorder kept, in its order. A state of it that is not known is told as far as it is
  // recorded.
  void take(const Entry& entry);
  // Another loop begins: half a frame and half a command of the one before it are no more.
  void begin_link();
  // What is known and was not told. The last call.
  void finish();

  const Counts& counts() const { return counts_; }

 private:
  void hear(std::span<const std::uint8_t> bytes);
  void say(std::span<const std::uint8_t> bytes);
  void tell_state(const CycleState& recorded);
  void tell_state(const CycleState& state, StateRecord::Extent extent);
  void tell_events_up_to(rt::TimePoint time);
  Stamp stamp(rt::TimePoint time) const;

  RecordSink& sink_;
  Origin origin_;
  double wheel_base_mm_;
  rt::TimePoint time_;
  oi::StreamDecoder decoder_{};
  oi::CommandParser parser_{};
  SensorRecord sensors_{};           // the latest
  std::deque<CycleState> states_{};  // known, and not told yet
  std::deque<Event> events_{};
  Counts counts_{};
};

struct Retelling {
  Narrator::Counts counts{};
  std::optional<ReplayDifference> difference{};  // where the loop would have done something else
};

// Takes a small fraction of the recorded time. Allocates; one thread.
Retelling retell(const Recording& recording, RecordSink& sink);

}  // namespace cargobay::hal
