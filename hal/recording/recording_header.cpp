#include "hal/recording/recording_header.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>

#include "hal/recording/recording_format.hpp"

namespace cargobay::hal {
namespace {

constexpr std::size_t kMostTextBytes = 1000;

// Texts are one line, and contain nothing that controls a terminal.
bool is_control(std::uint8_t character) { return character < 0x20 || character == 0x7F; }

// Each of these calls `field` for all members in the order of the file. The bindings name every
// member, so that a member that is added but not recorded does not compile; a recording with
// another list of members needs another version.
template <typename Parameters, typename Field>
void each_estimator_field(Parameters& parameters, const Field& field) {
  auto& [wheel_base_mm, tick_s, lag_s, input_delay_s, speed_noise_mm_s, droop_sd, decision_log_odds,
         remainder] = parameters;
  field(wheel_base_mm);
  field(tick_s);
  field(lag_s);
  field(input_delay_s);
  field(speed_noise_mm_s);
  field(droop_sd);
  field(decision_log_odds);
  field(remainder);
}

template <typename Parameters, typename Field>
void each_controller_field(Parameters& parameters, const Field& field) {
  auto& [lag_s, proportional, integral_per_s, max_command_mm_s, tick_s] = parameters;
  field(lag_s);
  field(proportional);
  field(integral_per_s);
  field(max_command_mm_s);
  field(tick_s);
}

template <typename Parameters, typename Field>
void each_schedule_field(Parameters& parameters, const Field& field) {
  auto& [window_ticks, least_window_ticks, probe_window_ticks, probe_reads, recheck_carried_ticks,
         recheck_lost_ticks] = parameters;
  field(window_ticks);
  field(least_window_ticks);
  field(probe_window_ticks);
  field(probe_reads);
  field(recheck_carried_ticks);
  field(recheck_lost_ticks);
}

template <typename Parameters, typename Field>
void each_loop_field(Parameters& parameters, const Field& field) {
  auto& [estimator, controller, schedule, limits, feedback] = parameters;
  auto& [acceleration_mm_s2, jerk_mm_s3] = limits;
  each_estimator_field(estimator, field);
  each_controller_field(controller, field);
  each_schedule_field(schedule, field);
  field(acceleration_mm_s2);
  field(jerk_mm_s3);
  field(feedback);
}

template <typename Parameters, typename Field>
void each_field(Parameters& parameters, const Field& field) {
  auto& [dialect, loop, drive_mode, late_margin, stop_after, link_timeout, setpoint_lapse,
         control_budget, control_overruns_allowed, on_mode_loss, odometry, power] = parameters;
  (void)dialect;   // the only one
  (void)odometry;  // nothing that is recorded depends on it
  auto& [low_mv, recovered_mv, low_part, recovered_part] = power;
  each_loop_field(loop, field);
  field(drive_mode);
  field(late_margin);
  field(stop_after);
  field(link_timeout);
  field(setpoint_lapse);
  field(control_budget);
  field(control_overruns_allowed);
  field(on_mode_loss);
  field(low_mv);
  field(recovered_mv);
  field(low_part);
  field(recovered_part);
}

class Writer {
 public:
  explicit Writer(std::vector<std::uint8_t>& out) : out_{&out} {}

  template <std::unsigned_integral T>
  void operator()(T value) const {
    const auto bytes = little_endian(value);
    out_->insert(out_->end(), bytes.begin(), bytes.end());
  }
  void operator()(std::int64_t value) const { (*this)(static_cast<std::uint64_t>(value)); }
  void operator()(double value) const { (*this)(std::bit_cast<std::uint64_t>(value)); }
  void operator()(int value) const { (*this)(static_cast<std::uint32_t>(value)); }
  void operator()(rt::Duration value) const { (*this)(static_cast<std::uint64_t>(value.count())); }
  void operator()(rt::WheelLoop::Feedback value) const {
    (*this)(static_cast<std::uint8_t>(value));
  }
  void operator()(OnModeLoss value) const { (*this)(static_cast<std::uint8_t>(value)); }
  void operator()(oi::Mode value) const { (*this)(static_cast<std::uint8_t>(value)); }
  void operator()(const std::optional<rt::Remainder>& value) const {
    (*this)(static_cast<std::uint8_t>(value ? static_cast<int>(*value) + 1 : 0));
  }
  void operator()(const std::string& text) const {
    const std::string_view kept = std::string_view{text}.substr(0, kMostTextBytes);
    (*this)(static_cast<std::uint16_t>(kept.size()));
    std::ranges::replace_copy_if(kept, std::back_inserter(*out_), is_control, '?');
  }

 private:
  std::vector<std::uint8_t>* out_;
};

class Reader {
 public:
  explicit Reader(ByteReader& in) : in_{&in} {}

  bool sound() const { return sound_; }

  template <typename T>
  void operator()(T& value) const {
    sound_ = in_->take(value) && sound_;
  }
  // Values that no cycle can be set up with are damage, and must not reach its arithmetic.
  void operator()(double& value) const {
    sound_ = in_->take(value) && std::abs(value) < 1e9 && sound_;  // false for NaN
  }
  void operator()(int& value) const {
    sound_ = in_->take(value) && value >= 0 && value <= 1'000'000 && sound_;
  }
  void operator()(rt::Duration& value) const {
    std::int64_t ns = 0;
    (*this)(ns);
    value = rt::Duration{ns};
    sound_ = sound_ && value >= rt::Duration::zero() && value <= std::chrono::hours{24};
  }
  void operator()(rt::WheelLoop::Feedback& value) const {
    sound_ = in_->take(value, rt::WheelLoop::Feedback::open) && sound_;
  }
  void operator()(OnModeLoss& value) const {
    sound_ = in_->take(value, OnModeLoss::hold) && sound_;
  }
  void operator()(oi::Mode& value) const { sound_ = in_->take(value, oi::Mode::full) && sound_; }
  void operator()(std::optional<rt::Remainder>& value) const {
    std::uint8_t byte = 0;
    (*this)(byte);
    sound_ = sound_ && byte <= static_cast<int>(rt::Remainder::lost) + 1;
    if (sound_ && byte > 0) value = static_cast<rt::Remainder>(byte - 1);
  }
  void operator()(std::string& text) const {
    std::uint16_t size = 0;
    (*this)(size);
    std::span<const std::uint8_t> bytes;
    sound_ = sound_ && size <= kMostTextBytes && in_->take(size, bytes) &&
             std::ranges::none_of(bytes, is_control);
    if (sound_) text.assign(bytes.begin(), bytes.end());
  }

 private:
  ByteReader* in_;
  mutable bool sound_ = true;
};

template <typename Header, typename Field>
void each_header_field(Header& header, const Field& field) {
  auto& [baud, started_ns, software, note, parameters] = header;
  field(baud);
  field(started_ns);
  field(software);
  field(note);
  each_field(parameters, field);
}

// What a cycle takes for granted.
bool sensible(const RecordingHeader& header) {
  const rt::WheelLoop::Parameters& loop = header.parameters.loop;
  return header.baud >= 300 && header.baud <= 1'000'000 && loop.estimator.wheel_base_mm > 0.0 &&
         loop.estimator.tick_s > 0.0 && loop.estimator.lag_s > 0.0 &&
         loop.controller.tick_s > 0.0 && loop.limits.acceleration_mm_s2 > 0.0 &&
         loop.limits.jerk_mm_s3 >= 0.0 &&
         loop.schedule.least_window_ticks <= loop.schedule.window_ticks;
}

Failure no_recording() {
  return {"is not a recording of a drive; make one with: cargobay drive --record FILE"};
}

Failure cut_off() { return {"is cut off within its header: nothing of the drive is in it"}; }

}  // namespace

std::vector<std::uint8_t> encode(const RecordingHeader& header) {
  std::vector<std::uint8_t> rest;
  each_header_field(header, Writer{rest});
  std::vector<std::uint8_t> bytes{kRecordingMagic.begin(), kRecordingMagic.end()};
  const Writer writer{bytes};
  writer(kRecordingVersion);
  writer(static_cast<std::uint32_t>(rest.size()));
  bytes.insert(bytes.end(), rest.begin(), rest.end());
  writer(crc32(bytes));
  return bytes;
}

Result<DecodedHeader> decode_header(std::span<const std::uint8_t> file) {
  ByteReader in{file};
  std::span<const std::uint8_t> magic;
  std::span<const std::uint8_t> rest;
  std::uint16_t version = 0;
  std::uint32_t length = 0;
  std::uint32_t checksum = 0;
  if (!in.take(kRecordingMagic.size(), magic) || !std::ranges::equal(magic, kRecordingMagic) ||
      !in.take(version)) {
    return no_recording();
  }
  if (version != kRecordingVersion) {
    return Failure{"is a recording of version " + std::to_string(version) +
                   ", and this program reads version " + std::to_string(kRecordingVersion) +
                   "; use the version of cargobay that recorded it"};
  }
  if (!in.take(length) || length > kMostHeaderBytes || !in.take(length, rest)) return cut_off();
  const std::size_t bytes = file.size() - in.rest().size();
  if (!in.take(checksum)) return cut_off();
  DecodedHeader decoded{.bytes = bytes + kChecksumBytes};
  ByteReader fields{rest};
  const Reader reader{fields};
  each_header_field(decoded.header, reader);
  if (crc32(file.first(bytes)) != checksum || !reader.sound() || !fields.rest().empty() ||
      !sensible(decoded.header)) {
    return Failure{"has a damaged header: nothing after it can be trusted"};
  }
  return decoded;
}

}  // namespace cargobay::hal
