#include "hal/cycle/control_cycle.hpp"

#include "hal/cycle/cycle_pass.hpp"

namespace cargobay::hal {

ControlCycle::ControlCycle(ByteStream& stream, const Parameters& parameters)
    : pass_{new CyclePass{stream, parameters}} {}

ControlCycle::~ControlCycle() { delete pass_; }

CycleEnd ControlCycle::run() CARGOBAY_NONBLOCKING { return pass_->run(); }
void ControlCycle::begin() CARGOBAY_NONBLOCKING { pass_->begin(); }
bool ControlCycle::pass() CARGOBAY_NONBLOCKING { return pass_->pass(); }
CycleEnd ControlCycle::finish() CARGOBAY_NONBLOCKING { return pass_->finish(); }

void ControlCycle::set_control(const ControlFunction& control) { pass_->control_.set(control); }
void ControlCycle::set_observer(const StateObserver& observer) { pass_->observer_ = observer; }
void ControlCycle::set_guard(const GuardMark& guard) { pass_->sender_.set_guard(guard); }
void ControlCycle::request_stop() CARGOBAY_NONBLOCKING {
  pass_->stop_requested_.store(true, std::memory_order_relaxed);
}
void ControlCycle::abandon() CARGOBAY_NONBLOCKING { pass_->sender_.abandon(); }
std::optional<rt::TimePoint> ControlCycle::last_pass() const CARGOBAY_NONBLOCKING {
  const std::int64_t passed_ns = pass_->passed_ns_.load(std::memory_order_relaxed);
  if (passed_ns == 0) return std::nullopt;
  return rt::TimePoint{rt::Duration{passed_ns}};
}
bool ControlCycle::set_speeds(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  return within_range(speeds) && pass_->setpoint_.put(speeds);
}
void ControlCycle::stand_still() CARGOBAY_NONBLOCKING { pass_->setpoint_.revoke(); }
void ControlCycle::expect_silence(rt::Duration duration) CARGOBAY_NONBLOCKING {
  pass_->silence_.announce(duration);
}
void ControlCycle::request_rearm() CARGOBAY_NONBLOCKING {
  pass_->rearm_requested_.store(true, std::memory_order_relaxed);
}
bool ControlCycle::request(const Request& request) CARGOBAY_NONBLOCKING {
  return pass_->requests_.push(request);
}
std::size_t ControlCycle::spare_bytes() const CARGOBAY_NONBLOCKING {
  return pass_->sender_.spare_bytes();
}
std::optional<CycleState> ControlCycle::state() const CARGOBAY_NONBLOCKING {
  return pass_->outlets_.state.get();
}
std::optional<rt::LearntPlant> ControlCycle::learnt() const CARGOBAY_NONBLOCKING {
  return pass_->outlets_.learnt.get();
}
bool ControlCycle::next_state(CycleState& state) CARGOBAY_NONBLOCKING {
  return pass_->outlets_.history.pop(state);
}
bool ControlCycle::next_event(Event& event) CARGOBAY_NONBLOCKING {
  return pass_->outlets_.events.pop(event);
}
std::uint64_t ControlCycle::events_dropped() const CARGOBAY_NONBLOCKING {
  return pass_->outlets_.events.dropped();
}
std::int32_t ControlCycle::reading(oi::PacketId packet) const CARGOBAY_NONBLOCKING {
  return pass_->outlets_.board.value(packet);
}
SensorReadings ControlCycle::sensors() const CARGOBAY_NONBLOCKING {
  return pass_->outlets_.board.readings();
}
CycleCounters ControlCycle::counters() const CARGOBAY_NONBLOCKING {
  return pass_->outlets_.counters.get().value_or(CycleCounters{});
}
const rt::Histogram& ControlCycle::period_ns() const { return pass_->outlets_.period_ns; }
const rt::Histogram& ControlCycle::frame_to_command_ns() const {
  return pass_->outlets_.frame_to_command_ns;
}
const FrameCounters& ControlCycle::frames() const { return pass_->counters_.frames; }
std::uint64_t ControlCycle::unsent_commands() const { return pass_->counters_.unsent; }
std::uint64_t ControlCycle::withheld_commands() const { return pass_->counters_.withheld; }
const PhaseOverruns& ControlCycle::overruns() const { return pass_->counters_.overruns; }
std::uint64_t ControlCycle::refused_controls() const { return pass_->counters_.refused; }
std::size_t ControlCycle::owed_bytes() const { return pass_->sender_.owed_bytes(); }
int ControlCycle::port_error() const { return pass_->sender_.port_error(); }
oi::BitSet<Hazard> ControlCycle::mode_loss_causes() const { return pass_->mode_loss_causes_; }

}  // namespace cargobay::hal
