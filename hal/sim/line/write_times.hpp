// When the host wrote the bytes that a pseudo-terminal passes on late and together: as exactly as
// looks at it can tell. At 115200 baud a robot loses what follows too closely (OI p. 7), and a busy
// machine brings together what a wire would have carried one by one.
#pragma once

#include <chrono>
#include <cstddef>

#include "hal/sim/ring_buffer.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class WriteTimes {
 public:
  // Of two bytes that are both to be heard.
  explicit WriteTimes(rt::Duration spacing) : spacing_{spacing} {}

  // Between `before` and `after` somebody looked, and found that there had been writes since the
  // look before, or none.
  void look(rt::TimePoint before, rt::TimePoint after, bool written);
  // Whether the next byte can have been written so long after the last one that could. If each byte
  // was, this is true of each, however late and in whatever portions they come: of all instants
  // that the looks allow, it takes the earliest.
  [[nodiscard]] bool take();
  // No instant is left.
  bool empty() const { return windows_.empty(); }

 private:
  struct Window {
    rt::TimePoint begin{};
    rt::TimePoint end{};
  };
  // What is left of a window after so long was nobody's: its bytes have come.
  static constexpr rt::Duration kForget = std::chrono::milliseconds{250};
  static constexpr std::size_t kMostWindows = 1024;

  rt::Duration spacing_;
  rt::TimePoint looked_at_{};
  rt::TimePoint last_{};                      // the instant that the last byte was given
  RingBuffer<Window> windows_{kMostWindows};  // when there was a write, or several
};

}  // namespace cargobay::hal::sim
