// The named faults: what each does, and that a seed repeats it exactly.
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "hal/sim/line/line_faults.hpp"
#include "hal/sim/remote/fault_command.hpp"
#include "oi/checksum.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct Streaming : Robot {
  explicit Streaming(std::uint64_t seed = 1)
      : Robot{[seed] {
          Parameters parameters;
          parameters.seed = seed;
          return parameters;
        }()} {
    send({128, 132, 148, 1, 35});
    to_tick();
    wait(10ms);
    (void)receive();
  }
  std::string fault(std::string_view command) { return apply_fault(command, link.cable()); }
  Bytes stream(rt::Duration period) {
    wait(period);
    return receive();
  }
};

const Bytes kFrame{19, 2, 35, 3, 197};

// How many of the frames came through whole, directly in a row or with something in between.
std::size_t whole_frames(const Bytes& bytes) {
  std::size_t frames = 0;
  auto at = bytes.begin();
  while ((at = std::search(at, bytes.end(), kFrame.begin(), kFrame.end())) != bytes.end()) {
    ++frames;
    at += static_cast<std::ptrdiff_t>(kFrame.size());
  }
  return frames;
}

TEST(Faults, LoseBytes) {
  Streaming robot;
  EXPECT_EQ(robot.fault("lost 0.1"), "");
  const Bytes bytes = robot.stream(10s);
  EXPECT_NEAR(static_cast<double>(bytes.size()), 3000.0, 100.0);
  EXPECT_NEAR(static_cast<double>(whole_frames(bytes)), 394.0, 50.0);
}

TEST(Faults, FlipOneBitOfAByte) {
  Streaming robot;
  EXPECT_EQ(robot.fault("flipped 1"), "");
  const Bytes bytes = robot.stream(150ms);
  ASSERT_EQ(bytes.size(), 50U);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const unsigned difference = static_cast<unsigned>(bytes[i] ^ kFrame[i % 5]);
    EXPECT_EQ(difference & (difference - 1), 0U);
    EXPECT_NE(difference, 0U);
  }
}

TEST(Faults, DuplicateBytes) {
  Streaming robot;
  EXPECT_EQ(robot.fault("duplicated 1"), "");
  EXPECT_EQ(robot.stream(15ms), (Bytes{19, 19, 2, 2, 35, 35, 3, 3, 197, 197}));
}

TEST(Faults, InsertBytes) {
  Streaming robot;
  EXPECT_EQ(robot.fault("inserted 1"), "");
  const Bytes bytes = robot.stream(15ms);
  ASSERT_EQ(bytes.size(), 10U);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(bytes[2 * i], kFrame[i]);
}

TEST(Faults, GarbleTheFramesAskedForAndNoMore) {
  Streaming robot;
  EXPECT_EQ(robot.fault("garbled-frame 3"), "");
  const Bytes bytes = robot.stream(150ms);
  EXPECT_EQ(bytes.size(), 50U);
  EXPECT_EQ(whole_frames(bytes), 7U);
  EXPECT_EQ(bytes[0], 19) << "its header is whole";
}

TEST(Faults, StallTheStreamAndNotTheReplies) {
  Streaming robot;
  EXPECT_EQ(robot.fault("stalled-stream 500"), "");
  EXPECT_TRUE(robot.stream(480ms).empty());
  robot.send({142, 35});
  EXPECT_EQ(robot.stream(5ms), (Bytes{3}));
  EXPECT_GT(robot.stream(200ms).size(), 20U);
}

TEST(Faults, BunchBytesByTheAdaptersTimer) {
  Streaming robot;
  EXPECT_EQ(robot.fault("burst on"), "");
  std::set<std::int64_t> phases;
  ASSERT_FALSE(robot.link.set_wake_threshold(1));
  for (int i = 0; i < 50; ++i) {
    ASSERT_EQ(robot.link.wait(robot.link.now() + 1s), ByteStream::Wait::ready);
    phases.insert(rt::nanoseconds(robot.link.now()) % 16'000'000);
    EXPECT_EQ(robot.receive().size() % 5, 0U);
  }
  EXPECT_EQ(phases, (std::set<std::int64_t>{0}));
  EXPECT_EQ(robot.fault("burst off"), "");
  robot.wait(100ms);
  EXPECT_EQ(whole_frames(robot.receive()), 7U);
}

// Every third frame is 4 ms late, as a whole, and no other.
TEST(Faults, HoldBackWholeFrames) {
  Streaming robot;
  robot.wait(100ms);
  (void)robot.receive();
  EXPECT_EQ(robot.fault("held 3 4"), "");
  std::vector<std::int64_t> phases_us;
  ASSERT_FALSE(robot.link.set_wake_threshold(5));
  for (int i = 0; i < 30; ++i) {
    ASSERT_EQ(robot.link.wait(robot.link.now() + 1s), ByteStream::Wait::ready);
    phases_us.push_back(rt::nanoseconds(robot.link.now()) / 1000 % 15'000);
    EXPECT_EQ(robot.receive().size(), 5U);
  }
  for (std::size_t i = 0; i < phases_us.size(); ++i)
    EXPECT_NEAR(static_cast<double>(phases_us[i] - phases_us[0]), (i + 1) % 3 == 0 ? 4000.0 : 0.0,
                1.0)
        << i;
  EXPECT_EQ(robot.fault("held 0"), "");
}

TEST(Faults, SendAFullAdapterPacketAtOnce) {
  Robot robot;
  robot.send({128});
  robot.link.cable().faults_to_host().latency_timer = 1s;
  robot.send({149, 2, 6, 6});
  robot.wait(30ms);
  EXPECT_EQ(robot.receive().size(), 62U);
  robot.wait(1s);
  EXPECT_EQ(robot.receive().size(), 42U);
}

TEST(Faults, DelayBytesAndKeepTheirOrder) {
  Streaming robot;
  EXPECT_EQ(robot.fault("jitter 40"), "");
  const Bytes bytes = robot.stream(3s);
  EXPECT_EQ(whole_frames(bytes), bytes.size() / 5);
  EXPECT_GT(whole_frames(bytes), 190U);
}

TEST(Faults, UnplugAndReplugTheLine) {
  Streaming robot;
  EXPECT_EQ(robot.fault("unplugged"), "");
  robot.send({128});
  EXPECT_TRUE(robot.stream(1s).empty());
  EXPECT_EQ(robot.device.mode(), oi::Mode::full);
  EXPECT_EQ(robot.fault("replugged"), "");
  EXPECT_GT(whole_frames(robot.stream(150ms)), 8U);
}

TEST(Faults, BrownOut) {
  Streaming robot;
  EXPECT_EQ(robot.fault("brown-out"), "");
  EXPECT_EQ(robot.device.power(), Power::booting);
}

TEST(Faults, ChangeTheRobotsRate) {
  Streaming robot;
  EXPECT_EQ(robot.fault("wrong-baud 19200"), "");
  EXPECT_EQ(whole_frames(robot.stream(1s)), 0U);
  ASSERT_FALSE(robot.link.set_baud(19200));
  robot.wait(100ms);
  EXPECT_GT(whole_frames(robot.stream(1s)), 60U);
}

TEST(Faults, LeaveTheRobotWithAHalfSentCommand) {
  Streaming robot;
  EXPECT_EQ(robot.fault("half-command"), "");
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), oi::Mode::full);
  robot.send(Bytes(520, 128));
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
}

TEST(Faults, FindTheRobotWithAHalfSentCommandBeforeAnyStart) {
  Robot robot;
  EXPECT_EQ(apply_fault("half-command", robot.link.cable()), "");
  EXPECT_TRUE(robot.ask({128, 132, 142, 35}).empty()) << "all of it was data";
  robot.send(Bytes(520, 128));
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Faults, MakeTheFirstReadingJunk) {
  Streaming robot;
  robot.send({150, 0});
  EXPECT_EQ(robot.fault("junk-reading"), "");
  const Bytes junk = robot.ask({142, 2});
  EXPECT_NE(word(junk, 2), 0);
  EXPECT_NE(word(junk, 4), 0);
  const Bytes sound = robot.ask({142, 2});
  EXPECT_EQ(word(sound, 2), 0);
  EXPECT_EQ(word(sound, 4), 0);
}

TEST(Faults, PrintTextInTheStream) {
  Streaming robot;
  EXPECT_EQ(robot.fault("text slept for 5 minutes"), "");
  const Bytes bytes = robot.stream(30ms);
  const std::string text{bytes.begin(), bytes.end()};
  EXPECT_NE(text.find("slept for 5 minutes\r\n"), std::string::npos);
}

TEST(Faults, WorkOnWhatTheHostSendsToo) {
  Streaming robot;
  EXPECT_EQ(robot.fault("lost 1 to-robot"), "");
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), oi::Mode::full);
  EXPECT_GT(whole_frames(robot.stream(150ms)), 8U);
  EXPECT_EQ(robot.fault("none"), "");
  robot.send({128});
  EXPECT_EQ(robot.device.mode(), oi::Mode::passive);
}

class FaultsOfChance : public testing::TestWithParam<const char*> {};

TEST_P(FaultsOfChance, RepeatThemselvesUnderOneSeed) {
  const std::string fault = GetParam();
  const auto run = [&fault](std::uint64_t seed) {
    Streaming robot{seed};
    EXPECT_EQ(robot.fault(fault), "");
    robot.send({148, 3, 19, 20, 35});
    return robot.stream(5s);
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2)) << "another seed, another way";
}

INSTANTIATE_TEST_SUITE_P(EachThatIsRandom, FaultsOfChance,
                         testing::Values("lost 0.02", "flipped 0.02", "duplicated 0.02 both",
                                         "inserted 0.02", "garbled-frame 20", "junk-reading 20"));

// Which bytes come is the same for any seed; when they come is not.
TEST(Faults, RepeatTheirJitterUnderOneSeed) {
  const auto run = [](std::uint64_t seed) {
    Streaming robot{seed};
    EXPECT_EQ(robot.fault("jitter 7"), "");
    std::vector<std::int64_t> times;
    for (int i = 0; i < 200; ++i) {
      (void)robot.link.wait(robot.link.now() + 1s);
      times.push_back(rt::nanoseconds(robot.link.now()));
      (void)robot.receive();
    }
    return times;
  };
  EXPECT_EQ(run(1), run(1));
  EXPECT_NE(run(1), run(2));
}

TEST(Faults, SayWhatIsWrongWithACommand) {
  Streaming robot;
  for (const char* bad : {"lost",
                          "lost 1.1",
                          "lost -1",
                          "lost x",
                          "lost 0.1 up",
                          "lost 0.1 both ways",
                          "burst",
                          "burst maybe",
                          "jitter",
                          "jitter -1",
                          "jitter nan",
                          "held",
                          "held 3",
                          "held 3 x",
                          "stalled-stream",
                          "wrong-baud 1234",
                          "garbled-frame x",
                          "unplugged now",
                          "none please",
                          "junk-reading 1 2",
                          "brown-out 3"}) {
    const std::string message = robot.fault(bad);
    EXPECT_EQ(message.substr(0, 14), "the usage is '") << bad;
  }
  EXPECT_NE(robot.fault("earthquake").find("unknown fault 'earthquake'"), std::string::npos);
  EXPECT_NE(robot.fault("").find("brown-out"), std::string::npos);
  EXPECT_EQ(whole_frames(robot.stream(150ms)), 10U) << "nothing was changed";
}

TEST(Faults, AreAllKnownByTheirNames) {
  Streaming robot;
  for (const FaultInfo& fault : faults()) {
    const std::string message = robot.fault(std::string{fault.name} + " 1 2 3 4");
    EXPECT_EQ(message.find("unknown fault"), std::string::npos) << fault.name;
  }
}

}  // namespace
}  // namespace cargobay::hal::sim
