// When the host wrote the bytes that a pseudo-terminal passes on late and together, as exactly as
// looking at it can tell. At 115200 baud a robot loses bytes that follow too closely (OI p. 7), and
// a busy machine merges what a wire would have carried one by one.
#pragma once

#include <chrono>
#include <cstddef>

#include "hal/sim/ring_buffer.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class WriteTimes {
 public:
  // `spacing`: between two bytes that the robot is to hear.
  explicit WriteTimes(rt::Duration spacing) : spacing_{spacing} {}

  // Between `before` and `after` we looked, and found whether there had been writes since the look
  // before.
  void look(rt::TimePoint before, rt::TimePoint after, bool written);
  // Whether the next byte can have been written at least `spacing` after the last one that could.
  // If the host kept that spacing, this is true for each byte, however late and in whatever
  // portions they come: of all instants that the looks allow, it takes the earliest.
  [[nodiscard]] bool take();
  // No possible instant is left.
  bool empty() const { return windows_.empty(); }

 private:
  struct Window {
    rt::TimePoint begin{};
    rt::TimePoint end{};
  };
  // What is left of a window after this long belongs to no byte: its bytes have come.
  static constexpr rt::Duration kForget = std::chrono::milliseconds{250};
  static constexpr std::size_t kMostWindows = 1024;

  rt::Duration spacing_;
  rt::TimePoint looked_at_{};
  rt::TimePoint last_{};                      // the instant assigned to the last byte
  RingBuffer<Window> windows_{kMostWindows};  // each contains one or more writes
};

}  // namespace cargobay::hal::sim
