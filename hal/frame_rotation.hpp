// Which list the next frame is of. The loop says when it needs the counters; the frames between are
// for the rest that the robot tells. Where the loop needs every frame, now and then it goes without
// one: the next reading covers both ticks, and nothing is lost.
#pragma once

#include "hal/frame_lists.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

class FrameRotation {
 public:
  enum class Counters : std::uint8_t { wanted, not_wanted };

  // Longer than the row of readings by which the kind of robot is found out (rt/read_schedule.hpp):
  // that one is not broken.
  static constexpr int kMostReadingsInARow = 15;
  // About a second between two looks at the battery.
  static constexpr int kBatteryTicks = 64;

  // Once a tick. No allocation.
  FrameList next(Counters counters) noexcept CARGOBAY_NONBLOCKING {
    ++ticks_since_battery_;
    if (counters == Counters::wanted && readings_in_a_row_ < kMostReadingsInARow) {
      ++readings_in_a_row_;
      return FrameList::reading;
    }
    readings_in_a_row_ = 0;
    if (ticks_since_battery_ < kBatteryTicks) return FrameList::hazards;
    ticks_since_battery_ = 0;
    return FrameList::battery;
  }

 private:
  int readings_in_a_row_ = 0;
  int ticks_since_battery_ = kBatteryTicks;  // so that the battery is known soon
};

}  // namespace cargobay::hal
