#include "hal/control_cycle.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <optional>

#include "oi/encode.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal {
namespace {

oi::MmPerSec to_wire(double speed_mm_s) noexcept CARGOBAY_NONBLOCKING {
  return oi::MmPerSec{static_cast<std::int32_t>(std::lrint(speed_mm_s))};
}

// Room for DriveDirect and a Stream list behind it.
using Answer = oi::FixedList<std::uint8_t, 64>;

// Behind the last bit of a frame its bytes may be handed over this much later.
constexpr rt::Duration kHandOver = std::chrono::milliseconds{1};
// A frame's bytes may come in two pieces, a USB adapter's 16 ms apart. After this nothing more
// comes.
constexpr rt::Duration kQuiet = 2 * oi::kTick;
// What the adapter and the kernel may add to the way of a frame and of its answer together.
constexpr rt::Duration kWayAround = std::chrono::milliseconds{2};

}  // namespace

ControlCycle::ControlCycle(ByteStream& stream, const Parameters& parameters)
    : stream_{stream},
      parameters_{parameters},
      frame_time_{oi::wire_time(kFrameBytes, stream.baud())},
      command_time_{oi::wire_time(oi::kDriveDirectBytes, stream.baud())},
      loop_{parameters.loop},
      ticks_{oi::kTick},
      mode_{parameters.drive_mode} {}

bool ControlCycle::set_speeds(const rt::WheelSpeeds& speeds) noexcept CARGOBAY_NONBLOCKING {
  const auto in_range = [](double speed_mm_s) {
    return std::abs(speed_mm_s) <= oi::kMaxWheelSpeed;
  };
  return in_range(speeds.left_mm_s) && in_range(speeds.right_mm_s) && setpoint_.put(speeds);
}

CycleEnd ControlCycle::run() noexcept CARGOBAY_NONBLOCKING {
  last_arrival_ = stream_.now();
  last_bytes_ = last_arrival_;
  deadline_ = last_arrival_ + parameters_.stop_after;
  while (!stop_requested_.load(std::memory_order_relaxed)) {
    if (receive() == Step::ended) break;
  }
  stop_wheels();
  return end_;
}

// One pass of the loop: one wait, one read, and where frames are complete, one write.
ControlCycle::Step ControlCycle::receive() noexcept CARGOBAY_NONBLOCKING {
  const ByteStream::Wait woken = stream_.wait(wake_time());
  const rt::TimePoint now = stream_.now();
  if (!guard_.beat(now)) return end(CycleEnd::guarded);
  if (woken == ByteStream::Wait::hung_up) return end(CycleEnd::hung_up);

  // Also after a time-out: fewer bytes than a frame may be there, and must not stay behind.
  const ByteStream::Transfer transfer = stream_.read(received_);
  if (transfer.error != 0) return end(CycleEnd::hung_up);
  if (transfer.count > 0) last_bytes_ = now;
  Readings readings = decode({received_.data(), transfer.count});
  if (readings.empty() && now - last_bytes_ >= kQuiet) give_up_open_frame(readings);
  if (!readings.empty()) return answer(now, readings);
  return now >= deadline_ ? late() : Step::on;
}

// Frames are waited for whole. One that was taken in pieces has a rest, which is fetched by itself:
// left to wait for a frame's worth of bytes it would come with most of the next, and so for ever.
rt::TimePoint ControlCycle::wake_time() const noexcept CARGOBAY_NONBLOCKING {
  const oi::StreamDecoder::Counters& bytes = decoder_.counters();
  const bool whole = bytes.framed + bytes.skipped == bytes.bytes;
  return whole ? deadline_ : std::min(deadline_, stream_.now() + frame_time_ + kHandOver);
}

ControlCycle::Readings ControlCycle::decode(std::span<const std::uint8_t> bytes) noexcept
    CARGOBAY_NONBLOCKING {
  using Outcome = oi::StreamDecoder::Outcome;
  Readings readings;
  for (const std::uint8_t byte : bytes) {
    for (Outcome outcome = decoder_.push(byte); outcome != Outcome::nothing;
         outcome = decoder_.next()) {
      take(outcome, readings);
    }
  }
  return readings;
}

// The line is quiet: what looked like the beginning of a frame will not be finished, and may have
// hidden a whole one.
void ControlCycle::give_up_open_frame(Readings& readings) noexcept CARGOBAY_NONBLOCKING {
  using Outcome = oi::StreamDecoder::Outcome;
  for (Outcome outcome = decoder_.abandon(); outcome != Outcome::nothing;
       outcome = decoder_.abandon()) {
    take(outcome, readings);
  }
}

void ControlCycle::take(oi::StreamDecoder::Outcome outcome,
                        Readings& readings) noexcept CARGOBAY_NONBLOCKING {
  if (outcome == oi::StreamDecoder::Outcome::corrupt) {
    ++damaged_;
  } else {
    (void)readings.push_back(take_frame());  // has room: a frame is at least 5 bytes
  }
}

std::optional<rt::WheelEstimator::Reading> ControlCycle::take_frame() noexcept
    CARGOBAY_NONBLOCKING {
  sensors_.clear();
  (void)oi::decode_frame(decoder_.frame(), sensors_);  // whole: the decoder checked its structure
  if (sensors_.has(oi::PacketId::oi_mode)) mode_ = sensors_.mode();
  misheard_ = !as_told();
  if (sensors_.has(oi::PacketId::voltage)) battery_mv_ = sensors_.raw(oi::PacketId::voltage);
  if (!sensors_.has(oi::PacketId::distance) || !sensors_.has(oi::PacketId::angle))
    return std::nullopt;
  return rt::WheelEstimator::Reading{.distance_mm = sensors_.raw(oi::PacketId::distance),
                                     .angle_deg = sensors_.raw(oi::PacketId::angle)};
}

// Whether the frame is of one of the lists that the robot may be streaming now. A command has no
// checksum: one damaged on its way may have asked for other packets, or have gone unheard.
bool ControlCycle::as_told() const noexcept CARGOBAY_NONBLOCKING {
  if (decoder_.frame().size() != kFrameBytes || !sensors_.has(oi::PacketId::oi_mode)) return false;
  const bool reads = sensors_.has(oi::PacketId::distance) && sensors_.has(oi::PacketId::angle);
  const bool window = sensors_.has(oi::PacketId::voltage) && sensors_.has(oi::PacketId::current);
  return (reads && (list_reads_ || former_list_reads_)) ||
         (window && !(list_reads_ && former_list_reads_));
}

// Books the arrival, good and lost, and takes the estimator to the present tick.
void ControlCycle::account(rt::TimePoint arrival,
                           const Readings& readings) noexcept CARGOBAY_NONBLOCKING {
  frames_.good += readings.size();
  if (!ticks_.started()) {
    ticks_.start(arrival);
    damaged_ = 0;  // the tail of whatever was under way when we began to listen
  } else {
    const int lost = ticks_.arrived(arrival, static_cast<int>(readings.size()), damaged_);
    const auto given_up = static_cast<std::uint64_t>(std::max(lost, 0));
    const std::uint64_t bad = std::min(damaged_, given_up);
    const std::uint64_t never_came = given_up - bad;
    // What never came is missed late, so the list that it was of may be an older one.
    loop_.lost(lost - foreseen_,
               ticks_since_reads_ <= (never_came == 0 ? 1 : rt::TickClock::kPatience + 1));
    frames_.bad += bad;
    frames_.lost += never_came;
    if (lost < 0) take_back(static_cast<std::uint64_t>(-lost));
    // One frame may be damaged in several places, and noise between two frames damages none.
    damaged_ = ticks_.missing() == 0 ? 0 : damaged_ - bad;
    if (ticks_.in_doubt()) {
      loop_.doubt_next_reading();
    } else {
      foreseen_ = 0;
    }
    period_ns_.record(static_cast<std::uint64_t>((arrival - last_arrival_).count()));
  }
  for (const auto& reading : readings) loop_.frame(reading);
  last_arrival_ = arrival;
  stopped_in_silence_ = false;
  deadline_ = ticks_.expected() + parameters_.late_margin;
}

// Frames that were given up are here. Of the bad ones, what looked like their remains was noise.
void ControlCycle::take_back(std::uint64_t frames) noexcept CARGOBAY_NONBLOCKING {
  const std::uint64_t lost = std::min(frames, frames_.lost);
  frames_.lost -= lost;
  frames_.bad -= frames - lost;
}

// Of the robot, that passed since the last frame. For a deadline that is over.
std::int64_t ControlCycle::silent_ticks() const noexcept CARGOBAY_NONBLOCKING {
  return (stream_.now() - ticks_.expected()) / oi::kTick + 1;
}

// Up to now the last command was obeyed; from now on none is.
void ControlCycle::stop_in_silence() noexcept CARGOBAY_NONBLOCKING {
  stopped_in_silence_ = true;
  if (ticks_.started()) {
    foreseen_ = static_cast<int>(silent_ticks());
    loop_.lost(foreseen_, true);
  }
  loop_.stop();
}

// The link is lost, and with it what was due by now.
void ControlCycle::account_for_silence() noexcept CARGOBAY_NONBLOCKING {
  if (!ticks_.started()) return;
  const auto due = static_cast<std::uint64_t>(ticks_.missing() + silent_ticks());
  const std::uint64_t bad = std::min(damaged_, due);
  frames_.bad += bad;
  frames_.lost += due - bad;
}

ControlCycle::Step ControlCycle::answer(rt::TimePoint arrival,
                                        const Readings& readings) noexcept CARGOBAY_NONBLOCKING {
  account(arrival, readings);
  CycleState state{.tick = ticks_.ticks(),
                   .arrival = arrival,
                   .mode = mode_,
                   .estimate = loop_.estimate(),
                   .remainder = loop_.belief(),
                   .battery_mv = battery_mv_};
  const bool in_mode = state.mode == parameters_.drive_mode;
  // Behind a silence the second frame tells how many ticks it was: until then there is no estimate.
  if (in_mode && ticks_.in_doubt()) return Step::on;
  const Step step = in_mode ? control(state) : end(CycleEnd::mode_lost);
  state_.put(state);
  history_.push(state);
  return step;
}

// Closes the loop on this tick, with one write.
ControlCycle::Step ControlCycle::control(CycleState& state) noexcept CARGOBAY_NONBLOCKING {
  state.setpoint_lapsed = control_.function == nullptr && setpoint_lapsed(state.arrival);
  const rt::WheelSpeeds former = loop_.command();
  state.command = loop_.control(wanted(state));
  state.set = loop_.set();

  const bool reads = loop_.next_reads();
  const Lists lists = reads == list_reads_ && !misheard_ ? Lists::as_before : Lists::changed;
  former_list_reads_ = list_reads_;
  list_reads_ = reads;
  ticks_since_reads_ = list_reads_ || former_list_reads_ ? 0 : ticks_since_reads_ + 1;
  const Sent sent = tick_has_command(stream_.now()) ? Sent::withheld : send(state.command, lists);
  frame_to_command_ns_.record(static_cast<std::uint64_t>((stream_.now() - state.arrival).count()));
  if (sent == Sent::failed) return end(CycleEnd::hung_up);
  if (sent != Sent::whole) {
    ++(sent == Sent::withheld ? withheld_ : unsent_);
    loop_.not_sent(former);
    state.command = former;
    list_reads_ = former_list_reads_;
  }
  return Step::on;
}

// Whether the robot may get what is sent now in the same tick as the last command: a frame that was
// very late has been answered in the tick of the next.
bool ControlCycle::tick_has_command(rt::TimePoint now) const noexcept CARGOBAY_NONBLOCKING {
  if (!ticks_.in_phase()) return now - last_command_ < oi::kTick - kWayAround;
  // A command reaches the robot in a new tick where it is sent so long before that tick's frame.
  const rt::Duration lead = frame_time_ + command_time_;
  const rt::TimePoint tick_began = ticks_.due_by(now + lead) - lead;
  return last_command_ > tick_began - kWayAround;
}

rt::WheelSpeeds ControlCycle::wanted(const CycleState& state) noexcept CARGOBAY_NONBLOCKING {
  if (control_.function != nullptr) {
    const double seconds = static_cast<double>(state.tick) * rt::seconds(oi::kTick);
    const rt::WheelSpeeds speeds = control_.function(control_.context, state, seconds);
    constexpr double kMost = oi::kMaxWheelSpeed;
    const bool sane = std::abs(speeds.left_mm_s) <= kMost && std::abs(speeds.right_mm_s) <= kMost;
    return sane ? speeds : rt::WheelSpeeds{};  // also where it is no number
  }
  return state.setpoint_lapsed ? rt::WheelSpeeds{} : setpoint_.get().speeds;
}

// A setpoint counts from the cycle that first sees it.
bool ControlCycle::setpoint_lapsed(rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING {
  const std::uint32_t serial = setpoint_.get().serial;
  if (serial == 0) return true;
  if (serial != setpoint_serial_) {
    setpoint_serial_ = serial;
    setpoint_time_ = now;
  }
  return now - setpoint_time_ > parameters_.setpoint_lapse;
}

// The deadline passed without a frame. What was last commanded goes on acting; nothing is sent, so
// that no tick sees two commands when the frame comes after all. Only a longer silence is answered,
// once, by a stop: from there the wheels start anew.
ControlCycle::Step ControlCycle::late() noexcept CARGOBAY_NONBLOCKING {
  ++frames_.late;
  deadline_ += oi::kTick;
  const rt::TimePoint now = stream_.now();
  const rt::Duration silence = now - last_arrival_;
  const bool expected = now < expected_until_.load(std::memory_order_relaxed);
  if (silence >= parameters_.link_timeout && !expected) {
    account_for_silence();
    return end(CycleEnd::link_lost);
  }
  if (silence >= parameters_.stop_after && !stopped_in_silence_) {
    stop_in_silence();
    if (send({}, Lists::as_before) == Sent::failed) return end(CycleEnd::hung_up);
  }
  return Step::on;
}

ControlCycle::Sent ControlCycle::send(const rt::WheelSpeeds& command,
                                      Lists lists) noexcept CARGOBAY_NONBLOCKING {
  Answer answer;
  const auto drive = oi::encode(
      oi::DriveDirect{.left = to_wire(command.left_mm_s), .right = to_wire(command.right_mm_s)});
  bool whole =
      drive.has_value() && answer.append(*drive);  // by construction: the loop keeps the range
  if (lists == Lists::changed) {
    const auto list = oi::encode(oi::Stream{list_reads_ ? kReadingList : kWindowList});
    whole = whole && list.has_value() && answer.append(*list);
  }
  last_command_ = stream_.now();
  if (!guard_.begin_write(answer.size())) return Sent::withheld;  // the next pass ends the cycle
  const ByteStream::Transfer transfer = stream_.write(answer);
  if (transfer.error != 0 && transfer.error != EAGAIN) return Sent::failed;
  if (!whole || transfer.count != answer.size()) return Sent::not_whole;
  guard_.end_write();
  return Sent::whole;
}

void ControlCycle::stop_wheels() noexcept CARGOBAY_NONBLOCKING {
  if (end_ == CycleEnd::hung_up || end_ == CycleEnd::guarded) return;
  // In Passive it would not obey, and was reported to spoil the next start.
  const bool obeys = mode_ == oi::Mode::safe || mode_ == oi::Mode::full;
  if (end_ == CycleEnd::mode_lost && !obeys) return;
  (void)send({}, Lists::as_before);  // what fails here, leave() tries again
}

}  // namespace cargobay::hal
