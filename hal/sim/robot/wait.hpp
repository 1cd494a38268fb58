// What the four Wait commands wait for (OI p. 15, 16). Checked once a tick.
#pragma once

#include <cstdint>

#include "hal/sim/inputs.hpp"
#include "oi/command_table.hpp"
#include "oi/commands.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

// Whether the event, one of 1 to 22, is true.
bool happens(oi::ScriptEvent event, const Inputs& seen, oi::Mode mode);

class Wait {
 public:
  // The values that a wait checks.
  struct View {
    rt::Duration now{};
    double distance_mm = 0.0;  // since the wait began
    double angle_deg = 0.0;
    const Inputs* seen = nullptr;
    oi::Mode mode = oi::Mode::off;
  };

  // A time, distance or angle of 0 is over at once, whichever way the robot moves.
  void for_time(std::int32_t tenths, rt::Duration now) {
    begin(tenths == 0 ? Kind::none : Kind::time);
    until_ = now + std::chrono::milliseconds{100} * tenths;
  }
  void for_distance(std::int32_t distance_mm) {
    begin(distance_mm == 0 ? Kind::none : Kind::distance);
    target_ = distance_mm;
  }
  void for_angle(std::int32_t angle_deg) {
    begin(angle_deg == 0 ? Kind::none : Kind::angle);
    target_ = angle_deg;
  }
  // Until the next tick.
  void for_tick(rt::Duration now) {
    begin(Kind::time);
    until_ = now;
  }
  // 1 to 22 and their negatives; any other number waits for nothing.
  void for_event(std::int32_t event) {
    const bool known = event != 0 && event >= -kEvents && event <= kEvents;
    begin(known ? Kind::event : Kind::none);
    target_ = event;
  }
  void end() { kind_ = Kind::none; }

  bool active() const { return kind_ != Kind::none; }
  // Ends the wait if what it waits for has come.
  void look(const View& view);

 private:
  enum class Kind : std::uint8_t { none, time, distance, angle, event };
  static constexpr std::int32_t kEvents = static_cast<std::int32_t>(oi::ScriptEvent::mode_passive);

  void begin(Kind kind) { kind_ = kind; }
  bool over(const View& view) const;

  Kind kind_ = Kind::none;
  rt::Duration until_{0};
  std::int32_t target_ = 0;
};

}  // namespace cargobay::hal::sim
