// The ten built-in demos, as simple behaviours: each looks like what the manual says of it (OI p.
// 8) and goes no further. One step a tick.
#pragma once

#include <cstdint>

#include "hal/sim/demos/cover.hpp"
#include "hal/sim/demos/demo_view.hpp"
#include "hal/sim/demos/docking.hpp"
#include "hal/sim/demos/floor_memory.hpp"
#include "hal/sim/demos/homing.hpp"
#include "hal/sim/demos/wall_follower.hpp"
#include "oi/commands.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class Demos {
 public:
  using View = DemoView;
  using Action = DemoAction;

  // A number that is no demo, as -1, ends the one that runs.
  void start(std::int32_t number, const View& view);
  void stop() { running_ = false; }
  bool running() const { return running_; }
  oi::DemoNumber number() const { return number_; }

  // What to do until the next tick. Only while one runs.
  Action step(const View& view);

 private:
  Action cover(const View& view, bool docks);
  Action spot(const View& view);
  Action mouse(const View& view);
  Action figure_eight(const View& view);
  Action wimp(const View& view);
  Action home(const View& view, bool goes_on);
  Action pachelbel(const View& view);
  Action banjo(const View& view) const;
  // Away from what it meets; true while that lasts.
  bool evade(const View& view, Action& action);
  void begin(const View& view);

  bool running_ = false;
  oi::DemoNumber number_ = oi::DemoNumber::abort;
  FloorMemory floor_{};
  Cover cover_{};
  Docking docking_{};
  Homing homing_{};
  WallFollower follower_{};
  Evasion evasion_{};
  rt::Duration started_at_{0};
  rt::Duration docks_again_at_{0};  // until then it leaves the base alone
  rt::Duration touches_since_{0};   // it touches the base or a charger, if it does
  std::uint32_t gave_up_ = 0;       // attempts to dock
  bool follows_ = false;            // has found a wall
  bool yields_ = false;             // was pushed
  double since_mm_ = 0.0;           // when what it does began
  double since_deg_ = 0.0;
  rt::Duration since_{0};
  std::uint32_t turns_ = 0;   // so far: the next differs from the last
  std::uint32_t played_ = 0;  // notes of the canon so far
  bool cliff_before_ = false;
};

}  // namespace cargobay::hal::sim
