// The bytes that a pass reads from the line, and the frames in them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include "hal/sensing/frame_lists.hpp"
#include "oi/fixed_list.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_estimator.hpp"

namespace cargobay::hal {

// One thread; no allocation.
class FrameReceiver {
 public:
  static constexpr std::size_t kBytes = 1024;
  using Reading = rt::WheelEstimator::Reading;
  // One entry per frame, of at least 5 bytes: what it says about the counters.
  using Readings = oi::FixedList<Reading, kBytes / 4>;

  // The dialect must outlive it.
  FrameReceiver(const oi::Dialect& dialect, rt::Duration tick)
      : dialect_{dialect}, quiet_{kQuietTicks * tick} {}

  // Starts waiting.
  void begin(rt::TimePoint now) CARGOBAY_NONBLOCKING { last_bytes_ = now; }
  // Where to put the next read.
  std::span<std::uint8_t> room() CARGOBAY_NONBLOCKING { return bytes_; }

  // The first `count` bytes of room() have arrived. Calls `see(values)` for each good frame. Once
  // the line has been quiet, what looked like the beginning of a frame will not be completed, and
  // may have hidden a whole one.
  template <typename See>
  void decode(std::size_t count, rt::TimePoint now, const See& see) CARGOBAY_NONBLOCKING {
    readings_.clear();
    if (count > 0) last_bytes_ = now;
    decoder_.push(std::span<const std::uint8_t>{bytes_}.first(count),
                  [this, &see](oi::StreamDecoder::Outcome outcome)
                      CARGOBAY_NONBLOCKING { take(outcome, see); });
    if (readings_.empty() && now - last_bytes_ >= quiet_) give_up_open_frame(see);
  }

  // Of the frames of this pass.
  const Readings& readings() const CARGOBAY_NONBLOCKING { return readings_; }
  bool empty() const CARGOBAY_NONBLOCKING { return readings_.empty(); }
  // Which counters they read.
  rt::Axes reads() const CARGOBAY_NONBLOCKING {
    rt::Axes all;
    for (const Reading& reading : readings_) {
      all.distance = all.distance || reading.distance_mm.has_value();
      all.turn = all.turn || reading.angle_deg.has_value();
    }
    return all;
  }
  // What the last frame says.
  const oi::SensorValues& values() const CARGOBAY_NONBLOCKING { return values_; }
  // The list of that frame; nothing for a frame that was not requested: a command has no checksum,
  // and one damaged on its way may have asked for any packets.
  std::optional<FrameList> list() const CARGOBAY_NONBLOCKING {
    if (decoder_.frame().size() != dialect_.frame_bytes) return std::nullopt;
    return list_of(values_, dialect_);
  }

  // Candidates that were not frames, since the last call.
  std::uint64_t take_corrupt() CARGOBAY_NONBLOCKING {
    return std::exchange(corrupt_, std::uint64_t{0});
  }
  const oi::StreamDecoder::Counters& bytes() const CARGOBAY_NONBLOCKING {
    return decoder_.counters();
  }
  // No frame is open: all bytes so far are in frames, or in none.
  bool whole() const CARGOBAY_NONBLOCKING {
    return bytes().framed + bytes().skipped == bytes().bytes;
  }

 private:
  // A frame's bytes may come in two pieces, from a USB adapter 16 ms apart. After this many ticks
  // nothing more comes.
  static constexpr int kQuietTicks = 2;

  template <typename See>
  void give_up_open_frame(const See& see) CARGOBAY_NONBLOCKING {
    using Outcome = oi::StreamDecoder::Outcome;
    for (Outcome outcome = decoder_.abandon(); outcome != Outcome::nothing;
         outcome = decoder_.abandon()) {
      take(outcome, see);
    }
  }
  template <typename See>
  void take(oi::StreamDecoder::Outcome outcome, const See& see) CARGOBAY_NONBLOCKING {
    if (outcome == oi::StreamDecoder::Outcome::corrupt) {
      ++corrupt_;
      return;
    }
    values_.clear();
    (void)oi::decode_frame(decoder_.frame(), values_, dialect_);  // whole: the decoder checked it
    (void)readings_.push_back(reading());                         // has room
    see(values_);
  }
  Reading reading() const CARGOBAY_NONBLOCKING {
    Reading reading;
    if (values_.has(dialect_.distance)) reading.distance_mm = values_.raw(dialect_.distance);
    if (values_.has(dialect_.angle)) reading.angle_deg = values_.raw(dialect_.angle);
    return reading;
  }

  const oi::Dialect& dialect_;
  oi::StreamDecoder decoder_{oi::Checksum::automatic, dialect_};
  oi::SensorValues values_{};
  std::uint64_t corrupt_ = 0;
  rt::Duration quiet_;
  rt::TimePoint last_bytes_{};
  // The large ones last, after everything that each pass looks at.
  std::array<std::uint8_t, kBytes> bytes_{};
  Readings readings_{};
};

}  // namespace cargobay::hal
