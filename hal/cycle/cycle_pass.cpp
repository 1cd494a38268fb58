#include "hal/cycle/cycle_pass.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "oi/stream_budget.hpp"

namespace cargobay::hal {
namespace {

// A frame's bytes may be handed over this long after its last bit.
constexpr rt::Duration kHandOver = std::chrono::milliseconds{1};
// What was learnt is published so often, a few times a second: it changes slowly, and to sum it up
// takes as long as half a tick's work.
constexpr std::int64_t kLearntEvery = 16;  // ticks

rt::Duration tick_of(const CycleParameters& parameters) {
  return rt::Duration{std::llround(parameters.loop.estimator.tick_s * 1e9)};
}

// Whether the difference is large enough to matter in which tick the robot gets the second.
bool changes(const rt::WheelSpeeds& before, const rt::WheelSpeeds& after) CARGOBAY_NONBLOCKING {
  constexpr double kLeast = 10.0;  // mm/s: in one tick 0.15 of the counter's millimetres
  return std::abs(after.left_mm_s - before.left_mm_s) > kLeast ||
         std::abs(after.right_mm_s - before.right_mm_s) > kLeast;
}

}  // namespace

CyclePass::CyclePass(ByteStream& stream, const CycleParameters& parameters)
    : stream_{stream.at_this_rate()},
      parameters_{parameters},
      frame_time_{oi::wire_time(parameters.dialect->frame_bytes, stream.baud())},
      control_{{.tick = tick_of(parameters),
                .budget = parameters.control_budget,
                .overruns_allowed = parameters.control_overruns_allowed}},
      ledger_{parameters.dialect->frame_bytes, tick_of(parameters), parameters.late_margin,
              counters_.frames},
      loop_{parameters.loop},
      odometry_{parameters.odometry},
      sender_{stream_, *parameters.dialect, tick_of(parameters), parameters.link_timeout},
      setpoint_{parameters.setpoint_lapse},
      silence_{{.tick = tick_of(parameters),
                .stop_after = parameters.stop_after,
                .link_timeout = parameters.link_timeout}},
      mode_watch_{parameters.drive_mode},
      power_{parameters.power},
      receiver_{*parameters.dialect, tick_of(parameters)} {}

CycleEnd CyclePass::run() CARGOBAY_NONBLOCKING {
  begin();
  while (pass()) {
  }
  return finish();
}

void CyclePass::begin() CARGOBAY_NONBLOCKING {
  steered_ = control_.is_set();
  const rt::TimePoint now = stream_.now();
  ledger_.begin(now);
  receiver_.begin(now);
  silence_.begin(now);
}

bool CyclePass::pass() CARGOBAY_NONBLOCKING {
  return !stop_requested_.load(std::memory_order_relaxed) && pass_once() != Step::ended;
}

CycleEnd CyclePass::finish() CARGOBAY_NONBLOCKING {
  stop_wheels();
  outlets_.learnt.put(loop_.learnt());
  return end_;
}

// One wait, one read, and if frames are complete, one write.
CyclePass::Step CyclePass::pass_once() CARGOBAY_NONBLOCKING {
  if (!wait_.left) wait_.until = wake_time();
  const ByteStream::Wait woken = stream_.wait(wait_.until);
  wait_.left = woken == ByteStream::Wait::left;
  if (wait_.left) return Step::on;
  const rt::TimePoint now = stream_.now();
  wait_.woken = now;
  passed_ns_.store(rt::nanoseconds(now), std::memory_order_relaxed);
  if (look_after_guard(now) == Step::ended) return Step::ended;
  silence_.take_up_announced(now);
  if (woken == ByteStream::Wait::hung_up) return hung_up(0);

  // After a time-out too: less than a frame may have arrived, and must not be left behind.
  const ByteStream::Transfer transfer = stream_.read(receiver_.room());
  if (transfer.error != 0) return hung_up(transfer.error);
  receiver_.decode(transfer.count, now, [this](const oi::SensorValues& frame) CARGOBAY_NONBLOCKING {
    see_frame(frame);
  });
  if (!receiver_.empty()) return answer(now);
  return now >= silence_.deadline() ? deadline_passed() : Step::on;
}

// The wait is for whole frames. If a frame was read in part, its rest is fetched on its own: if it
// had to wait for a frame's worth of bytes, it would come with most of the next frame, and so on
// for ever.
rt::TimePoint CyclePass::wake_time() const CARGOBAY_NONBLOCKING {
  if (receiver_.whole()) return silence_.deadline();
  return std::min(silence_.deadline(), stream_.now() + frame_time_ + kHandOver);
}

CyclePass::Step CyclePass::look_after_guard(rt::TimePoint now) CARGOBAY_NONBLOCKING {
  switch (sender_.guard().beat(now)) {
    case GuardMark::Robot::ours: break;
    case GuardMark::Robot::taken: return end(CycleEnd::guarded);
    case GuardMark::Robot::unguarded: return end(CycleEnd::guard_lost);
  }
  return Step::on;
}

CyclePass::Step CyclePass::answer(rt::TimePoint arrival) CARGOBAY_NONBLOCKING {
  take_requests();
  std::optional<rt::Duration> period;
  if (ledger_.clock().started()) period = arrival - ledger_.last_arrival();
  account(arrival);
  CycleState state = state_at(arrival);
  // Only the second frame after a silence shows how many ticks it was: until then there is no
  // estimate.
  const bool doubtful =
      mode_watch_.state() == ModeWatch::State::driving && ledger_.clock().in_doubt();
  const Step step = doubtful ? Step::on : answer_in_mode(state);
  // The command is out: from here on nothing is urgent.
  if (period) outlets_.period_ns.record(static_cast<std::uint64_t>(period->count()));
  if (doubtful) return step;
  outlets_.publish(state, counters_);
  if (state.tick % kLearntEvery == 0) outlets_.learnt.put(loop_.learnt());
  if (observer_.function != nullptr) observer_.function(observer_.context, state);
  return step;
}

// Requests that need no room on the line are done at once; a command waits for its own frame, and
// later requests wait with it.
void CyclePass::take_requests() CARGOBAY_NONBLOCKING {
  if (requests_.empty()) return;  // cheaper to check than a Request to make
  Request request;
  for (std::size_t i = 0; i < kMostRequests; ++i) {
    if (sender_.request_waits() || !requests_.pop(request)) return;
    if (observer_.request != nullptr) observer_.request(observer_.context, request);
    take_request(request);
  }
}

void CyclePass::take_request(const Request& request) CARGOBAY_NONBLOCKING {
  switch (request.kind) {
    case Request::Kind::command: sender_.take_request(request); break;
    case Request::Kind::stream: sender_.rotation().stream(request.extras); break;
    case Request::Kind::look: sender_.rotation().look_at(request.extras); break;
    case Request::Kind::pose: odometry_.reset(request.pose); break;
  }
}

// Books the arrival, and brings loop and odometry up to the present tick.
void CyclePass::account(rt::TimePoint arrival) CARGOBAY_NONBLOCKING {
  const bool counting = ledger_.clock().started();
  const TickLedger::Account account =
      ledger_.book({.time = arrival,
                    .frames = static_cast<int>(receiver_.readings().size()),
                    .corrupt = receiver_.take_corrupt(),
                    .bytes = receiver_.bytes()});
  if (account.says_more) sender_.doubt_hearing();
  if (counting) step_through(account);
  for (const auto& reading : receiver_.readings()) {
    loop_.frame(reading);
    odometry_.step(loop_.take_travels(), loop_.belief(), loop_.sure());
  }
  if (silence_.end(ledger_.deadline())) report(EventKind::silence_ended);
}

// Steps through the ticks whose frames have not come, and those taken for lost that have.
void CyclePass::step_through(const TickLedger::Account& account) CARGOBAY_NONBLOCKING {
  if (account.bytes_missing) sender_.doubt_hearing();
  if (account.incomplete) sender_.see_missing();
  loop_.lost(account.to_step, sender_.may_have_read(account.never_came));
  if (account.lost < 0) loop_.came_after_all(-account.lost);
  if (account.lost > 0) {
    report({.what = EventKind::frames_lost, .frames = static_cast<std::uint32_t>(account.lost)},
           ledger_.clock().ticks());
  }
  // A frame that is missing when a window ends may have taken most of the window's counts with it.
  // A frame that was missing earlier, but came, has not.
  const rt::TickClock& clock = ledger_.clock();
  const rt::Axes read = receiver_.reads();
  if (clock.in_doubt()) {
    loop_.doubt_next_reading(read);
  } else if (clock.missing() > 0) {
    const rt::Axes ends = sender_.ends_window();
    loop_.doubt_next_reading(
        {.distance = read.distance && ends.distance, .turn = read.turn && ends.turn});
  }
  loop_.came_after_all(account.stepped_early);
  if (ledger_.late()) ++counters_.overruns.wait;
  if (!clock.in_phase()) loop_.sent_late();  // this concerns what was sent before
}

CycleState CyclePass::state_at(rt::TimePoint arrival) const CARGOBAY_NONBLOCKING {
  return {.tick = ledger_.clock().ticks(),
          .arrival = arrival,
          .estimate = loop_.estimate(),
          .remainder = loop_.belief(),
          .mode = mode_watch_.mode(),
          .hazards = hazards_in(receiver_.values()),
          .reading = receiver_.readings()[receiver_.readings().size() - 1],
          .battery_mv = power_.battery().voltage_mv,
          .bumps = seen_.bumps,
          .pose = odometry_.now().pose(),
          .distance_mm = odometry_.now().distance_mm(),
          .pose_covariance = odometry_.now().covariance()};
}

CyclePass::Step CyclePass::answer_in_mode(CycleState& state) CARGOBAY_NONBLOCKING {
  if (mode_watch_.state() == ModeWatch::State::driving) {
    return see_wheels() == Step::ended ? Step::ended : control(state);
  }
  const bool known = mode_watch_.state() == ModeWatch::State::lost;
  if (known && parameters_.on_mode_loss == OnModeLoss::end) return end(CycleEnd::mode_lost);
  state.setpoint_lapsed = !steered_;
  return hold();
}

// Closes the loop for this tick, with one write.
CyclePass::Step CyclePass::control(CycleState& state) CARGOBAY_NONBLOCKING {
  const rt::TimePoint read = stream_.now();
  if (read - state.arrival > CommandSender::kOwnWork) ++counters_.overruns.read;
  ControlAnswer wanted{ControlAnswer::Kind::setpoint};
  if (control_.is_set()) wanted = control_.ask(state);
  if (control_.refusal() != UserControl::Refusal::none) see_refusal();
  steered_ = wanted.kind() != ControlAnswer::Kind::setpoint;
  if (!steered_) wanted = by_setpoint(state.arrival);
  const rt::TimePoint decided = stream_.now();
  if (control_.over_budget(decided - read)) ++counters_.overruns.user;
  if (control_.too_many_overruns()) return end(CycleEnd::control_overrun);
  if (wanted.kind() == ControlAnswer::Kind::finish) return end(CycleEnd::asked);
  if (wanted.kind() == ControlAnswer::Kind::fail) return end(CycleEnd::control_failed);

  state.setpoint_lapsed = wanted.kind() == ControlAnswer::Kind::stand;
  state.target = wanted.speeds();
  state.command = state.setpoint_lapsed ? loop_.stand() : loop_.control(state.target);
  state.set = loop_.set();
  see_limits(state);
  const FrameList list = next_list();
  const rt::WheelSpeeds former = sender_.acting();
  const Sent sent = sender_.must_withhold(decided, ledger_)
                        ? Sent::withheld
                        : sender_.drive(state.command, list, moment(decided));
  const rt::TimePoint written = stream_.now();
  if (written - decided > CommandSender::kOwnWork) ++counters_.overruns.write;
  outlets_.frame_to_command_ns.record(
      static_cast<std::uint64_t>((written - state.arrival).count()));
  if (sent == Sent::failed) return hung_up(sender_.port_error());
  if (sent != Sent::whole) {
    ++(sent == Sent::withheld ? counters_.withheld : counters_.unsent);
    state.command = sender_.acting();
    loop_.not_sent(state.command);
  }
  if (ledger_.late() && changes(former, sender_.acting())) loop_.sent_late();
  return Step::on;
}

// The robot is not in its mode: it obeys no wheel command, and speeds asked for earlier no longer
// count. Sends only lists, and the mode if that was requested.
CyclePass::Step CyclePass::hold() CARGOBAY_NONBLOCKING {
  loop_.stop();
  setpoint_.drop();
  const FrameList list = next_list();
  std::optional<oi::Mode> mode;
  if (mode_watch_.state() == ModeWatch::State::lost &&
      rearm_requested_.exchange(false, std::memory_order_relaxed)) {
    mode = parameters_.drive_mode;
    mode_watch_.rearm();
  }
  return sender_.keep(list, mode, moment(wait_.woken)) == Sent::failed
             ? hung_up(sender_.port_error())
             : Step::on;
}

FrameList CyclePass::next_list() CARGOBAY_NONBLOCKING {
  using Counters = FrameRotation::Counters;
  // A robot that loses the remainder is read rarely anyway; one that stands loses nothing.
  const bool settled =
      loop_.belief() == rt::RemainderBelief::carried || loop_.command() == rt::WheelSpeeds{};
  const rt::Axes axes = loop_.next_reads();
  const Counters counters = !axes.any() ? Counters::not_wanted
                            : settled   ? Counters::welcome
                                        : Counters::wanted;
  std::optional<FrameList> search;
  if (mode_watch_.state() == ModeWatch::State::searching) search = mode_watch_.wanted();
  return sender_.next_list(counters, axes, search);
}

CommandSender::Moment CyclePass::moment(rt::TimePoint now) const CARGOBAY_NONBLOCKING {
  return {.now = now,
          .woken = wait_.woken,
          .frames_read = !receiver_.empty(),
          .mode = mode_watch_.mode(),
          .set_stands = loop_.set() == rt::WheelSpeeds{}};
}

ControlAnswer CyclePass::by_setpoint(rt::TimePoint now) CARGOBAY_NONBLOCKING {
  if (setpoint_lapsed(now)) return ControlAnswer::Kind::stand;
  return setpoint_.speeds();
}

bool CyclePass::setpoint_lapsed(rt::TimePoint now) CARGOBAY_NONBLOCKING {
  const Setpoint::Age age = setpoint_.see(now);
  if (age == Setpoint::Age::lapses) report(EventKind::setpoint_lapsed);
  return age != Setpoint::Age::alive;
}

// The deadline passed without a frame. The last command keeps acting; nothing is sent, so that no
// tick gets two commands if the frame comes after all. Only a longer silence is answered, once,
// with a stop: from there the wheels start again.
CyclePass::Step CyclePass::deadline_passed() CARGOBAY_NONBLOCKING {
  ++counters_.frames.late;
  const rt::TimePoint now = stream_.now();
  switch (silence_.deadline_passed(now, ledger_.last_arrival())) {
    case Silence::Due::nothing: break;
    case Silence::Due::stop: stop_in_silence(now); break;
    case Silence::Due::link_lost: ledger_.close(now); return end(CycleEnd::link_lost);
  }
  return silence_.owes_stop() ? send_owed_stop(now) : Step::on;
}

// We assume that the last command was obeyed until now, and that none is from now on.
void CyclePass::stop_in_silence(rt::TimePoint now) CARGOBAY_NONBLOCKING {
  silence_.owe_stop(mode_watch_.state() == ModeWatch::State::driving);
  const int foreseen = ledger_.foresee(now);
  if (foreseen > 0) loop_.lost(foreseen, rt::kBothAxes);
  loop_.stop();
  sender_.doubt_hearing();
  report(EventKind::silence_began);
}

CyclePass::Step CyclePass::send_owed_stop(rt::TimePoint now) CARGOBAY_NONBLOCKING {
  const Sent sent = sender_.drive({}, sender_.list(), moment(now));
  silence_.owe_stop(sent == Sent::not_whole);
  if (silence_.owes_stop()) ++counters_.unsent;
  return sent == Sent::failed ? hung_up(sender_.port_error()) : Step::on;
}

void CyclePass::stop_wheels() CARGOBAY_NONBLOCKING {
  if (end_ == CycleEnd::hung_up || end_ == CycleEnd::guarded) return;  // farewell() tries
  // In Passive the robot would not obey, and the command is reported to spoil the next start.
  const bool obeys = mode_watch_.mode() == oi::Mode::safe || mode_watch_.mode() == oi::Mode::full;
  if (mode_watch_.state() != ModeWatch::State::driving && !obeys) return;
  // What fails here, farewell() tries again.
  (void)sender_.drive({}, sender_.list(), moment(stream_.now()));
}

}  // namespace cargobay::hal
