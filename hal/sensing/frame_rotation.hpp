// Which list the next frame carries. The loop says when it needs the counters; the frames in
// between carry everything else that the robot reports. A loop that needs every frame does without
// one now and then: the next reading covers both ticks, and nothing is lost.
#pragma once

#include "hal/sensing/frame_lists.hpp"
#include "rt/axes.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

class FrameRotation {
 public:
  // What the loop needs from the next frame.
  enum class Counters : std::uint8_t {
    wanted,   // in every frame, to find out what kind of robot it is
    welcome,  // in every frame, but every other one will do
    not_wanted,
  };

  // Longer than the series of readings that shows the kind of robot (rt/read_schedule.hpp), so that
  // the series is not interrupted.
  static constexpr int kMostReadingsInARow = 15;
  // About a second between two looks at the battery.
  static constexpr int kBatteryTicks = 64;

  // Gives these lists every other frame without counters, in turn, until the next call.
  void stream(ExtraLists extras) CARGOBAY_NONBLOCKING { extras_ = extras; }
  // One frame of each of these, soon.
  void look_at(ExtraLists extras) CARGOBAY_NONBLOCKING {
    once_ = ExtraLists{static_cast<std::uint8_t>(once_.raw() | extras.raw())};
  }

  // Call once a tick, with the counters that the loop needs. No allocation.
  FrameList next(Counters counters, const rt::Axes& axes) CARGOBAY_NONBLOCKING {
    ++ticks_since_battery_;
    if (counters != Counters::not_wanted && readings_in_a_row_ < most_readings(counters)) {
      ++readings_in_a_row_;
      return that_reads(axes);
    }
    readings_in_a_row_ = 0;
    if (once_.any()) {
      const ExtraList extra = next_of(once_);
      once_ = once_.without(extra);
      return list_of_extra(extra);
    }
    extras_turn_ = !extras_turn_ && extras_.any();
    if (extras_turn_) return list_of_extra(next_of(extras_));
    if (ticks_since_battery_ < kBatteryTicks) return FrameList::hazards;
    ticks_since_battery_ = 0;
    return FrameList::battery;
  }

 private:
  FrameList that_reads(const rt::Axes& axes) CARGOBAY_NONBLOCKING {
    if (axes.both()) return FrameList::reading;
    if (axes.turn) return FrameList::angle;
    buttons_turn_ = !buttons_turn_;
    return buttons_turn_ ? FrameList::distance_buttons : FrameList::distance;
  }
  int most_readings(Counters counters) const CARGOBAY_NONBLOCKING {
    const bool others_wait = extras_.any() || once_.any();
    return counters == Counters::welcome && others_wait ? 1 : kMostReadingsInARow;
  }
  // The next one after the last; `lists` is not empty.
  ExtraList next_of(ExtraLists lists) CARGOBAY_NONBLOCKING {
    for (int i = 0; i < kExtraLists; ++i) {
      last_extra_ = (last_extra_ + 1) % kExtraLists;
      if (lists.has(static_cast<ExtraList>(last_extra_))) break;
    }
    return static_cast<ExtraList>(last_extra_);
  }

  int readings_in_a_row_ = 0;
  int ticks_since_battery_ = kBatteryTicks;  // so that the battery is known soon
  ExtraLists extras_{};
  ExtraLists once_{};
  bool extras_turn_ = false;
  bool buttons_turn_ = false;
  int last_extra_ = 0;
};

}  // namespace cargobay::hal
