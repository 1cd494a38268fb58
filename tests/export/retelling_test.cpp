// A recording gives back what the loop knew.
#include "hal/export/retelling.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/export/collected.hpp"
#include "tests/hal/command_request.hpp"
#include "tests/hal/recorded_drive.hpp"

namespace cargobay::hal {
namespace {

using test::Collected;
using test::RecordedDrive;
using test::retold;

std::string as_json(const CycleState& state) {
  std::string out;
  append_json(out, state_columns(), StateRecord{.state = state, .wheel_base_mm = 258.0});
  return out;
}

// With a bump, and a song that somebody asked for.
void drive_into_something(RecordedDrive& drive, int frames) {
  drive.on_frame = [&](int frame) {
    if (frame == 100) drive.device.inputs().bump_left = true;
    if (frame == 130) drive.device.inputs().bump_left = false;
    if (frame == 200) {
      EXPECT_TRUE(drive.cycle().request(test::command({139, 8, 10, 20})));
    }
  };
  drive.run(frames);
}

TEST(Retelling, HasTheWholeStateOfEachTick) {
  RecordedDrive drive;
  drive_into_something(drive, 500);
  Collected all;
  const Retelling told = retold(drive.file(), all);
  EXPECT_EQ(told.counts.states, 500U);
  EXPECT_EQ(told.counts.partial_states, 0U);
  EXPECT_FALSE(told.difference);
  ASSERT_EQ(all.states.size(), drive.states.size());
  for (std::size_t i = 0; i < all.states.size(); ++i) {
    EXPECT_EQ(all.states[i].extent, StateRecord::Extent::whole);
    ASSERT_EQ(as_json(all.states[i].state), as_json(drive.states[i])) << i;
  }
  EXPECT_GT(all.states.back().state.pose_covariance.xx, 1.0);
}

TEST(Retelling, HasTheEventsWithWhatTheySay) {
  RecordedDrive drive;
  drive_into_something(drive, 500);
  Collected all;
  (void)retold(drive.file(), all);
  ASSERT_EQ(all.events.size(), drive.events.size());
  ASSERT_FALSE(all.events.empty());
  for (std::size_t i = 0; i < all.events.size(); ++i) {
    EXPECT_EQ(all.events[i].event.what, drive.events[i].what);
    EXPECT_EQ(all.events[i].event.tick, drive.events[i].tick);
    EXPECT_EQ(describe(all.events[i].event), describe(drive.events[i]));
  }
  const auto bump = std::ranges::find(all.events, EventKind::bump_began,
                                      [](const EventRecord& one) { return one.event.what; });
  ASSERT_NE(bump, all.events.end());
  std::string text;
  append_json(text, event_columns(), *bump);
  EXPECT_THAT(text, testing::AllOf(testing::HasSubstr(R"("what":"bump_began")"),
                                   testing::HasSubstr(R"("bumps":["bump_left"])")));
}

TEST(Retelling, HasTheEventThatEndsTheDrive) {
  RecordedDrive drive;
  drive.on_frame = [&](int frame) {
    if (frame == 100) drive.device.inputs().cliff_left.cliff = true;
  };
  drive.run(400);
  ASSERT_EQ(drive.end, CycleEnd::mode_lost);
  ASSERT_EQ(drive.events.size(), 1U);
  Collected all;
  (void)retold(drive.file(), all);
  ASSERT_EQ(all.events.size(), 1U);
  EXPECT_EQ(describe(all.events[0].event), describe(drive.events[0]));
}

TEST(Retelling, HasEachCommandThatWasSent) {
  RecordedDrive drive;
  drive_into_something(drive, 500);
  Collected all;
  (void)retold(drive.file(), all);
  const auto count = [&](std::uint8_t opcode) {
    return std::ranges::count_if(all.commands,
                                 [&](const auto& command) { return command.front() == opcode; });
  };
  EXPECT_EQ(count(145), 501) << "one a frame, and the last stop";
  EXPECT_THAT(all.commands, testing::Contains(std::vector<std::uint8_t>{139, 8, 10, 20}));
  EXPECT_EQ(all.commands.back(), (std::vector<std::uint8_t>{145, 0, 0, 0, 0}));
}

TEST(Retelling, HasTheSensorsOfEachFrameAndTheirSums) {
  RecordedDrive drive;
  drive.run(300);
  Collected all;
  (void)retold(drive.file(), all);
  ASSERT_GE(all.sensors.size(), 300U);
  std::int64_t sum = 0;
  for (const SensorRecord& record : all.sensors) {
    if (record.values.has(oi::PacketId::distance)) sum += record.values.distance().value;
    EXPECT_EQ(record.distance_sum_mm, sum);
  }
  EXPECT_NE(sum, 0);
}

TEST(Retelling, IsInOrderOfTimeWithinEachTopic) {
  RecordedDrive drive;
  drive_into_something(drive, 500);
  drive.header.started_ns = 1'700'000'000'000'000'000;
  Collected all;
  (void)retold(drive.file(), all);
  const auto in_order = [](const auto& records) {
    return std::ranges::is_sorted(records, {}, [](const auto& one) { return one.stamp.unix_ns; });
  };
  EXPECT_TRUE(in_order(all.states));
  EXPECT_TRUE(in_order(all.sensors));
  EXPECT_TRUE(in_order(all.events));
  for (const StateRecord& record : all.states) {
    EXPECT_NEAR(static_cast<double>(record.stamp.unix_ns - drive.header.started_ns) / 1e9,
                record.stamp.time_s, 1e-9);
  }
  EXPECT_GE(all.states.front().stamp.time_s, 0.0);
  EXPECT_NEAR(all.states.back().stamp.time_s - all.states.front().stamp.time_s, 499 * 0.015, 0.01);
}

// From there on it has what the file keeps.
TEST(Retelling, GoesOnAfterAGap) {
  RecordedDrive drive;
  drive.run(400);
  std::vector<std::uint8_t> file = encode(drive.header);
  FlightRecorder::Cursor cursor;
  FlightRecorder::Block block;
  for (int number = 0; drive.recorder.next(cursor, block); ++number) {
    if (number == 200) continue;
    const std::vector<std::uint8_t> more = encode(block);
    file.insert(file.end(), more.begin(), more.end());
  }
  Collected all;
  const Retelling told = retold(file, all);
  EXPECT_FALSE(told.difference);
  EXPECT_GE(told.counts.states, 398U);
  EXPECT_GT(told.counts.partial_states, 150U);
  EXPECT_LT(told.counts.partial_states, 250U);
  const StateRecord& last = all.states.back();
  EXPECT_EQ(last.extent, StateRecord::Extent::recorded);
  EXPECT_EQ(last.state.tick, drive.states.back().tick);
  EXPECT_EQ(last.state.estimate.left_mm_s, drive.states.back().estimate.left_mm_s);
  std::string text;
  append_json(text, state_columns(), last);
  EXPECT_THAT(text, testing::AllOf(testing::HasSubstr("estimate_mm_s"),
                                   testing::Not(testing::HasSubstr("pose")),
                                   testing::Not(testing::HasSubstr("hazards"))));
}

TEST(Retelling, SaysWhereTheLoopWouldHaveDoneSomethingElse) {
  RecordedDrive drive;
  drive.run(300);
  drive.header.parameters.loop.estimator.likely_lag_s = 0.2;
  Collected all;
  const Retelling told = retold(drive.file(), all);
  ASSERT_TRUE(told.difference);
  EXPECT_EQ(told.counts.states, 300U) << "all are told";
  EXPECT_GT(told.counts.partial_states, 0U);
}

TEST(Retelling, ReadsARecordingWithoutItsEnd) {
  RecordedDrive drive;
  drive.run(300);
  std::vector<std::uint8_t> file = drive.file();
  file.resize(file.size() - file.size() / 3);
  Collected all;
  const Retelling told = retold(file, all);
  EXPECT_FALSE(told.difference);
  EXPECT_GT(told.counts.states, 150U);
  EXPECT_EQ(told.counts.partial_states, 0U);
  EXPECT_TRUE(all.events.empty()) << "the end of the file is not an event of the robot";
}

TEST(Retelling, StopsWhenNothingMoreIsWanted) {
  RecordedDrive drive;
  drive.run(300);
  Collected all;
  all.most_states = 10;
  (void)retold(drive.file(), all);
  EXPECT_EQ(all.states.size(), 10U);
}

}  // namespace
}  // namespace cargobay::hal
