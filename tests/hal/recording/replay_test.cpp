// What was recorded is replayed bit for bit, and any difference is found.
#include "hal/recording/replay.hpp"

#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "tests/hal/command_request.hpp"
#include "tests/hal/recorded_drive.hpp"

namespace cargobay::hal {
namespace {

using test::command;
using test::RecordedDrive;

ReplayResult replayed(const std::vector<std::uint8_t>& file) {
  const auto recording = Recording::read(file);
  EXPECT_TRUE(recording) << recording.failure().message;
  const auto result = replay(*recording);
  EXPECT_TRUE(result) << result.failure().message;
  return *result;
}

std::string told(const ReplayResult& result) {
  if (!result.difference) return "";
  return result.difference->what + ": " + result.difference->recorded + " / " +
         result.difference->replayed;
}

TEST(Replay, IsTheSameForAnUndisturbedDrive) {
  for (const auto kind : {sim::Remainder::carried, sim::Remainder::lost}) {
    RecordedDrive drive{sim::Parameters{.remainder = kind}};
    drive.run(2000);
    const ReplayResult result = replayed(drive.file());
    EXPECT_EQ(told(result), "");
    EXPECT_EQ(result.frames, 2000U);
    EXPECT_EQ(result.commands, 2001U) << "one a frame, and the last stop";
    EXPECT_EQ(result.end, CycleEnd::asked);
  }
}

TEST(Replay, IsTheSameWithWhatOthersAskedFor) {
  RecordedDrive drive;
  drive.on_frame = [&](int frame) {
    if (frame % 20 == 0) {
      EXPECT_TRUE(drive.cycle().request(command({139, 8, 10, 20})));
    }
    if (frame % 50 == 0) {
      EXPECT_TRUE(drive.cycle().request({.kind = Request::Kind::look, .extras = kAllExtraLists}));
      EXPECT_TRUE(drive.cycle().request(command({151, 7})));
    }
    if (frame == 300) {
      EXPECT_TRUE(drive.cycle().request({.kind = Request::Kind::stream, .extras = kAllExtraLists}));
    }
    if (frame == 400) {
      EXPECT_TRUE(drive.cycle().request({.kind = Request::Kind::pose, .pose = {1.0, 2.0, 3.0}}));
    }
  };
  drive.run(600);
  const ReplayResult result = replayed(drive.file());
  EXPECT_EQ(told(result), "");
  EXPECT_EQ(result.frames, 600U);
}

// Frames lost, damaged, in pieces; and a silence long enough for the stop.
void disturb(RecordedDrive& drive, std::mt19937& random) {
  int swallowed = 0;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    const bool silent = drive.states.size() == 700 && swallowed < 20;
    if (silent) ++swallowed;
    if (silent || random() % 60 == 0) return std::size_t{0};
    if (random() % 20 == 0) bytes[random() % bytes.size()] ^= 0x10;
    return bytes.size();
  };
  drive.run(1500);
}

TEST(Replay, IsTheSameForADisturbedDrive) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    std::mt19937 random{seed};
    RecordedDrive drive;
    disturb(drive, random);
    const ReplayResult result = replayed(drive.file());
    EXPECT_EQ(told(result), "") << "seed " << seed;
    EXPECT_EQ(result.frames, drive.states.size());
    EXPECT_EQ(result.end, CycleEnd::asked);
  }
}

TEST(Replay, IsTheSameHoweverTheCycleEnds) {
  RecordedDrive silent;
  silent.line.damage = [&](std::span<std::uint8_t> bytes) {
    return silent.states.size() < 300 ? bytes.size() : 0;
  };
  silent.run(1000);
  RecordedDrive hung_up;
  hung_up.on_frame = [&](int frame) {
    if (frame == 300) hung_up.link.hang_up();
  };
  hung_up.run(1000);
  RecordedDrive at_a_cliff;
  at_a_cliff.on_frame = [&](int frame) {
    if (frame == 300) at_a_cliff.device.inputs().cliff_front_left.cliff = true;
  };
  at_a_cliff.run(1000);
  EXPECT_EQ(silent.end, CycleEnd::link_lost);
  EXPECT_EQ(hung_up.end, CycleEnd::hung_up);
  EXPECT_EQ(at_a_cliff.end, CycleEnd::mode_lost);
  for (const RecordedDrive* drive : {&silent, &hung_up, &at_a_cliff}) {
    const ReplayResult result = replayed(drive->file());
    EXPECT_EQ(told(result), "");
    EXPECT_EQ(result.end, drive->end);
    EXPECT_EQ(result.frames, drive->states.size());
    EXPECT_GE(result.frames, 300U);
  }
}

TEST(Replay, IsTheSameForSetpoints) {
  RecordedDrive drive;
  ASSERT_TRUE(bring_up(drive.link, {.packets = oi::kCreate.list(oi::FrameList::reading)}));
  ASSERT_FALSE(drive.link.set_wake_threshold(oi::kCreate.frame_bytes));
  RecordingStream recorded{drive.line, drive.recorder};
  const auto cycle = std::make_unique<ControlCycle>(recorded, drive.header.parameters);
  drive.header.baud = drive.link.baud();
  cycle->set_observer(drive.recorder.observer());
  int frame = 0;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    ++frame;
    if (frame == 10 || frame == 30) {
      EXPECT_TRUE(cycle->set_speeds({200.0, 100.0}));
    }
    if (frame == 120) cycle->request_stop();  // the setpoint has lapsed by then
    return bytes.size();
  };
  drive.recorder.ended(cycle->run());
  const ReplayResult result = replayed(drive.file());
  EXPECT_EQ(told(result), "");
  EXPECT_EQ(result.frames, 120U);
}

// The recorded drive with the nth entry of a kind changed.
using Change = std::function<void(Entry& entry, std::vector<std::uint8_t>& bytes)>;
std::vector<std::uint8_t> retold(const RecordedDrive& drive, EntryKind kind, int nth,
                                 const Change& change) {
  const std::vector<std::uint8_t> file = drive.file();
  const auto recording = Recording::read(file);
  EXPECT_TRUE(recording);
  RecordedDrive other;
  other.header = drive.header;
  Entry entry;
  for (EntryCursor cursor{recording->blocks()}; cursor.next(entry);) {
    std::vector<std::uint8_t> bytes{entry.bytes.begin(), entry.bytes.end()};
    if (entry.kind == kind && nth-- == 0) change(entry, bytes);
    switch (entry.kind) {
      case EntryKind::waited: other.recorder.waited(entry.wait); break;
      case EntryKind::clock: other.recorder.clock(entry.time); break;
      case EntryKind::read: other.recorder.read(bytes, entry.transfer.error); break;
      case EntryKind::wrote: other.recorder.wrote(bytes, entry.transfer); break;
      case EntryKind::state: other.recorder.state(entry.state); break;
      case EntryKind::ended: other.recorder.ended(entry.end); break;
      case EntryKind::asked: other.recorder.asked(entry.request); break;
    }
  }
  EXPECT_LT(nth, 0) << "there are not so many";
  return other.file();
}

TEST(Replay, IsToldTheSameWhereNothingIsChanged) {
  RecordedDrive drive;
  drive.run(500);
  EXPECT_EQ(retold(drive, EntryKind::read, 400, [](auto&, auto&) {}), drive.file());
}

TEST(Replay, FindsARequestThatWasAnother) {
  RecordedDrive drive;
  drive.on_frame = [&](int frame) {
    if (frame == 100) {
      EXPECT_TRUE(drive.cycle().request(command({139, 8, 10, 20})));
    }
  };
  drive.run(300);
  EXPECT_EQ(told(replayed(retold(drive, EntryKind::asked, 0, [](auto&, auto&) {}))), "");
  const ReplayResult result = replayed(
      retold(drive, EntryKind::asked, 0, [](Entry& entry, auto&) { entry.request.bytes[2] = 11; }));
  EXPECT_NE(told(result).find("bytes written"), std::string::npos);
}

// However a cycle can end, its recording shows it.
TEST(Replay, KnowsEveryEnd) {
  for (const CycleEnd end : {CycleEnd::asked, CycleEnd::link_lost, CycleEnd::mode_lost,
                             CycleEnd::hung_up, CycleEnd::guarded, CycleEnd::control_overrun}) {
    RecordedDrive drive;
    drive.run(20);
    const auto file =
        retold(drive, EntryKind::ended, 0, [end](Entry& entry, auto&) { entry.end = end; });
    const auto recording = Recording::read(file);
    EXPECT_TRUE(recording) << static_cast<int>(end);
  }
}

TEST(Replay, FindsOneBitOfAByteThatWasRead) {
  RecordedDrive drive;
  drive.run(500);
  // Its checksum: the frame counts as damaged, and the tick passes without an answer.
  const ReplayResult result =
      replayed(retold(drive, EntryKind::read, 400, [](auto&, auto& bytes) { bytes.back() ^= 1; }));
  ASSERT_TRUE(result.difference);
  EXPECT_EQ(result.frames, 400U);
  EXPECT_EQ(result.difference->tick, drive.states[399].tick);
}

TEST(Replay, FindsOneBitOfACommand) {
  RecordedDrive drive;
  drive.run(500);
  const ReplayResult result =
      replayed(retold(drive, EntryKind::wrote, 250, [](auto&, auto& bytes) { bytes.back() ^= 1; }));
  ASSERT_TRUE(result.difference);
  EXPECT_EQ(result.difference->what, "bytes written");
  EXPECT_EQ(result.commands, 250U);
}

TEST(Replay, FindsTheLastBitOfAnEstimate) {
  RecordedDrive drive;
  drive.run(500);
  const ReplayResult result =
      replayed(retold(drive, EntryKind::state, 250, [](Entry& entry, auto&) {
        entry.state.estimate.left_mm_s = std::nextafter(entry.state.estimate.left_mm_s, 1e9);
      }));
  ASSERT_TRUE(result.difference);
  EXPECT_EQ(result.difference->what, "left estimate");
  EXPECT_EQ(result.frames, 250U);
}

// As if the arithmetic were different: at first only the last bits differ.
TEST(Replay, FindsALoopThatIsNotTheSame) {
  RecordedDrive drive;
  drive.run(500);
  drive.header.parameters.loop.estimator.speed_noise_mm_s *= 1.0 + 1e-12;
  const ReplayResult result = replayed(drive.file());
  ASSERT_TRUE(result.difference);
  EXPECT_LT(result.frames, 500U);
}

TEST(Replay, FindsAnotherEnd) {
  RecordedDrive drive;
  drive.run(100);
  const ReplayResult result = replayed(retold(
      drive, EntryKind::ended, 0, [](Entry& entry, auto&) { entry.end = CycleEnd::link_lost; }));
  EXPECT_TRUE(result.difference);
}

TEST(Replay, GoesAsFarAsARecordingThatWasCutOff) {
  RecordedDrive drive;
  drive.run(500);
  std::vector<std::uint8_t> file = drive.file();
  file.resize(file.size() / 2);
  const ReplayResult result = replayed(file);
  EXPECT_EQ(told(result), "");
  EXPECT_NEAR(static_cast<double>(result.frames), 250.0, 15.0);
  EXPECT_FALSE(result.end);
}

TEST(Replay, NeedsTheBeginning) {
  RecordedDrive drive;
  drive.run(10'000);
  const auto file = drive.file();  // the recorder keeps fewer
  const auto recording = Recording::read(file);
  ASSERT_TRUE(recording);
  const auto result = replay(*recording);
  ASSERT_FALSE(result);
  EXPECT_NE(result.failure().message.find("beginning"), std::string::npos);
}

}  // namespace
}  // namespace cargobay::hal
