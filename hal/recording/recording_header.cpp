#include "hal/recording/recording_header.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "hal/recording/recording_format.hpp"

namespace cargobay::hal {
namespace {

constexpr std::size_t kMostTextBytes = 1000;

// Texts are one line, and contain nothing that controls a terminal.
bool is_control(char character) {
  return static_cast<std::uint8_t>(character) < 0x20 || character == 0x7F;
}

// What is recorded of a cycle's parameters, by an archive of hal/recording/byte_archive.hpp: each
// struct lists its members, each type says how it is recorded and within which bounds. Values that
// no cycle can be set up with are damage, and must not reach its arithmetic. A recording with
// another list of members needs another version.
template <typename Archive>
class HeaderFields {
 public:
  explicit HeaderFields(Archive& io) : io_{io} {}

  void operator()(RecordingHeader& it) {
    all(it, it.baud, it.started_ns, it.software, it.note, it.parameters);
  }
  void operator()(CycleParameters& it) {
    all(it, it.dialect, it.loop, it.drive_mode, it.late_margin, it.stop_after, it.link_timeout,
        it.setpoint_lapse, it.control_budget, it.control_overruns_allowed, it.on_mode_loss,
        it.on_implausible, it.odometry, it.power);
  }
  void operator()(rt::WheelLoop::Parameters& it) {
    all(it, it.estimator, it.controller, it.schedule, it.limits, it.course, it.feedback);
  }
  void operator()(rt::WheelEstimator::Parameters& it) {
    all(it, it.wheel_base_mm, it.tick_s, it.likely_lag_s, it.input_delay_s, it.speed_noise_mm_s,
        it.decision_log_odds, it.remainder, it.told, it.prior);
  }
  void operator()(rt::VelocityController::Parameters& it) {
    all(it, it.max_command_mm_s, it.overshoot_share, it.overshoot_mm_s);
  }
  void operator()(rt::ReadSchedule::Parameters& it) {
    all(it, it.window_ticks, it.least_window_ticks, it.begin_window_ticks, it.probe_window_ticks,
        it.probe_reads, it.probe_steady_ticks, it.probe_moving_ticks, it.probe_most_ticks,
        it.recheck_unsure_ticks, it.recheck_carried_ticks, it.recheck_lost_ticks, it.turn_sd,
        it.idle_turn_sd, it.most_turn_sd, it.least_turn_ticks, it.rest_ticks);
  }
  void operator()(rt::Course::Parameters& it) {
    all(it, it.hold_heading, it.rate_1_s, it.holding_rate_1_s);
  }
  void operator()(bool& value) { io_.up_to(value, true); }
  void operator()(rt::SlewLimiter::Limits& it) { all(it, it.acceleration_mm_s2, it.jerk_mm_s3); }
  void operator()(PowerWatch::Limits& it) {
    all(it, it.low_mv, it.recovered_mv, it.low_part, it.recovered_part);
  }
  void operator()(const oi::Dialect*& /*it*/) {}        // there is one so far
  void operator()(rt::Odometry::Parameters& /*it*/) {}  // nothing that is recorded depends on it

  void operator()(std::uint32_t& value) { io_.raw(value); }
  void operator()(std::int64_t& value) { io_.raw(value); }
  void operator()(double& value) {
    io_.raw(value);
    io_.require(std::abs(value) < 1e9);  // false for NaN
  }
  void operator()(int& value) {
    io_.raw(value);
    io_.require(value >= 0 && value <= 1'000'000);
  }
  void operator()(rt::Duration& value) {
    io_.raw(value);
    io_.require(value >= rt::Duration::zero() && value <= std::chrono::hours{24});
  }
  void operator()(rt::WheelLoop::Feedback& value) {
    io_.up_to(value, rt::WheelLoop::Feedback::open);
  }
  void operator()(OnModeLoss& value) { io_.up_to(value, OnModeLoss::hold); }
  void operator()(OnImplausible& value) { io_.up_to(value, OnImplausible::report); }
  void operator()(oi::Mode& value) { io_.up_to(value, oi::Mode::full); }
  void operator()(std::optional<rt::Remainder>& value) {
    int index = value ? static_cast<int>(*value) + 1 : 0;
    io_.up_to(index, static_cast<int>(rt::Remainder::lost) + 1);
    if (index > 0) value = static_cast<rt::Remainder>(index - 1);
  }
  void operator()(rt::PlantEstimate& it) {
    all(it, it.lag_s, it.dead_time_s, it.ramp_s2_mm, it.gain_left, it.gain_right, it.lag_sd_s,
        it.gain_sd, it.gain_difference_sd, it.gain_left_sd, it.gain_right_sd, it.weakened);
  }
  void operator()(rt::LearntPlant& it) {
    all(it, it.lag_s, it.lag_sd_s, it.dead_time_s, it.dead_time_sd_s, it.ramp_s2_mm,
        it.ramp_sd_s2_mm, it.gain_left, it.gain_left_sd, it.gain_right, it.gain_right_sd,
        it.remainder, it.log_odds_carried, it.moved_s);
  }
  void operator()(rt::RemainderBelief& value) { io_.up_to(value, rt::RemainderBelief::lost); }
  template <typename Plant>
  void operator()(std::optional<Plant>& value) {
    int known = value ? 1 : 0;
    io_.up_to(known, 1);
    if (known == 0) return;
    if (!value) value.emplace();
    (*this)(*value);
  }
  void operator()(std::string& text) {
    auto size = static_cast<std::uint16_t>(std::min(text.size(), kMostTextBytes));
    io_.raw(size);
    io_.require(size <= kMostTextBytes);
    text.resize(std::min<std::size_t>(size, kMostTextBytes));
    for (char& character : text) {
      io_.raw(character);
      io_.require(!is_control(character));
    }
  }

 private:
  template <typename Whole, typename... Members>
  void all(const Whole& /*whole*/, Members&... members) {
    static_assert(
        requires { Whole{members...}; } && !requires { Whole{members..., {}}; },
        "list every member, in the order of the struct");
    ((*this)(members), ...);
  }

  Archive& io_;
};

// What a cycle takes for granted.
bool sensible(const RecordingHeader& header) {
  const rt::WheelLoop::Parameters& loop = header.parameters.loop;
  return header.baud >= 300 && header.baud <= 1'000'000 && loop.estimator.wheel_base_mm > 0.0 &&
         loop.estimator.tick_s > 0.0 && loop.estimator.likely_lag_s > 0.0 &&
         (!loop.estimator.told || loop.estimator.told->lag_s > 0.0) &&
         (!loop.estimator.prior || loop.estimator.prior->lag_s > 0.0) &&
         loop.limits.acceleration_mm_s2 > 0.0 && loop.limits.jerk_mm_s3 >= 0.0 &&
         loop.schedule.least_window_ticks <= loop.schedule.window_ticks;
}

Failure no_recording() {
  return {"is not a recording of a drive; make one with: cargobay drive --record FILE"};
}

Failure cut_off() { return {"is cut off within its header: nothing of the drive is in it"}; }

}  // namespace

std::vector<std::uint8_t> encode(const RecordingHeader& header) {
  RecordingHeader printable = header;
  std::ranges::replace_if(printable.software, is_control, '?');
  std::ranges::replace_if(printable.note, is_control, '?');
  std::vector<std::uint8_t> rest;
  auto fields = writer_to(rest);
  HeaderFields{fields}(printable);
  std::vector<std::uint8_t> bytes{kRecordingMagic.begin(), kRecordingMagic.end()};
  auto out = writer_to(bytes);
  out.raw(kRecordingVersion, static_cast<std::uint32_t>(rest.size()));
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  out.raw(crc32(bytes));
  return bytes;
}

Result<DecodedHeader> decode_header(std::span<const std::uint8_t> file) {
  ByteReader in{file};
  std::uint16_t version = 0;
  std::uint32_t length = 0;
  std::uint32_t checksum = 0;
  const auto magic = in.take(kRecordingMagic.size());
  in.raw(version);
  if (!in.sound() || !std::ranges::equal(magic, kRecordingMagic)) return no_recording();
  if (version != kRecordingVersion) {
    return Failure{"is a recording of version " + std::to_string(version) +
                   ", and this program reads version " + std::to_string(kRecordingVersion) +
                   "; use the version of cargobay that recorded it"};
  }
  in.raw(length);
  in.require(length <= kMostHeaderBytes);
  ByteReader fields{in.take(length)};
  in.raw(checksum);
  if (!in.sound()) return cut_off();
  DecodedHeader decoded{.bytes = file.size() - in.rest().size()};
  HeaderFields{fields}(decoded.header);
  if (crc32(file.first(decoded.bytes - kChecksumBytes)) != checksum || !fields.sound() ||
      !fields.rest().empty() || !sensible(decoded.header)) {
    return Failure{"has a damaged header: nothing after it can be trusted"};
  }
  return decoded;
}

}  // namespace cargobay::hal
