// What becomes of the bytes that arrive: frames, what they say, and each tick counted once.
#include <algorithm>

#include "hal/control_cycle.hpp"

namespace cargobay::hal {

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
    const std::optional<rt::WheelEstimator::Reading> reading = take_frame();
    (void)readings.push_back(reading);  // has room: a frame is at least 5 bytes
    // The clock has not counted it yet.
    const auto behind = static_cast<std::int64_t>(readings.size());
    watch(sensors_, ticks_.started() ? ticks_.ticks() + behind : 0);
  }
}

std::optional<rt::WheelEstimator::Reading> ControlCycle::take_frame() noexcept
    CARGOBAY_NONBLOCKING {
  sensors_.clear();
  (void)oi::decode_frame(decoder_.frame(), sensors_);  // whole: the decoder checked its structure
  misheard_ = !as_told();
  if (!sensors_.has(oi::PacketId::distance) || !sensors_.has(oi::PacketId::angle))
    return std::nullopt;
  return rt::WheelEstimator::Reading{.distance_mm = sensors_.raw(oi::PacketId::distance),
                                     .angle_deg = sensors_.raw(oi::PacketId::angle)};
}

// Whether the frame is of one of the lists that the robot may be streaming now. A command has no
// checksum: one damaged on its way may have asked for other packets, or have gone unheard.
bool ControlCycle::as_told() const noexcept CARGOBAY_NONBLOCKING {
  if (decoder_.frame().size() != kFrameBytes || !sensors_.has(oi::PacketId::oi_mode)) return false;
  const auto is_of = [this](FrameList list) {
    switch (list) {
      case FrameList::reading:
        return sensors_.has(oi::PacketId::distance) && sensors_.has(oi::PacketId::charging_sources);
      case FrameList::hazards: return sensors_.has(oi::PacketId::overcurrents);
      case FrameList::battery: return sensors_.has(oi::PacketId::battery_capacity);
    }
    return false;
  };
  return is_of(list_) || is_of(former_list_);
}

// Looks for what is worth telling.
void ControlCycle::watch(const oi::SensorValues& frame,
                         std::int64_t tick) noexcept CARGOBAY_NONBLOCKING {
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

void ControlCycle::tell(Event event, std::int64_t tick) noexcept CARGOBAY_NONBLOCKING {
  event.tick = tick;
  event.time = woken_;
  (void)events_.push(event);  // what is dropped is counted
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
    if (lost > 0) {
      tell({.what = EventKind::frames_lost, .frames = static_cast<std::uint32_t>(lost)},
           ticks_.ticks());
    }
    // One frame may be damaged in several places, and noise between two frames damages none.
    damaged_ = ticks_.missing() == 0 ? 0 : damaged_ - bad;
    // Of a window, a frame that is missing may have taken most with it.
    const bool window = list_ != FrameList::reading || former_list_ != FrameList::reading;
    if (ticks_.in_doubt() || (window && ticks_.missing() > 0)) loop_.doubt_next_reading();
    if (!ticks_.in_doubt()) foreseen_ = 0;
    // Of several together all but the last are a tick late at least.
    const bool late = arrival - ticks_.due_by(arrival) > parameters_.late_margin;
    if (late || readings.size() > 1) ++overruns_.wait;
    period_ns_.record(static_cast<std::uint64_t>((arrival - last_arrival_).count()));
  }
  for (const auto& reading : readings) loop_.frame(reading);
  last_arrival_ = arrival;
  if (stopped_in_silence_) tell(EventKind::silence_ended);
  stopped_in_silence_ = false;
  stop_owed_ = false;
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
  stop_owed_ = mode_watch_.state() == ModeWatch::State::driving;
  if (ticks_.started()) {
    foreseen_ = static_cast<int>(silent_ticks());
    loop_.lost(foreseen_, true);
  }
  loop_.stop();
  tell(EventKind::silence_began);
}

// The link is lost, and with it what was due by now.
void ControlCycle::account_for_silence() noexcept CARGOBAY_NONBLOCKING {
  if (!ticks_.started()) return;
  const auto due = static_cast<std::uint64_t>(ticks_.missing() + silent_ticks());
  const std::uint64_t bad = std::min(damaged_, due);
  frames_.bad += bad;
  frames_.lost += due - bad;
}

}  // namespace cargobay::hal
