#include "hal/guard/duty.hpp"

#include <utility>

namespace cargobay::hal {

std::string fate(const Discharge& discharge) {
  if (!discharge.standing()) return "; the robot could not be reached: it may be moving";
  return discharge.by_guard ? "; the robot was stopped by its guard" : "";
}

Result<std::unique_ptr<Duty>> Duty::begin(ByteStream& stream, const GuardOptions& options,
                                          int priority) {
  std::unique_ptr<Duty> duty{new Duty{stream}};
  const ByteStream::Terminal terminal = stream.terminal();
  if (terminal.descriptor < 0 || options.use == GuardOptions::Use::none) return duty;
  auto guard = Guard::start(terminal, options, priority, stream.baud());
  if (!guard) {
    duty->waive();  // nothing was sent
    return guard.failure();
  }
  duty->guard_ = std::move(*guard);
  return duty;
}

Duty::~Duty() { (void)discharge(); }

void Duty::expect_demo() {
  demo_ = true;
  if (guard_) guard_->expect_demo();
}

Discharge Duty::discharge(std::size_t owed) {
  if (discharged_) return *discharged_;
  if (guard_ && guard_->took_robot()) return discharge_after(Parting::unconfirmed);
  return discharge_after(farewell(stream_, {.bytes = owed, .demo = demo_}));
}

Discharge Duty::discharge_after(Parting left) {
  if (discharged_) return *discharged_;
  discharged_ = Discharge{.parting = left};
  if (!guard_) return *discharged_;
  if (guard_->took_robot()) {
    discharged_ = Discharge{.parting = guard_->parting(), .by_guard = true};
  } else if (left != Parting::standing && guard_->alive()) {
    discharged_ = Discharge{.parting = guard_->hand_over(), .by_guard = true};
  }
  guard_->robot_is_left();
  return *discharged_;
}

void Duty::waive() {
  discharged_ = Discharge{};
  if (guard_) guard_->robot_is_left();
}

}  // namespace cargobay::hal
