#include "hal/sim/robot/wait.hpp"

#include <cstdlib>

namespace cargobay::hal::sim {

bool happens(oi::ScriptEvent event, const Inputs& seen, oi::Mode mode) {
  switch (event) {
    case oi::ScriptEvent::wheel_drop: return seen.any_wheel_drop();
    case oi::ScriptEvent::front_wheel_drop: return seen.wheel_drop_caster;
    case oi::ScriptEvent::left_wheel_drop: return seen.wheel_drop_left;
    case oi::ScriptEvent::right_wheel_drop: return seen.wheel_drop_right;
    case oi::ScriptEvent::bump: return seen.bump_left || seen.bump_right;
    case oi::ScriptEvent::left_bump: return seen.bump_left;
    case oi::ScriptEvent::right_bump: return seen.bump_right;
    case oi::ScriptEvent::virtual_wall: return seen.virtual_wall;
    case oi::ScriptEvent::wall: return seen.wall;
    case oi::ScriptEvent::cliff: return seen.any_cliff();
    case oi::ScriptEvent::left_cliff: return seen.cliff_left.cliff;
    case oi::ScriptEvent::front_left_cliff: return seen.cliff_front_left.cliff;
    case oi::ScriptEvent::front_right_cliff: return seen.cliff_front_right.cliff;
    case oi::ScriptEvent::right_cliff: return seen.cliff_right.cliff;
    case oi::ScriptEvent::home_base: return seen.home_base;
    case oi::ScriptEvent::advance_button: return seen.advance_button;
    case oi::ScriptEvent::play_button: return seen.play_button;
    case oi::ScriptEvent::digital_input_0: return seen.digital[0];
    case oi::ScriptEvent::digital_input_1: return seen.digital[1];
    case oi::ScriptEvent::digital_input_2: return seen.digital[2];
    case oi::ScriptEvent::digital_input_3: return seen.digital[3];
    case oi::ScriptEvent::mode_passive: return mode == oi::Mode::passive;
  }
  return false;
}

void Wait::look(const View& view) {
  if (active() && over(view)) end();
}

bool Wait::over(const View& view) const {
  const auto reached = [this](double value) {
    return target_ >= 0 ? value >= target_ : value <= target_;
  };
  switch (kind_) {
    case Kind::none: return true;
    case Kind::time: return view.now >= until_;
    case Kind::distance: return reached(view.distance_mm);
    case Kind::angle: return reached(view.angle_deg);
    case Kind::event: {
      const auto event = static_cast<oi::ScriptEvent>(std::abs(target_));
      return happens(event, *view.seen, view.mode) == (target_ > 0);
    }
  }
  return true;
}

}  // namespace cargobay::hal::sim
