// Whether the robot is in the mode that it is driven in; if it left it by itself, why.
//
// The frame that shows the new mode may lack the packets that show the cause. The cause is then
// looked for in the next frames, of the lists that wanted() asks for: a tick later a cliff is still
// under the sensor, a wheel in the air, the charger plugged in.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/sensing/events.hpp"
#include "hal/sensing/frame_lists.hpp"
#include "oi/command_table.hpp"
#include "oi/sensors.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// One thread; no clock, no allocation.
class ModeWatch {
 public:
  enum class State : std::uint8_t {
    driving,    // in the mode
    searching,  // not in it; looking for the cause
    lost,       // not in it
    rearming,   // told to go back to it
  };
  // Frames until giving up: on finding the cause; on being in the mode again.
  static constexpr int kSearchFrames = 4;
  static constexpr int kRearmFrames = 20;

  explicit ModeWatch(oi::Mode drive_mode) : drive_mode_{drive_mode} {}

  // Call for each frame. Returns what to report: mode_lost, once the cause is known or given up;
  // rearmed or rearm_failed.
  std::optional<EventKind> see(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING;
  // The robot was told to go back to its mode. Only after it has lost the mode.
  void rearm() CARGOBAY_NONBLOCKING { begin(State::rearming); }

  State state() const CARGOBAY_NONBLOCKING { return state_; }
  oi::Mode drive_mode() const CARGOBAY_NONBLOCKING { return drive_mode_; }
  // According to the last frame that had it; Off before.
  oi::Mode mode() const CARGOBAY_NONBLOCKING { return mode_; }
  // What has been seen since the mode was lost, or since rearm().
  Hazards causes() const CARGOBAY_NONBLOCKING { return causes_; }
  // The list whose frame would show more of the cause.
  FrameList wanted() const CARGOBAY_NONBLOCKING {
    return saw_cliffs_ ? FrameList::reading : FrameList::hazards;
  }

 private:
  void begin(State state) CARGOBAY_NONBLOCKING;
  void collect(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING;

  oi::Mode drive_mode_;
  oi::Mode mode_ = oi::Mode::off;
  State state_ = State::driving;
  Hazards causes_{};
  int frames_ = 0;  // since state_ began
  bool saw_cliffs_ = false;
  bool saw_charger_ = false;
};

}  // namespace cargobay::hal
