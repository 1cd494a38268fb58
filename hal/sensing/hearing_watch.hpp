// Whether the robot hears what it is told. Nothing acknowledges a command; but a robot that was
// told to stream another list streams it from its next tick on, and one that takes commands for the
// data of something else does not. Its frames keep coming all the while, and its wheels keep
// turning.
#pragma once

#include <optional>

#include "hal/sensing/frame_lists.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// One thread; no clock, no allocation.
class HearingWatch {
 public:
  // Number of frames after the command within which one of the new list must have come: a late
  // answer reaches the robot in the tick after the next.
  static constexpr int kPatience = 3;

  // `list` is what the robot streams when the watch begins.
  explicit HearingWatch(FrameList list) : told_{list}, before_{list}, seen_{list} {}

  // A list was sent, whole. The same list again proves nothing, unless the robot has been found
  // deaf.
  void told(FrameList list) CARGOBAY_NONBLOCKING {
    const bool changes = list != told_;
    if (changes) before_ = told_;
    told_ = list;
    if ((changes || unheard_) && !awaited_) await(list);
  }
  // A good frame has come; nothing for one that is not of any of our lists.
  void see(std::optional<FrameList> list) CARGOBAY_NONBLOCKING {
    strange_ = list == told_ || list == before_ ? 0 : strange_ + 1;
    if (list) seen_ = *list;
    if (!awaited_) return;
    if (list == awaited_) {
      unheard_ = false;
      awaited_.reset();
      if (told_ != *list) await(told_);
    } else if (++frames_ > kPatience) {
      unheard_ = true;
      awaited_.reset();
    }
  }
  // A frame did not come whole: it may have been the awaited one.
  void missed() CARGOBAY_NONBLOCKING { awaited_.reset(); }

  // The last frame was of a list that was not requested lately.
  bool misheard() const CARGOBAY_NONBLOCKING { return strange_ > 0; }
  // The robot takes commands for something else.
  bool deaf() const CARGOBAY_NONBLOCKING { return unheard_ || strange_ > 1; }
  // What to send to a deaf robot: a list that it does not stream now, so that it shows when it
  // hears.
  FrameList probe() const CARGOBAY_NONBLOCKING {
    return seen_ == FrameList::reading ? FrameList::hazards : FrameList::reading;
  }

 private:
  void await(FrameList list) CARGOBAY_NONBLOCKING {
    awaited_ = list;
    frames_ = 0;
  }

  FrameList told_;
  FrameList before_;
  FrameList seen_;
  std::optional<FrameList> awaited_{};
  int frames_ = 0;   // since awaited_ was told
  int strange_ = 0;  // in a row
  bool unheard_ = false;
};

}  // namespace cargobay::hal
