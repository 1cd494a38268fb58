// The dead time of the wheels: what they are told, they do that much later.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "hal/sim/pose.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class CommandDelay {
 public:
  static constexpr std::size_t kMost = 256;  // on the way; the latest replaces the one before it

  bool empty() const { return count_ == 0; }
  // When the next one arrives; never, if none is on the way.
  rt::Duration due() const { return empty() ? rt::Duration::max() : pending_[first_].due; }
  // Commands arrive in the order given, also if the dead time becomes shorter in between.
  void push(WheelSpeeds command, rt::Duration due) {
    if (!empty()) due = std::max(due, pending_[place(count_ - 1)].due);
    if (count_ < kMost) ++count_;
    pending_[place(count_ - 1)] = {.due = due, .command = command};
  }
  // Not if it is empty.
  WheelSpeeds pop() {
    const WheelSpeeds command = pending_[first_].command;
    first_ = place(1);
    --count_;
    return command;
  }

 private:
  struct Pending {
    rt::Duration due{0};
    WheelSpeeds command{};
  };
  std::size_t place(std::size_t index) const { return (first_ + index) % kMost; }

  std::array<Pending, kMost> pending_{};
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace cargobay::hal::sim
