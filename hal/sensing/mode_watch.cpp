#include "hal/sensing/mode_watch.hpp"

namespace cargobay::hal {

void ModeWatch::begin(State state) CARGOBAY_NONBLOCKING {
  state_ = state;
  causes_ = {};
  frames_ = 0;
  saw_cliffs_ = false;
  saw_charger_ = false;
}

void ModeWatch::collect(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  ++frames_;
  causes_ = Hazards{static_cast<std::uint8_t>(causes_.raw() | hazards_in(frame).raw())};
  saw_cliffs_ = saw_cliffs_ || frame.has(oi::PacketId::cliff_left);
  saw_charger_ = saw_charger_ || frame.has(oi::PacketId::charging_sources);
}

std::optional<EventKind> ModeWatch::see(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  if (!frame.has(oi::PacketId::oi_mode)) return std::nullopt;
  mode_ = frame.mode();
  const bool in_mode = mode_ == drive_mode_;
  if (state_ == State::driving && !in_mode) begin(State::searching);
  if (state_ == State::searching) {
    collect(frame);
    const bool all_seen = saw_cliffs_ && saw_charger_;
    if (!causes_.any() && !all_seen && frames_ < kSearchFrames) return std::nullopt;
    state_ = State::lost;
    return EventKind::mode_lost;
  }
  if (state_ == State::rearming) {
    collect(frame);
    if (!in_mode && frames_ < kRearmFrames) return std::nullopt;
    state_ = in_mode ? State::driving : State::lost;
    return in_mode ? EventKind::rearmed : EventKind::rearm_failed;
  }
  return std::nullopt;
}

}  // namespace cargobay::hal
