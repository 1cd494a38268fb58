// What a pass notices and reports: CyclePass's other half.
#include <utility>

#include "hal/cycle/cycle_pass.hpp"

namespace cargobay::hal {
namespace {

oi::BitSet<Wheel> wheels_of(const rt::WheelWatch::Evidence& evidence) CARGOBAY_NONBLOCKING {
  oi::BitSet<Wheel> wheels;
  if (evidence.wheels.left) wheels = wheels.with(Wheel::left);
  if (evidence.wheels.right) wheels = wheels.with(Wheel::right);
  return wheels;
}

oi::BitSet<Wheel> held_up(oi::BitSet<oi::Overcurrent> overcurrents) CARGOBAY_NONBLOCKING {
  oi::BitSet<Wheel> wheels;
  if (overcurrents.has(oi::Overcurrent::left_wheel)) wheels = wheels.with(Wheel::left);
  if (overcurrents.has(oi::Overcurrent::right_wheel)) wheels = wheels.with(Wheel::right);
  return wheels;
}

}  // namespace

// Looks for what is worth reporting.
void CyclePass::see_frame(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
  sender_.see(receiver_.list());
  // The ledger has not counted it yet.
  const auto ahead = static_cast<std::int64_t>(receiver_.readings().size());
  const std::int64_t tick = ledger_.clock().started() ? ledger_.clock().ticks() + ahead : 0;
  outlets_.board.see(frame, tick);
  see_bumps(frame, tick);
  for (const Event& event : power_.see(frame)) report(event, tick);
  const std::optional<EventKind> change = mode_watch_.see(frame);
  if (!change) return;
  if (*change == EventKind::mode_lost) {
    mode_loss_causes_ = mode_watch_.causes();
    // A request from before there was anything to rearm. One made in response to the event comes
    // later.
    rearm_requested_.store(false, std::memory_order_relaxed);
  }
  report({.what = *change, .mode = mode_watch_.mode(), .hazards = mode_watch_.causes()}, tick);
}

void CyclePass::report(const Event& event, std::int64_t tick) CARGOBAY_NONBLOCKING {
  Event told = event;
  told.tick = tick;
  told.time = wait_.woken;
  outlets_.report(told);
  if (observer_.event != nullptr) observer_.event(observer_.context, told);
}

void CyclePass::see_bumps(const oi::SensorValues& frame, std::int64_t tick) CARGOBAY_NONBLOCKING {
  if (!frame.has(oi::PacketId::bumps_and_wheel_drops)) return;
  const Bumps before = std::exchange(seen_.bumps, bumps_in(frame));
  const Bumps began{static_cast<std::uint8_t>(seen_.bumps.raw() & ~before.raw())};
  if (began.any()) report({.what = EventKind::bump_began, .bumps = began}, tick);
  if (before.any() && !seen_.bumps.any()) report({.what = EventKind::bump_ended}, tick);
}

// A wheel that stands still and draws too much current is stuck; without, its counter may be dead
// just as well.
CyclePass::Step CyclePass::see_wheels() CARGOBAY_NONBLOCKING {
  using Finding = rt::WheelWatch::Finding;
  const rt::WheelWatch::Evidence& evidence = loop_.evidence();
  if (evidence.what == Finding::nothing || seen_.wheels) return Step::on;
  seen_.wheels = true;
  const auto still = wheels_of(evidence);
  const oi::BitSet<Wheel> stuck{
      static_cast<std::uint8_t>(still.raw() & held_up(power_.overcurrents()).raw())};
  const bool is_stuck = evidence.what == Finding::still && stuck.any();
  report({.what = is_stuck ? EventKind::wheel_stuck : EventKind::counters_implausible,
          .overcurrents = power_.overcurrents(),
          .wheels = is_stuck ? stuck : still,
          .finding = evidence.what,
          .wanted = evidence.driven,
          .got = evidence.counted},
         ledger_.clock().ticks());
  return parameters_.on_implausible == OnImplausible::end ? end(CycleEnd::implausible) : Step::on;
}

void CyclePass::see_limits(CycleState& state) CARGOBAY_NONBLOCKING {
  if (loop_.limited().speed) state.limits = state.limits.with(Limit::speed);
  if (loop_.limited().acceleration) state.limits = state.limits.with(Limit::acceleration);
  const auto change = seen_.limits.see(state.limits, state.target, loop_.given());
  if (change) report(*change, ledger_.clock().ticks());
}

void CyclePass::see_refusal() CARGOBAY_NONBLOCKING {
  ++counters_.refused;
  if (control_.refusal() == UserControl::Refusal::first) report(EventKind::control_refused);
}

}  // namespace cargobay::hal
