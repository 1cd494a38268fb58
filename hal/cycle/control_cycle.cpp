#include "hal/cycle/control_cycle.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "hal/stream/spaced_stream.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal {
namespace {

// Behind the last bit of a frame its bytes may be handed over this much later.
constexpr rt::Duration kHandOver = std::chrono::milliseconds{1};
// A frame's bytes may come in two pieces, a USB adapter's 16 ms apart. After so many ticks nothing
// more comes.
constexpr int kQuietTicks = 2;
// What the adapter and the kernel may add to the way of a frame and of its answer together: 2 ms of
// the robot's 15.
constexpr rt::Duration way_around(rt::Duration tick) { return tick * 2 / 15; }
// What takes longer of our own work, which is microseconds, was kept from the processor.
constexpr rt::Duration kOwnWork = std::chrono::milliseconds{1};

// Of one among others that are sent.
rt::Duration time_of_byte(std::uint32_t baud) {
  return sending_time(2, baud) - sending_time(1, baud);
}

// Zeros that fit between a frame and the command that answers it in the same tick.
std::size_t most_fill(rt::Duration tick, std::uint32_t baud) {
  const rt::Duration room = tick - oi::wire_time(kFrameBytes, baud) -
                            sending_time(oi::kDriveDirectBytes, baud) - way_around(tick);
  const rt::Duration least = std::max(room, rt::Duration::zero());
  const auto bytes = static_cast<std::size_t>(least / time_of_byte(baud));
  return std::clamp(bytes, ControlCycle::kLongestOwnRest, Outgoing::kMostFill);
}

// What goes out beside the loop's longest commands, a drive and a list, before the next tick; no
// more than the guard lets wait before its stop.
std::size_t spare_bytes(rt::Duration tick, std::uint32_t baud) {
  constexpr std::size_t kOwn = oi::kDriveDirectBytes + 2 + kSignalsLeftList.size();
  constexpr std::size_t kMostSpare = kMostBacklog - kOwn;
  const rt::Duration room = tick - sending_time(kOwn, baud) - way_around(tick);
  const auto bytes = std::max(room, rt::Duration::zero()) / time_of_byte(baud);
  return std::min(static_cast<std::size_t>(bytes), kMostSpare);
}

// So much that it matters in which tick the robot gets the second.
bool changes(const rt::WheelSpeeds& before,
             const rt::WheelSpeeds& after) noexcept CARGOBAY_NONBLOCKING {
  constexpr double kLeast = 10.0;  // mm/s: in one tick 0.15 of the counter's millimetres
  return std::abs(after.left_mm_s - before.left_mm_s) > kLeast ||
         std::abs(after.right_mm_s - before.right_mm_s) > kLeast;
}

// Also false where one is no number.
bool in_range(const rt::WheelSpeeds& speeds) noexcept CARGOBAY_NONBLOCKING {
  constexpr double kMost = oi::kMaxWheelSpeed;
  return std::abs(speeds.left_mm_s) <= kMost && std::abs(speeds.right_mm_s) <= kMost;
}

}  // namespace

ControlCycle::ControlCycle(ByteStream& stream, const Parameters& parameters)
    : stream_{stream.at_this_rate()},
      parameters_{parameters},
      tick_{std::llround(parameters.loop.estimator.tick_s * 1e9)},
      way_around_{way_around(tick_)},
      frame_time_{oi::wire_time(kFrameBytes, stream.baud())},
      command_time_{sending_time(oi::kDriveDirectBytes, stream.baud())},
      byte_time_{time_of_byte(stream.baud())},
      spare_bytes_{hal::spare_bytes(tick_, stream.baud())},
      most_fill_{most_fill(tick_, stream.baud())},
      loop_{parameters.loop},
      odometry_{parameters.odometry},
      ticks_{tick_},
      mode_watch_{parameters.drive_mode},
      power_{parameters.power} {}

bool ControlCycle::set_speeds(const rt::WheelSpeeds& speeds) noexcept CARGOBAY_NONBLOCKING {
  return in_range(speeds) && setpoint_.put(speeds);
}

CycleEnd ControlCycle::run() noexcept CARGOBAY_NONBLOCKING {
  begin();
  while (pass()) {
  }
  return finish();
}

void ControlCycle::begin() noexcept CARGOBAY_NONBLOCKING {
  last_arrival_ = stream_.now();
  last_bytes_ = last_arrival_;
  deadline_ = last_arrival_ + parameters_.stop_after;
}

bool ControlCycle::pass() noexcept CARGOBAY_NONBLOCKING {
  return !stop_requested_.load(std::memory_order_relaxed) && receive() != Step::ended;
}

CycleEnd ControlCycle::finish() noexcept CARGOBAY_NONBLOCKING {
  stop_wheels();
  return end_;
}

// One pass of the loop: one wait, one read, and where frames are complete, one write.
ControlCycle::Step ControlCycle::receive() noexcept CARGOBAY_NONBLOCKING {
  const ByteStream::Wait woken = stream_.wait(wake_time());
  const rt::TimePoint now = stream_.now();
  woken_ = now;
  passed_ns_.store(rt::nanoseconds(now), std::memory_order_relaxed);  // carries nothing else
  switch (guard_.beat(now)) {
    case GuardMark::Robot::ours: break;
    case GuardMark::Robot::taken: return end(CycleEnd::guarded);
    case GuardMark::Robot::unguarded: return end(CycleEnd::guard_lost);
  }
  if (announced_silence_.load(std::memory_order_relaxed) != kNoneAnnounced) {
    expected_until_ = now + announced_silence_.exchange(kNoneAnnounced, std::memory_order_relaxed);
  }
  if (woken == ByteStream::Wait::hung_up) return hung_up(0);

  // Also after a time-out: fewer bytes than a frame may be there, and must not stay behind.
  const ByteStream::Transfer transfer = stream_.read(received_);
  if (transfer.error != 0) return hung_up(transfer.error);
  if (transfer.count > 0) last_bytes_ = now;
  decode({received_.data(), transfer.count});
  if (readings_.empty() && now - last_bytes_ >= kQuietTicks * tick_) give_up_open_frame();
  if (!readings_.empty()) return answer(now);
  return now >= deadline_ ? late() : Step::on;
}

// Frames are waited for whole. One that was taken in pieces has a rest, which is fetched by itself:
// left to wait for a frame's worth of bytes it would come with most of the next, and so for ever.
rt::TimePoint ControlCycle::wake_time() const noexcept CARGOBAY_NONBLOCKING {
  const oi::StreamDecoder::Counters& bytes = decoder_.counters();
  const bool whole = bytes.framed + bytes.skipped == bytes.bytes;
  return whole ? deadline_ : std::min(deadline_, stream_.now() + frame_time_ + kHandOver);
}

ControlCycle::Step ControlCycle::hung_up(int error) noexcept CARGOBAY_NONBLOCKING {
  port_error_ = stream_.still_open() ? error : EBADF;
  return end(CycleEnd::hung_up);
}

ControlCycle::Step ControlCycle::answer(rt::TimePoint arrival) noexcept CARGOBAY_NONBLOCKING {
  take_requests();
  std::optional<rt::Duration> period;
  if (ticks_.started()) period = arrival - last_arrival_;
  account(arrival);
  CycleState state{.tick = ticks_.ticks(),
                   .arrival = arrival,
                   .estimate = loop_.estimate(),
                   .remainder = loop_.belief(),
                   .mode = mode_watch_.mode(),
                   .hazards = hazards_in(sensors_),
                   .reading = readings_[readings_.size() - 1],
                   .battery_mv = power_.battery().voltage_mv,
                   .bumps = bumps_,
                   .pose = odometry_.pose(),
                   .distance_mm = odometry_.distance_mm(),
                   .pose_covariance = odometry_.covariance()};
  // Behind a silence the second frame tells how many ticks it was: until then there is no estimate.
  const bool doubtful = mode_watch_.state() == ModeWatch::State::driving && ticks_.in_doubt();
  const Step step = doubtful ? Step::on : answer_in_mode(state);
  // The command is out: from here on nothing is urgent.
  if (period) period_ns_.record(static_cast<std::uint64_t>(period->count()));
  if (!doubtful) publish(state);
  return step;
}

void ControlCycle::publish(const CycleState& state) noexcept CARGOBAY_NONBLOCKING {
  counters_mail_.put(counters_);
  state_.put(state);
  history_.push(state);
  if (observer_.function != nullptr) observer_.function(observer_.context, state);
}

ControlCycle::Step ControlCycle::answer_in_mode(CycleState& state) noexcept CARGOBAY_NONBLOCKING {
  if (mode_watch_.state() == ModeWatch::State::driving) return control(state);
  const bool known = mode_watch_.state() == ModeWatch::State::lost;
  if (known && parameters_.on_mode_loss == OnModeLoss::end) return end(CycleEnd::mode_lost);
  state.setpoint_lapsed = control_.function == nullptr;
  return hold();
}

// Closes the loop on this tick, with one write.
ControlCycle::Step ControlCycle::control(CycleState& state) noexcept CARGOBAY_NONBLOCKING {
  const rt::TimePoint read = stream_.now();
  if (read - state.arrival > kOwnWork) ++counters_.overruns.read;
  state.setpoint_lapsed = control_.function == nullptr && setpoint_lapsed(state.arrival);
  state.target = wanted(state);
  const rt::TimePoint decided = stream_.now();
  const bool over = control_.function != nullptr && decided - read > parameters_.control_budget;
  overruns_in_a_row_ = over ? overruns_in_a_row_ + 1 : 0;
  if (over) ++counters_.overruns.user;
  if (overruns_in_a_row_ > parameters_.control_overruns_allowed)
    return end(CycleEnd::control_overrun);

  state.command = loop_.control(state.target);
  state.set = loop_.set();
  const FrameList list = next_list();
  const rt::TimePoint reaches = std::max(decided, line_free_) + fill_time(fill());
  // Behind a long command the next would come when it is no more true.
  const bool line_busy = line_free_ - decided > way_around_;
  const bool withhold = line_busy || tick_has_command(reaches);
  const rt::WheelSpeeds former = acting_;
  const Sent sent = withhold ? Sent::withheld : send(state.command, list, decided);
  const rt::TimePoint written = stream_.now();
  if (written - decided > kOwnWork) ++counters_.overruns.write;
  frame_to_command_ns_.record(static_cast<std::uint64_t>((written - state.arrival).count()));
  if (sent == Sent::failed) return hung_up(port_error_);
  if (sent != Sent::whole) {
    ++(sent == Sent::withheld ? counters_.withheld : counters_.unsent);
    loop_.not_sent(acting_);
    state.command = acting_;
  }
  if (late_ && changes(former, acting_)) loop_.sent_late();
  return Step::on;
}

// The robot is not in its mode: it obeys no wheel command, and what was asked of the wheels counts
// no more. Only lists are sent, and the mode where somebody asked for it.
ControlCycle::Step ControlCycle::hold() noexcept CARGOBAY_NONBLOCKING {
  loop_.stop();
  acting_ = {};
  setpoint_serial_ = setpoint_.get().serial;
  setpoint_alive_ = false;
  const FrameList list = next_list();
  if (mode_watch_.state() == ModeWatch::State::lost &&
      rearm_requested_.exchange(false, std::memory_order_relaxed)) {
    outgoing_.add_mode(parameters_.drive_mode);
    mode_watch_.rearm();
  }
  outgoing_.add_fill(fill());
  add_list(list);
  add_command();
  return write_out(woken_) == Sent::failed ? hung_up(port_error_) : Step::on;
}

FrameList ControlCycle::next_list() noexcept CARGOBAY_NONBLOCKING {
  using Counters = FrameRotation::Counters;
  const bool searching = mode_watch_.state() == ModeWatch::State::searching;
  // A robot that loses the remainder is read seldom anyway; one that stands loses nothing.
  const bool settled =
      loop_.belief() == rt::RemainderBelief::carried || loop_.command() == rt::WheelSpeeds{};
  const Counters counters = !loop_.next_reads() ? Counters::not_wanted
                            : settled           ? Counters::welcome
                                                : Counters::wanted;
  FrameList next = searching ? mode_watch_.wanted() : rotation_.next(counters);
  if (hearing_.deaf() && !searching) next = hearing_.probe();
  former_list_ = list_;
  const bool may_read = next == FrameList::reading || former_list_ == FrameList::reading;
  ticks_since_reads_ = may_read ? 0 : ticks_since_reads_ + 1;
  return next;
}

// The frame that is answered.
bool ControlCycle::on_time() const noexcept CARGOBAY_NONBLOCKING {
  const rt::Duration behind = last_arrival_ - ticks_.due_by(last_arrival_ + way_around_);
  return ticks_.knows_phase() && readings_.size() == 1 && behind <= way_around_;
}

// Whether the robot may get what is sent then in the same tick as the last command: a frame that
// was very late has been answered in the tick of the next. Unless this one is on time without
// doubt, commands are nearly a tick apart in any case: where all frames are late the phase does not
// show.
bool ControlCycle::tick_has_command(rt::TimePoint sent) const noexcept CARGOBAY_NONBLOCKING {
  if (!on_time() && sent - last_command_ < tick_ - way_around_) return true;
  if (!ticks_.in_phase()) return false;
  // A command reaches the robot in a new tick where it is sent so long before that tick's frame.
  const rt::Duration lead = frame_time_ + command_time_;
  const rt::TimePoint tick_began = ticks_.due_by(sent + lead) - lead;
  return last_command_ > tick_began - way_around_;
}

rt::WheelSpeeds ControlCycle::wanted(const CycleState& state) noexcept CARGOBAY_NONBLOCKING {
  if (control_.function != nullptr) return ask_control(state);
  return state.setpoint_lapsed ? rt::WheelSpeeds{} : setpoint_.get().speeds;
}

rt::WheelSpeeds ControlCycle::ask_control(const CycleState& state) noexcept CARGOBAY_NONBLOCKING {
  const double seconds = static_cast<double>(state.tick) * rt::seconds(tick_);
  const rt::WheelSpeeds speeds = control_.function(control_.context, state, seconds);
  const bool sane = in_range(speeds);
  if (!sane) ++counters_.refused;
  if (!sane && control_was_sane_) tell(EventKind::control_refused);
  control_was_sane_ = sane;
  return sane ? speeds : rt::WheelSpeeds{};
}

// A setpoint counts from the cycle that first sees it. One that has lapsed stays so.
bool ControlCycle::setpoint_lapsed(rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING {
  const std::uint32_t serial = setpoint_.get().serial;
  if (serial != setpoint_serial_) {
    setpoint_serial_ = serial;
    setpoint_time_ = now;
    setpoint_alive_ = true;
  }
  if (setpoint_alive_ && now - setpoint_time_ > parameters_.setpoint_lapse) {
    setpoint_alive_ = false;
    tell(EventKind::setpoint_lapsed);
  }
  return !setpoint_alive_;
}

// The deadline passed without a frame. What was last commanded goes on acting; nothing is sent, so
// that no tick sees two commands when the frame comes after all. Only a longer silence is answered,
// once, by a stop: from there the wheels start again.
ControlCycle::Step ControlCycle::late() noexcept CARGOBAY_NONBLOCKING {
  ++counters_.frames.late;
  deadline_ += tick_;
  const rt::TimePoint now = stream_.now();
  const rt::Duration silence = now - last_arrival_;
  if (silence >= parameters_.link_timeout && now >= expected_until_) {
    account_for_silence();
    return end(CycleEnd::link_lost);
  }
  if (silence >= parameters_.stop_after && !stopped_in_silence_) stop_in_silence();
  if (!stop_owed_) return Step::on;
  const Sent sent = send({}, list_, now);
  stop_owed_ = sent == Sent::not_whole;
  if (stop_owed_) ++counters_.unsent;
  return sent == Sent::failed ? hung_up(port_error_) : Step::on;
}

// Whole means that this very command was.
ControlCycle::Sent ControlCycle::send(const rt::WheelSpeeds& command, FrameList list,
                                      rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING {
  const std::size_t zeros = fill();
  last_command_ = now + fill_time(zeros);
  // The rest of a command is one: another behind it would be the second in this tick. A stop does
  // not wait for the next.
  const bool only_rest = outgoing_.drives() && command != rt::WheelSpeeds{};
  if (!only_rest) {
    outgoing_.add_fill(zeros);
    outgoing_.add_drive(command);
    add_list(list);
    add_command();
  }
  const Sent sent = write_out(now);
  return only_rest && sent == Sent::whole ? Sent::withheld : sent;
}

// A line that went dead for a while may have cut a command in two, and its robot takes the next one
// for the rest: so zeros come first, which are no harm as data and nothing as opcodes. What they
// complete may be a list, which is why the list follows. A robot that does not stream what it was
// told gets as many as there is room for: a command that it misread may want hundreds.
std::size_t ControlCycle::fill() const noexcept CARGOBAY_NONBLOCKING {
  // The rest of a command comes before anything else, and completes it.
  if (!outgoing_.empty()) return 0;
  if (hearing_.deaf()) return most_fill_;
  return hearing_in_doubt_ || hearing_.misheard() ? longest_rest() : 0;
}

void ControlCycle::add_list(FrameList list) noexcept CARGOBAY_NONBLOCKING {
  const bool again = list_in_doubt_ || !hears();
  if (list != list_ || again) outgoing_.add_list(list);
}

// Gives the port what is outgoing, in one write. That it still is the port needs no look where a
// whole frame, checksum and all, was just read from the same descriptor: nothing else sends those.
ControlCycle::Sent ControlCycle::write_out(rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING {
  if (outgoing_.empty()) return Sent::whole;
  const bool proven = !readings_.empty() && now - woken_ <= kOwnWork;
  if (!proven && !stream_.still_open()) return Sent::failed;
  // The owner has given this thread up, and said farewell to the robot in its place.
  if (abandoned_.load()) return Sent::withheld;
  // The next pass ends the cycle.
  if (!guard_.begin_write(outgoing_.bytes().size())) return Sent::withheld;
  const ByteStream::Transfer transfer = stream_.write(outgoing_.bytes());
  if (transfer.error != 0 && transfer.error != EAGAIN) {
    port_error_ = transfer.error;
    return Sent::failed;
  }
  const Outgoing::Taken taken = outgoing_.took(transfer.count);
  if (outgoing_.empty()) guard_.end_write();
  if (taken.fill) {
    hearing_in_doubt_ = false;
    list_in_doubt_ = true;
  }
  if (taken.request) command_.reset();
  if (taken.list) {
    list_ = taken.streamed;
    list_in_doubt_ = false;
    hearing_.told(list_);
  }
  if (taken.drive) acting_ = taken.speeds;
  return taken.missed_drive ? Sent::not_whole : Sent::whole;
}

void ControlCycle::stop_wheels() noexcept CARGOBAY_NONBLOCKING {
  if (end_ == CycleEnd::hung_up || end_ == CycleEnd::guarded) return;  // farewell() tries
  // In Passive it would not obey, and was reported to spoil the next start.
  const bool obeys = mode_watch_.mode() == oi::Mode::safe || mode_watch_.mode() == oi::Mode::full;
  if (mode_watch_.state() != ModeWatch::State::driving && !obeys) return;
  (void)send({}, list_, stream_.now());  // what fails here, farewell() tries again
}

}  // namespace cargobay::hal
