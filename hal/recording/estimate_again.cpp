#include "hal/recording/estimate_again.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/tick_clock.hpp"

namespace cargobay::hal {
namespace {

using Reading = rt::WheelEstimator::Reading;

// One reading per frame, from the bytes as they come.
class Readings {
 public:
  void add(std::span<const std::uint8_t> bytes) {
    decoder_.push(bytes, [this](oi::StreamDecoder::Outcome outcome) {
      if (outcome == oi::StreamDecoder::Outcome::frame) readings_.push_back(reading());
    });
  }
  std::vector<Reading> take() { return std::exchange(readings_, {}); }

 private:
  Reading reading() {
    sensors_.clear();
    (void)oi::decode_frame(decoder_.frame(), sensors_);  // whole: the decoder checked its structure
    Reading reading;
    if (sensors_.has(oi::PacketId::distance))
      reading.distance_mm = sensors_.raw(oi::PacketId::distance);
    if (sensors_.has(oi::PacketId::angle)) reading.angle_deg = sensors_.raw(oi::PacketId::angle);
    return reading;
  }

  oi::StreamDecoder decoder_{};
  oi::SensorValues sensors_{};
  std::vector<Reading> readings_;
};

class Estimation {
 public:
  explicit Estimation(const rt::WheelEstimator::Parameters& parameters) : estimator_{parameters} {}

  void take(const Entry& entry) {
    if (entry.kind == EntryKind::read) readings_.add(entry.bytes);
    if (entry.kind == EntryKind::wrote) written_ = true;
    // A write in a wait without a tick was the stop in a silence.
    if (entry.kind == EntryKind::waited && std::exchange(written_, false)) command_ = {};
    if (entry.kind == EntryKind::state) take(entry.state);
  }
  EstimateDifference difference() const {
    EstimateDifference result = difference_;
    const auto root = [&](double squares) {
      return result.ticks == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(result.ticks));
    };
    result.rms = {root(squares_.left_mm_s), root(squares_.right_mm_s)};
    result.belief = estimator_.belief();
    return result;
  }

 private:
  void take(const CycleState& state) {
    const std::vector<Reading> readings = readings_.take();
    for (const Reading& reading : readings) {
      if (reading.distance_mm) since_distance_ = 0;
      if (reading.angle_deg) since_turn_ = 0;
    }
    const std::int64_t lost = state.tick - tick_ - static_cast<std::int64_t>(readings.size());
    constexpr std::int64_t kMostSteps = 100;  // as rt::WheelLoop; a damaged file may say anything
    for (std::int64_t i = 0; started_ && i < std::min(lost, kMostSteps); ++i)
      estimator_.step_lost(command_, {.distance = since_distance_ <= kMayHaveRead,
                                      .turn = since_turn_ <= kMayHaveRead});
    if (started_ && lost < 0)
      estimator_.came_after_all(static_cast<int>(std::min(-lost, kMostSteps)));
    for (const Reading& reading : readings) estimator_.step(command_, reading);
    started_ = true;
    ++since_distance_;
    ++since_turn_;
    tick_ = state.tick;
    command_ = state.command;
    written_ = false;
    compare(state);
  }
  void compare(const CycleState& state) {
    ++difference_.ticks;
    difference_.recorded_belief = state.remainder;
    const rt::WheelSpeeds now = estimator_.speeds();
    const auto add = [](double difference, double& squares, double& most) {
      squares += difference * difference;
      most = std::max(most, std::abs(difference));
    };
    add(now.left_mm_s - state.estimate.left_mm_s, squares_.left_mm_s, difference_.most.left_mm_s);
    add(now.right_mm_s - state.estimate.right_mm_s, squares_.right_mm_s,
        difference_.most.right_mm_s);
  }

  static constexpr int kMayHaveRead = rt::TickClock::kPatience + 1;

  rt::WheelEstimator estimator_;
  Readings readings_;
  rt::WheelSpeeds command_{};  // the one in effect
  std::int64_t tick_ = 0;
  int since_distance_ = 0;  // ticks since it was read
  int since_turn_ = 0;
  bool started_ = false;
  bool written_ = false;
  rt::WheelSpeeds squares_{};
  EstimateDifference difference_{};
};

}  // namespace

EstimateDifference estimate_again(const Recording& recording,
                                  const rt::WheelEstimator::Parameters& parameters) {
  Estimation estimation{parameters};
  Entry entry;
  for (EntryCursor cursor{std::span{recording.blocks()}.first(recording.unbroken())};
       cursor.next(entry);) {
    estimation.take(entry);
  }
  return estimation.difference();
}

}  // namespace cargobay::hal
