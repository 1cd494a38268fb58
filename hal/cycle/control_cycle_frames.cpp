// What becomes of the bytes that arrive: frames, what they say, and each tick counted once.
#include <algorithm>
#include <utility>

#include "hal/cycle/control_cycle.hpp"

namespace cargobay::hal {
namespace {

// Bytes of a frame that noise left a few less of, or a few more.
constexpr std::size_t kLeastOfAFrame = kFrameBytes - 2;
constexpr std::size_t kMostOfAFrame = kFrameBytes + 2;

}  // namespace

void ControlCycle::decode(std::span<const std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING {
  readings_.clear();
  decoder_.push(bytes, [this](oi::StreamDecoder::Outcome outcome) noexcept CARGOBAY_NONBLOCKING {
    take(outcome);
  });
}

// The line is quiet: what looked like the beginning of a frame will not be finished, and may have
// hidden a whole one.
void ControlCycle::give_up_open_frame() noexcept CARGOBAY_NONBLOCKING {
  using Outcome = oi::StreamDecoder::Outcome;
  for (Outcome outcome = decoder_.abandon(); outcome != Outcome::nothing;
       outcome = decoder_.abandon()) {
    take(outcome);
  }
}

void ControlCycle::take(oi::StreamDecoder::Outcome outcome) noexcept CARGOBAY_NONBLOCKING {
  if (outcome == oi::StreamDecoder::Outcome::corrupt) {
    ++corrupt_;
  } else {
    const std::optional<rt::WheelEstimator::Reading> reading = take_frame();
    (void)readings_.push_back(reading);  // has room: a frame is at least 5 bytes
    // The clock has not counted it yet.
    const auto behind = static_cast<std::int64_t>(readings_.size());
    watch(sensors_, ticks_.started() ? ticks_.ticks() + behind : 0);
  }
}

std::optional<rt::WheelEstimator::Reading> ControlCycle::take_frame() noexcept
    CARGOBAY_NONBLOCKING {
  sensors_.clear();
  (void)oi::decode_frame(decoder_.frame(), sensors_);  // whole: the decoder checked its structure
  hearing_.see(list_of_frame());
  if (!sensors_.has(oi::PacketId::distance) || !sensors_.has(oi::PacketId::angle))
    return std::nullopt;
  return rt::WheelEstimator::Reading{.distance_mm = sensors_.raw(oi::PacketId::distance),
                                     .angle_deg = sensors_.raw(oi::PacketId::angle)};
}

// A command has no checksum: one damaged on its way may have asked for any packets.
std::optional<FrameList> ControlCycle::list_of_frame() const noexcept CARGOBAY_NONBLOCKING {
  using enum oi::PacketId;
  if (decoder_.frame().size() != kFrameBytes || !sensors_.has(oi_mode)) return std::nullopt;
  if (sensors_.has(distance) && sensors_.has(charging_sources)) return FrameList::reading;
  if (sensors_.has(overcurrents)) return FrameList::hazards;
  if (sensors_.has(battery_capacity)) return FrameList::battery;
  if (sensors_.has(wall_signal)) return FrameList::signals_left;
  if (sensors_.has(cliff_right_signal)) return FrameList::signals_right;
  if (sensors_.has(requested_left_velocity)) return FrameList::outputs;
  return std::nullopt;
}

// Looks for what is worth telling.
void ControlCycle::watch(const oi::SensorValues& frame,
                         std::int64_t tick) noexcept CARGOBAY_NONBLOCKING {
  board_.see(frame, tick);
  watch_bumps(frame, tick);
  for (const Event& event : power_.see(frame)) tell(event, tick);
  const std::optional<EventKind> change = mode_watch_.see(frame);
  if (!change) return;
  if (*change == EventKind::mode_lost) {
    mode_loss_causes_ = mode_watch_.causes();
    // Asked for before there was anything to rearm. Who asks upon the event comes later.
    rearm_requested_.store(false, std::memory_order_relaxed);
  }
  tell({.what = *change, .mode = mode_watch_.mode(), .hazards = mode_watch_.causes()}, tick);
}

void ControlCycle::watch_bumps(const oi::SensorValues& frame,
                               std::int64_t tick) noexcept CARGOBAY_NONBLOCKING {
  if (!frame.has(oi::PacketId::bumps_and_wheel_drops)) return;
  const Bumps before = std::exchange(bumps_, bumps_in(frame));
  const Bumps began{static_cast<std::uint8_t>(bumps_.raw() & ~before.raw())};
  if (began.any()) tell({.what = EventKind::bump_began, .bumps = began}, tick);
  if (before.any() && !bumps_.any()) tell({.what = EventKind::bump_ended}, tick);
}

void ControlCycle::tell(Event event, std::int64_t tick) noexcept CARGOBAY_NONBLOCKING {
  event.tick = tick;
  event.time = woken_;
  (void)events_.push(event);  // what is dropped is counted
}

// Books the arrival, good and lost, and takes the estimator to the present tick.
void ControlCycle::account(rt::TimePoint arrival) noexcept CARGOBAY_NONBLOCKING {
  counters_.frames.good += readings_.size();
  const std::uint64_t seen_damaged = newly_damaged(arrival);
  if (!ticks_.started()) {
    late_ = readings_.size() > 1;  // they had been waiting, and more may be
    ticks_.start(arrival);         // damage was to whatever was under way when we began to listen
  } else {
    damaged_ += seen_damaged;
    account_for_ticks(arrival, static_cast<int>(readings_.size()));
    // Of several together all but the last are a tick late at least.
    late_ = readings_.size() > 1 || arrival - ticks_.due_by(arrival) > parameters_.late_margin;
    if (late_) ++counters_.overruns.wait;
    if (!ticks_.in_phase()) loop_.sent_late();  // what was sent before, as shows now
  }
  for (const auto& reading : readings_) {
    loop_.frame(reading);
    odometry_.step(loop_.take_travel());
  }
  last_arrival_ = arrival;
  bytes_ = decoder_.counters().bytes;
  if (stopped_in_silence_) tell(EventKind::silence_ended);
  stopped_in_silence_ = false;
  stop_owed_ = false;
  deadline_ = ticks_.expected() + parameters_.late_margin;
}

// The ticks since the last arrival: with `frames` of them here, the rest bad, lost or still to
// come.
void ControlCycle::account_for_ticks(rt::TimePoint arrival,
                                     int frames) noexcept CARGOBAY_NONBLOCKING {
  const std::int64_t before = ticks_.ticks() + ticks_.missing();
  const int lost = ticks_.arrived(arrival, frames, damaged_);
  const std::int64_t passed = ticks_.ticks() + ticks_.missing() - before;
  if (bytes_are_missing(passed)) hearing_in_doubt_ = true;
  if (lost > 0 || ticks_.missing() > 0) hearing_.missed();
  const auto given_up = static_cast<std::uint64_t>(std::max(lost, 0));
  const std::uint64_t bad = std::min(damaged_, given_up);
  const std::uint64_t never_came = given_up - bad;
  const int unforeseen = std::max(lost - foreseen_, 0);
  foreseen_ -= std::max(lost, 0) - unforeseen;
  // What never came is missed late, so the list that it was of may be an older one.
  loop_.lost(unforeseen,
             ticks_since_reads_ <= (never_came == 0 ? 1 : rt::TickClock::kPatience + 1));
  counters_.frames.bad += bad;
  counters_.frames.lost += never_came;
  if (lost < 0) {
    take_back(static_cast<std::uint64_t>(-lost));
    loop_.came_after_all(-lost);
  }
  if (lost > 0) {
    tell({.what = EventKind::frames_lost, .frames = static_cast<std::uint32_t>(lost)},
         ticks_.ticks());
  }
  // One frame may be damaged in several places, and noise between two frames damages none.
  damaged_ = ticks_.missing() == 0 ? 0 : damaged_ - bad;
  if (reading_is_doubtful()) loop_.doubt_next_reading();
  // What was foreseen and is not lost is here.
  if (!ticks_.in_doubt()) loop_.came_after_all(std::exchange(foreseen_, 0));
}

// Of a window, a frame that is missing when it ends may have taken most with it. One that was
// missing on the way, and came, did not.
bool ControlCycle::reading_is_doubtful() const noexcept CARGOBAY_NONBLOCKING {
  bool reads = false;
  for (const auto& reading : readings_) reads = reads || reading.has_value();
  const bool window = list_ != FrameList::reading || former_list_ != FrameList::reading;
  return reads && (ticks_.in_doubt() || (window && ticks_.missing() > 0));
}

// Frames that were seen to be no good since the last one that was. One whose header is damaged
// shows by its bytes alone, as long as they are no more than those of the frames that are missing:
// a robot says other things too, and if nobody asked it to it may have misheard a command.
std::uint64_t ControlCycle::newly_damaged(rt::TimePoint arrival) noexcept CARGOBAY_NONBLOCKING {
  const oi::StreamDecoder::Counters& now = decoder_.counters();
  const std::uint64_t skipped = now.skipped - std::exchange(skipped_, now.skipped);
  const std::uint64_t corrupt = std::exchange(corrupt_, 0U);
  if (skipped == 0) return corrupt;
  const auto ticks = static_cast<std::uint64_t>((arrival - last_arrival_) / tick_);
  const std::uint64_t frames = skipped / kLeastOfAFrame;
  const bool says_more = skipped > ticks * kMostOfAFrame;
  if (says_more) hearing_in_doubt_ = true;
  return says_more ? corrupt : std::max(corrupt, frames);
}

// Of the frames of so many ticks since the last one, bytes are missing, not only wrong: the line
// was dead for a while, or the robot silent.
bool ControlCycle::bytes_are_missing(std::int64_t ticks) const noexcept CARGOBAY_NONBLOCKING {
  const std::uint64_t bytes = decoder_.counters().bytes - bytes_;
  return bytes < static_cast<std::uint64_t>(ticks) * kFrameBytes;
}

// Frames that were given up are here. Of the bad ones, what looked like their remains was noise.
void ControlCycle::take_back(std::uint64_t frames) noexcept CARGOBAY_NONBLOCKING {
  const std::uint64_t lost = std::min(frames, counters_.frames.lost);
  counters_.frames.lost -= lost;
  counters_.frames.bad -= frames - lost;
}

// Of the robot, that passed since the last frame. For a deadline that is over.
std::int64_t ControlCycle::silent_ticks() const noexcept CARGOBAY_NONBLOCKING {
  return (stream_.now() - ticks_.expected()) / tick_ + 1;
}

// Up to now the last command was obeyed; from now on none is.
void ControlCycle::stop_in_silence() noexcept CARGOBAY_NONBLOCKING {
  stopped_in_silence_ = true;
  stop_owed_ = mode_watch_.state() == ModeWatch::State::driving;
  if (ticks_.started()) {
    foreseen_ = static_cast<int>(silent_ticks());
    loop_.lost(foreseen_, true);
  }
  loop_.stop();
  hearing_in_doubt_ = true;
  tell(EventKind::silence_began);
}

// The link is lost, and with it what was due by now.
void ControlCycle::account_for_silence() noexcept CARGOBAY_NONBLOCKING {
  if (!ticks_.started()) return;
  const auto due = static_cast<std::uint64_t>(ticks_.missing() + silent_ticks());
  const std::uint64_t bad = std::min(damaged_, due);
  counters_.frames.bad += bad;
  counters_.frames.lost += due - bad;
}

}  // namespace cargobay::hal
