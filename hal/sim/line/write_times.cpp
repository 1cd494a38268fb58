#include "hal/sim/line/write_times.hpp"

#include <algorithm>

namespace cargobay::hal::sim {

void WriteTimes::look(rt::TimePoint before, rt::TimePoint after, bool written) {
  while (!windows_.empty() && windows_.front().end < before - kForget) windows_.pop_front();
  if (written) {
    if (!windows_.push_back({.begin = looked_at_, .end = after})) windows_.back().end = after;
  }
  looked_at_ = before;
}

bool WriteTimes::take() {
  for (; !windows_.empty(); windows_.pop_front()) {
    const rt::TimePoint earliest = std::max(windows_.front().begin, last_ + spacing_);
    if (earliest > windows_.front().end) continue;
    last_ = earliest;
    return true;
  }
  return false;
}

}  // namespace cargobay::hal::sim
