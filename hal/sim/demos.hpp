// The ten built-in demos, as simple behaviours: each looks like what the manual says of it (OI p.
// 8) and goes no further. One step a tick.
#pragma once

#include <cstdint>

#include "hal/sim/inputs.hpp"
#include "hal/sim/wheels.hpp"
#include "oi/commands.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class Demos {
 public:
  // What a demo sees and knows.
  struct View {
    rt::Duration now{};
    const Inputs* seen = nullptr;
    double travelled_mm = 0.0;  // by the encoders, since power-on
    double turned_deg = 0.0;
  };
  struct Action {
    WheelSpeeds wheels{};
    std::uint8_t note = 0;  // MIDI number that sounds; 0 for silence
    bool over = false;      // the demo has come to its end
  };

  // A number that is no demo, as -1, ends the one that runs.
  void start(std::int32_t number, const View& view);
  void stop() { running_ = false; }
  bool running() const { return running_; }
  oi::DemoNumber number() const { return number_; }

  // What to do until the next tick. Only while one runs.
  Action step(const View& view);

 private:
  enum class Phase : std::uint8_t { drive, back_off, turn, align };

  Action cover(const View& view, bool docks);
  Action spot(const View& view);
  Action mouse(const View& view);
  Action figure_eight(const View& view);
  Action wimp(const View& view);
  Action home(const View& view, bool goes_on);
  Action pachelbel(const View& view);
  Action banjo(const View& view) const;
  // Backs off, then turns away; true while that lasts.
  bool evade(const View& view, Action& action);
  void enter(Phase phase, const View& view);

  bool running_ = false;
  oi::DemoNumber number_ = oi::DemoNumber::abort;
  Phase phase_ = Phase::drive;
  rt::Duration started_at_{0};
  double phase_travelled_mm_ = 0.0;
  double phase_turned_deg_ = 0.0;
  double back_off_mm_ = 0.0;
  double turn_deg_ = 0.0;     // of the turn under way, positive to the left
  std::uint32_t turns_ = 0;   // so far: the next differs from the last
  std::uint32_t played_ = 0;  // notes of the canon so far
  bool cliff_before_ = false;
  bool came_from_red_ = false;  // into the middle between the buoys
};

}  // namespace cargobay::hal::sim
