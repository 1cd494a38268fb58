// Every field of a recording is written, read, and where it has always been.
#include "hal/recording/recording_format.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording.hpp"

namespace cargobay::hal {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

// Every field with a value of its own.
RecordingHeader every_parameter() {
  return {.baud = 19200,
          .started_ns = 1'800'000'000'000'000'001,
          .software = "cargobay 1.2.3",
          .note = "to and fro",
          .parameters = {
              .loop = {.estimator = {.wheel_base_mm = 257.5,
                                     .tick_s = 0.0151,
                                     .likely_lag_s = 0.101,
                                     .input_delay_s = 0.0026,
                                     .speed_noise_mm_s = 2.1,
                                     .decision_log_odds = 7.1,
                                     .remainder = rt::Remainder::lost,
                                     .told = rt::PlantEstimate{.lag_s = 0.102,
                                                               .dead_time_s = 0.03,
                                                               .ramp_s2_mm = 0.004,
                                                               .gain_left = 0.91,
                                                               .gain_right = 0.93,
                                                               .lag_sd_s = 0.011,
                                                               .gain_sd = 0.012,
                                                               .gain_difference_sd = 0.013,
                                                               .gain_left_sd = 0.018,
                                                               .gain_right_sd = 0.019,
                                                               .weakened = true},
                                     .prior = rt::LearntPlant{.lag_s = 0.103,
                                                              .lag_sd_s = 0.013,
                                                              .dead_time_s = 0.031,
                                                              .dead_time_sd_s = 0.014,
                                                              .ramp_s2_mm = 0.0041,
                                                              .ramp_sd_s2_mm = 0.0015,
                                                              .gain_left = 0.94,
                                                              .gain_left_sd = 0.016,
                                                              .gain_right = 0.95,
                                                              .gain_right_sd = 0.017,
                                                              .remainder =
                                                                  rt::RemainderBelief::lost,
                                                              .log_odds_carried = -12.5,
                                                              .moved_s = 18.25}},
                       .controller = {.max_command_mm_s = 499.0,
                                      .overshoot_share = 0.061,
                                      .overshoot_mm_s = 10.1},
                       .schedule = {.window_ticks = 41,
                                    .least_window_ticks = 11,
                                    .begin_window_ticks = 7,
                                    .probe_window_ticks = 12,
                                    .probe_reads = 13,
                                    .probe_steady_ticks = 5,
                                    .probe_moving_ticks = 21,
                                    .probe_most_ticks = 121,
                                    .recheck_unsure_ticks = 61,
                                    .recheck_carried_ticks = 201,
                                    .recheck_lost_ticks = 1001,
                                    .turn_sd = 0.71,
                                    .idle_turn_sd = 1.01,
                                    .most_turn_sd = 4.1,
                                    .least_turn_ticks = 14,
                                    .rest_ticks = 134},
                       .limits = {.acceleration_mm_s2 = 999.0, .jerk_mm_s3 = 5000.0},
                       .course = {.hold_heading = true, .rate_1_s = 0.31, .holding_rate_1_s = 1.1},
                       .feedback = rt::WheelLoop::Feedback::open},
              .drive_mode = oi::Mode::full,
              .late_margin = 5001us,
              .stop_after = 151ms,
              .link_timeout = 1001ms,
              .setpoint_lapse = 501ms,
              .control_budget = 2001us,
              .control_overruns_allowed = 9,
              .on_mode_loss = OnModeLoss::hold,
              .on_implausible = OnImplausible::report,
              .power = {.low_mv = 13'201,
                        .recovered_mv = 13'801,
                        .low_part = 0.11,
                        .recovered_part = 0.16}}};
}

CycleState every_state() {
  return {.tick = -3,
          .arrival = rt::TimePoint{4'999'999'700ns},
          .target = {-0.0, 1e-300},
          .set = {1.5, -2.5},
          .estimate = {std::numeric_limits<double>::infinity(), 0.1},
          .command = {100.0, 200.0},
          .remainder = rt::RemainderBelief::lost,
          .mode = oi::Mode{9},  // as sent, known or not
          .setpoint_lapsed = true,
          .battery_mv = -7};
}

Request every_request() {
  return {.kind = Request::Kind::pose,
          .when_long = Request::WhenLong::pause,
          .extras = ExtraLists{5},
          .size = 3,
          .bytes = {141, 4, 2},
          .pose = {.x_mm = 1.25, .y_mm = -2.75, .heading_rad = 3.5}};
}

constexpr std::array<std::uint8_t, 3> kFrame{19, 0, 237};
constexpr std::array<std::uint8_t, 5> kCommand{145, 0, 100, 0, 200};

Bytes every_kind() {
  FlightRecorder recorder;
  recorder.clock(rt::TimePoint{4'000'000'000ns});
  recorder.waited(ByteStream::Wait::timed_out);
  recorder.clock(rt::TimePoint{5'000'000'000ns});
  recorder.read(kFrame, 11);
  recorder.asked(every_request());
  recorder.wrote(kCommand, {.count = 4, .error = 300});
  recorder.state(every_state());
  recorder.ended(CycleEnd::guard_lost);
  Bytes file = encode(every_parameter());
  FlightRecorder::Cursor cursor;
  for (FlightRecorder::Block block; recorder.next(cursor, block);)
    std::ranges::copy(encode(block), std::back_inserter(file));
  return file;
}

// What version 3 has for these, since its first writer.
constexpr std::string_view kEveryKind =
    "434252450d0a1a0a0300da010000004b00000100b49376e2fa180e00636172676f62617920312e322e330a00"
    "746f20616e642066726f00000000001870403f575bb1bfec8e3f4260e5d022dbb93f94f6065f984c653fcdcc"
    "cccccccc00406666666666661c400201e9263108ac1cba3fb81e85eb51b89e3ffca9f1d24d62703f1f85eb51"
    "b81eed3fc3f5285c8fc2ed3fba490c022b87863ffa7e6abc7493883f39b4c876be9f8a3f3bdf4f8d976e923f"
    "dbf97e6abc74933f010191ed7c3f355eba3f39b4c876be9f8a3f5839b4c876be9f3f79e9263108ac8c3f091b"
    "9e5e29cb703ffa7e6abc7493583f14ae47e17a14ee3ffca9f1d24d62903f666666666666ee3f9cc420b07268"
    "913f0200000000000029c000000000004032400000000000307f4008ac1c5a643baf3f333333333333244029"
    "0000000b000000070000000c0000000d0000000500000015000000790000003d000000c9000000e9030000b8"
    "1e85eb51b8e63f295c8fc2f528f03f66666666666610400e000000860000000000000000388f400000000000"
    "88b34001d7a3703d0ad7d33f9a9999999999f13f0103284f4c0000000000c013000900000000400caa3b0000"
    "000040a7dc1d0000000068881e000000000009000000010191330000e9350000295c8fc2f528bc3f7b14ae47"
    "e17ac43f769039ad060000000000000000000000000000000280d0acf30e1d78e9088a000000010000000028"
    "6bee000000000101028094ebdc03030b031300ed07030501038d0402000000000000f43f00000000000006c0"
    "0000000000000c4004ac02040591006400c805ac02fdffffffffffffff090201f9ffffff0000000000000080"
    "59f3f8c21f6ea501000000000000f83f00000000000004c0000000000000f07f9a9999999999b93f00000000"
    "0000594000000000000069408b3162a6020000000200000000f2052a010000000606df32e96c";

Bytes bytes_of(std::string_view hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    std::uint8_t byte = 0;
    (void)std::from_chars(hex.data() + i, hex.data() + i + 2, byte, 16);  // only digits
    bytes.push_back(byte);
  }
  return bytes;
}

void expect_same_plant(const CycleParameters& a, const CycleParameters& b) {
  EXPECT_EQ(a.drive_mode, b.drive_mode);
  EXPECT_EQ(a.late_margin, b.late_margin);
  EXPECT_EQ(a.stop_after, b.stop_after);
  EXPECT_EQ(a.link_timeout, b.link_timeout);
  EXPECT_EQ(a.setpoint_lapse, b.setpoint_lapse);
  EXPECT_EQ(a.control_budget, b.control_budget);
  EXPECT_EQ(a.control_overruns_allowed, b.control_overruns_allowed);
  EXPECT_EQ(a.on_mode_loss, b.on_mode_loss);
  EXPECT_EQ(a.on_implausible, b.on_implausible);
  EXPECT_EQ(a.power.low_mv, b.power.low_mv);
  EXPECT_EQ(a.power.recovered_mv, b.power.recovered_mv);
  EXPECT_EQ(a.power.low_part, b.power.low_part);
  EXPECT_EQ(a.power.recovered_part, b.power.recovered_part);
}

void expect_same_plant(const rt::PlantEstimate& a, const rt::PlantEstimate& b) {
  EXPECT_EQ(a.lag_s, b.lag_s);
  EXPECT_EQ(a.dead_time_s, b.dead_time_s);
  EXPECT_EQ(a.ramp_s2_mm, b.ramp_s2_mm);
  EXPECT_EQ(a.gain_left, b.gain_left);
  EXPECT_EQ(a.gain_right, b.gain_right);
  EXPECT_EQ(a.lag_sd_s, b.lag_sd_s);
  EXPECT_EQ(a.gain_sd, b.gain_sd);
  EXPECT_EQ(a.gain_difference_sd, b.gain_difference_sd);
  EXPECT_EQ(a.gain_left_sd, b.gain_left_sd);
  EXPECT_EQ(a.gain_right_sd, b.gain_right_sd);
  EXPECT_EQ(a.weakened, b.weakened);
}

void expect_same_plant(const rt::LearntPlant& a, const rt::LearntPlant& b) {
  EXPECT_EQ(a.lag_s, b.lag_s);
  EXPECT_EQ(a.lag_sd_s, b.lag_sd_s);
  EXPECT_EQ(a.dead_time_s, b.dead_time_s);
  EXPECT_EQ(a.dead_time_sd_s, b.dead_time_sd_s);
  EXPECT_EQ(a.ramp_s2_mm, b.ramp_s2_mm);
  EXPECT_EQ(a.ramp_sd_s2_mm, b.ramp_sd_s2_mm);
  EXPECT_EQ(a.gain_left, b.gain_left);
  EXPECT_EQ(a.gain_left_sd, b.gain_left_sd);
  EXPECT_EQ(a.gain_right, b.gain_right);
  EXPECT_EQ(a.gain_right_sd, b.gain_right_sd);
  EXPECT_EQ(a.remainder, b.remainder);
  EXPECT_EQ(a.log_odds_carried, b.log_odds_carried);
  EXPECT_EQ(a.moved_s, b.moved_s);
}

void expect_same_plant(const rt::WheelLoop::Parameters& a, const rt::WheelLoop::Parameters& b) {
  EXPECT_EQ(a.estimator.wheel_base_mm, b.estimator.wheel_base_mm);
  EXPECT_EQ(a.estimator.tick_s, b.estimator.tick_s);
  EXPECT_EQ(a.estimator.likely_lag_s, b.estimator.likely_lag_s);
  EXPECT_EQ(a.estimator.input_delay_s, b.estimator.input_delay_s);
  EXPECT_EQ(a.estimator.speed_noise_mm_s, b.estimator.speed_noise_mm_s);
  EXPECT_EQ(a.estimator.decision_log_odds, b.estimator.decision_log_odds);
  EXPECT_EQ(a.estimator.remainder, b.estimator.remainder);
  ASSERT_EQ(a.estimator.told.has_value(), b.estimator.told.has_value());
  if (a.estimator.told) expect_same_plant(*a.estimator.told, *b.estimator.told);
  ASSERT_EQ(a.estimator.prior.has_value(), b.estimator.prior.has_value());
  if (a.estimator.prior) expect_same_plant(*a.estimator.prior, *b.estimator.prior);
  EXPECT_EQ(a.controller.max_command_mm_s, b.controller.max_command_mm_s);
  EXPECT_EQ(a.controller.overshoot_share, b.controller.overshoot_share);
  EXPECT_EQ(a.controller.overshoot_mm_s, b.controller.overshoot_mm_s);
  EXPECT_EQ(a.schedule.window_ticks, b.schedule.window_ticks);
  EXPECT_EQ(a.schedule.least_window_ticks, b.schedule.least_window_ticks);
  EXPECT_EQ(a.schedule.begin_window_ticks, b.schedule.begin_window_ticks);
  EXPECT_EQ(a.schedule.probe_window_ticks, b.schedule.probe_window_ticks);
  EXPECT_EQ(a.schedule.probe_reads, b.schedule.probe_reads);
  EXPECT_EQ(a.schedule.probe_steady_ticks, b.schedule.probe_steady_ticks);
  EXPECT_EQ(a.schedule.probe_moving_ticks, b.schedule.probe_moving_ticks);
  EXPECT_EQ(a.schedule.probe_most_ticks, b.schedule.probe_most_ticks);
  EXPECT_EQ(a.schedule.recheck_unsure_ticks, b.schedule.recheck_unsure_ticks);
  EXPECT_EQ(a.schedule.recheck_carried_ticks, b.schedule.recheck_carried_ticks);
  EXPECT_EQ(a.schedule.recheck_lost_ticks, b.schedule.recheck_lost_ticks);
  EXPECT_EQ(a.schedule.turn_sd, b.schedule.turn_sd);
  EXPECT_EQ(a.schedule.idle_turn_sd, b.schedule.idle_turn_sd);
  EXPECT_EQ(a.schedule.most_turn_sd, b.schedule.most_turn_sd);
  EXPECT_EQ(a.schedule.least_turn_ticks, b.schedule.least_turn_ticks);
  EXPECT_EQ(a.schedule.rest_ticks, b.schedule.rest_ticks);
  EXPECT_EQ(a.course.hold_heading, b.course.hold_heading);
  EXPECT_EQ(a.course.rate_1_s, b.course.rate_1_s);
  EXPECT_EQ(a.course.holding_rate_1_s, b.course.holding_rate_1_s);
  EXPECT_EQ(a.limits.acceleration_mm_s2, b.limits.acceleration_mm_s2);
  EXPECT_EQ(a.limits.jerk_mm_s3, b.limits.jerk_mm_s3);
  EXPECT_EQ(a.feedback, b.feedback);
}

void expect_same_plant(const CycleState& a, const CycleState& b) {
  EXPECT_EQ(a.tick, b.tick);
  EXPECT_EQ(a.arrival, b.arrival);
  EXPECT_EQ(a.mode, b.mode);
  EXPECT_EQ(a.remainder, b.remainder);
  EXPECT_EQ(a.setpoint_lapsed, b.setpoint_lapsed);
  EXPECT_EQ(a.battery_mv, b.battery_mv);
  EXPECT_EQ(a.target, b.target);
  EXPECT_TRUE(std::signbit(a.target.left_mm_s)) << "-0 is not 0";
  EXPECT_EQ(a.set, b.set);
  EXPECT_EQ(a.estimate, b.estimate);
  EXPECT_EQ(a.command, b.command);
}

void expect_same_plant(const Request& a, const Request& b) {
  EXPECT_EQ(a.kind, b.kind);
  EXPECT_EQ(a.extras, b.extras);
  EXPECT_EQ(a.when_long, b.when_long);
  EXPECT_TRUE(std::ranges::equal(a.command(), b.command()));
  EXPECT_EQ(a.pose.x_mm, b.pose.x_mm);
  EXPECT_EQ(a.pose.y_mm, b.pose.y_mm);
  EXPECT_EQ(a.pose.heading_rad, b.pose.heading_rad);
}

TEST(RecordingFormat, HasNotChangedByABit) { EXPECT_EQ(every_kind(), bytes_of(kEveryKind)); }

TEST(RecordingFormat, GivesBackEveryParameter) {
  const Bytes file = bytes_of(kEveryKind);
  const auto decoded = decode_header(file);
  ASSERT_TRUE(decoded);
  const RecordingHeader& header = decoded->header;
  const RecordingHeader expected = every_parameter();
  EXPECT_EQ(header.baud, expected.baud);
  EXPECT_EQ(header.started_ns, expected.started_ns);
  EXPECT_EQ(header.software, expected.software);
  EXPECT_EQ(header.note, expected.note);
  expect_same_plant(header.parameters, expected.parameters);
  expect_same_plant(header.parameters.loop, expected.parameters.loop);
}

TEST(RecordingFormat, GivesBackEveryEntry) {
  const Bytes file = bytes_of(kEveryKind);
  const auto recording = Recording::read(file);
  ASSERT_TRUE(recording) << recording.failure().message;
  std::vector<Entry> entries;
  Entry entry;
  for (EntryCursor cursor{recording->blocks()}; cursor.next(entry);) entries.push_back(entry);
  ASSERT_EQ(entries.size(), 8U);
  EXPECT_EQ(entries[0].time, rt::TimePoint{4s});
  EXPECT_EQ(entries[1].wait, ByteStream::Wait::timed_out);
  EXPECT_EQ(entries[2].time, rt::TimePoint{5s});
  EXPECT_TRUE(std::ranges::equal(entries[3].bytes, kFrame));
  EXPECT_EQ(entries[3].transfer.count, 3U);
  EXPECT_EQ(entries[3].transfer.error, 11);
  expect_same_plant(entries[4].request, every_request());
  EXPECT_TRUE(std::ranges::equal(entries[5].bytes, kCommand));
  EXPECT_EQ(entries[5].transfer.count, 4U);
  EXPECT_EQ(entries[5].transfer.error, 300);
  expect_same_plant(entries[6].state, every_state());
  EXPECT_EQ(entries[7].end, CycleEnd::guard_lost);
}

// Just beyond each bound.
TEST(RecordingFormat, RefusesWhatIsOutOfRange) {
  const auto refused = [](const Bytes& entry) {
    EntryReader reader{entry, rt::TimePoint{1s}};
    Entry read;
    return reader.next(read) == EntryReader::Outcome::malformed;
  };
  EXPECT_FALSE(refused({1, 2}));
  EXPECT_TRUE(refused({0, 0})) << "a kind";
  EXPECT_TRUE(refused({8, 0})) << "a kind";
  EXPECT_TRUE(refused({1, 3})) << "an outcome";
  EXPECT_FALSE(refused({6, 8}));
  EXPECT_TRUE(refused({6, 9})) << "an end";
  EXPECT_FALSE(refused({3, 0xFF, 0x1F, 0})) << "the last errno";
  EXPECT_TRUE(refused({3, 0x80, 0x20, 0})) << "an errno";
  EXPECT_FALSE(refused({4, 0, 1, 1, 9}));
  EXPECT_TRUE(refused({4, 0, 2, 1, 9})) << "more taken than offered";
  EXPECT_TRUE(refused({4, 0, 1, 2, 9})) << "more offered than there is";
  Bytes transfer{3, 0, 0x81, 0x08};  // 1025 bytes
  transfer.resize(2000);
  EXPECT_TRUE(refused(transfer));
  transfer[2] = 0x80;
  EXPECT_FALSE(refused(transfer));
  EXPECT_TRUE(refused({2, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x10})) << "a time";
}

TEST(RecordingFormat, RefusesARequestOutOfRange) {
  const auto refused = [](Bytes start) {
    start.resize(start.size() + 24 + start.back());  // a command and a pose
    EntryReader reader{start, rt::TimePoint{1s}};
    Entry read;
    return reader.next(read) == EntryReader::Outcome::malformed;
  };
  EXPECT_FALSE(refused({7, 3, 7, 1, Request::kMostBytes}));
  EXPECT_TRUE(refused({7, 4, 7, 1, 0})) << "a kind";
  EXPECT_TRUE(refused({7, 3, 8, 1, 0})) << "a list";
  EXPECT_TRUE(refused({7, 3, 7, 2, 0})) << "what to do if it is long";
  EXPECT_TRUE(refused({7, 3, 7, 1, Request::kMostBytes + 1})) << "a length";
}

// A block ends before an entry that may not fit, not only before one that does not.
TEST(RecordingFormat, LeavesRoomForTheLongestOfItsKind) {
  const auto blocks_of = [](std::size_t filled, auto&& note) {
    FlightRecorder recorder;
    const Bytes bytes(filled / 2 - 4);  // each entry: its kind, errno, a length of two bytes
    recorder.read(bytes, 0);
    recorder.read(bytes, 0);
    note(recorder);
    recorder.ended(CycleEnd::asked);
    FlightRecorder::Cursor cursor;
    FlightRecorder::Block block;
    EXPECT_TRUE(recorder.next(cursor, block));
    return block.entries.size() > filled ? 1 : 2;
  };
  const auto state = [](FlightRecorder& recorder) { recorder.state({}); };
  const auto asked = [](FlightRecorder& recorder) { recorder.asked({}); };
  EXPECT_EQ(blocks_of(kMostBlockBytes - 90, state), 1);
  EXPECT_EQ(blocks_of(kMostBlockBytes - 88, state), 2);
  EXPECT_EQ(blocks_of(kMostBlockBytes - 140, asked), 1);
  EXPECT_EQ(blocks_of(kMostBlockBytes - 138, asked), 2);
}

}  // namespace
}  // namespace cargobay::hal
