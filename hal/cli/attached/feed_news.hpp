// What a feed has told so far (docs/feed.md), for commands that show it.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>

#include "hal/cycle/cycle_state.hpp"
#include "hal/feed/message/reading.hpp"

namespace cargobay::cli {

// One thread; allocates.
class FeedNews {
 public:
  static constexpr std::size_t kMostEvents = 200;  // the latest

  // Takes one line. Returns its type; nothing if it is not a message of a feed.
  std::optional<hal::FeedType> hear(std::string_view line);

  hal::heard::Hello hello{};
  std::string stage{};
  std::string text{};  // of the stage
  std::optional<hal::CycleState> state{};
  std::int64_t state_unix_ns = 0;    // arrival of its frame, on the system's clock
  hal::heard::Sensors sensors{};     // without those that the robot is not asked for
  std::deque<std::string> events{};  // "  12.345 s  text"
  hal::heard::Statistics statistics{};
  std::optional<hal::heard::Truth> truth{};  // of a virtual Create
  std::string holder{};                      // who steers; empty for nobody
  std::uint64_t lease = 0;                   // its number; 0 for nobody
  std::uint64_t missed = 0;                  // messages that did not get here
  hal::heard::Answer answer{};               // the latest
};

}  // namespace cargobay::cli
