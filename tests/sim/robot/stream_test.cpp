// OI p. 14: Stream and Pause/Resume Stream.
#include <gtest/gtest.h>

#include "oi/checksum.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

// The surroundings of the manual's example.
struct Example : Robot {
  explicit Example(oi::Checksum checksum = oi::Checksum::including_header)
      : Robot{[checksum] {
          Parameters parameters;
          parameters.checksum = checksum;
          return parameters;
        }()} {
    device.inputs().cliff_front_left.signal = 0x0219;
    send({128});
    to_tick();
  }
};

TEST(Stream, SendsTheFrameOfTheManualWithTheChecksumOfARobot) {
  Example robot;
  robot.send({148, 2, 29, 13});
  robot.to_tick();
  robot.wait(10ms);
  EXPECT_EQ(robot.receive(), (Bytes{19, 5, 29, 2, 25, 13, 0, 163}));
}

TEST(Stream, SendsTheFrameOfTheManualWithTheChecksumOfTheManual) {
  Example robot{oi::Checksum::excluding_header};
  robot.send({148, 2, 29, 13});
  robot.to_tick();
  robot.wait(10ms);
  EXPECT_EQ(robot.receive(), (Bytes{19, 5, 29, 2, 25, 13, 0, 182}));
}

TEST(Stream, SendsAFrameEachTick) {
  Example robot;
  robot.send({148, 1, 35});
  robot.to_tick();
  EXPECT_TRUE(robot.receive().empty()) << "the frame begins at the tick";
  robot.wait(15ms * 99 + 14ms);
  EXPECT_EQ(robot.receive().size(), 100 * 5U);
}

TEST(Stream, EndsItsFrameWhenTheWireSays) {
  Example robot;
  robot.send({148, 2, 29, 13});
  robot.to_tick();
  const rt::Duration tick = robot.device.now();
  ASSERT_FALSE(robot.link.set_wake_threshold(8));
  EXPECT_EQ(robot.link.wait(robot.link.now() + 1s), ByteStream::Wait::ready);
  EXPECT_EQ(robot.link.now().time_since_epoch() - tick, 1'388'889ns);  // 80 bits at 57600
}

TEST(Stream, PausesAndResumesWithItsList) {
  Example robot;
  robot.send({148, 1, 35, 150, 0});
  robot.wait(100ms);
  EXPECT_TRUE(robot.receive().empty());
  EXPECT_EQ(robot.ask({142, 38}), (Bytes{1}));
  robot.send({150, 1});
  robot.to_tick();
  robot.wait(10ms);
  EXPECT_EQ(robot.receive(), (Bytes{19, 2, 35, 1, 199}));
}

TEST(Stream, ReplacesItsList) {
  Example robot;
  robot.send({148, 3, 19, 20, 35, 148, 1, 35});
  robot.to_tick();
  robot.wait(10ms);
  EXPECT_EQ(robot.receive().size(), 5U);
}

TEST(Stream, OfNothingEnds) {
  Example robot;
  robot.send({148, 1, 35, 148, 0});
  robot.wait(100ms);
  EXPECT_TRUE(robot.receive().empty());
}

TEST(Stream, HasNothingToResumeAtFirst) {
  Example robot;
  robot.send({150, 1});
  robot.wait(100ms);
  EXPECT_TRUE(robot.receive().empty());
}

TEST(Stream, GoesOnThroughModeChanges) {
  Example robot;
  robot.send({148, 1, 35});
  for (const std::uint8_t opcode : Bytes{131, 132, 128}) {
    robot.send({opcode});
    robot.to_tick();
    robot.wait(10ms);
    const Bytes frame = robot.receive();
    ASSERT_EQ(frame.size(), 5U);
    EXPECT_EQ(frame[3], static_cast<std::uint8_t>(robot.device.mode()));
  }
}

TEST(Stream, NamesItsPacketsAndGroups) {
  Example robot;
  robot.send({148, 2, 1, 35});
  robot.to_tick();
  robot.wait(10ms);
  const Bytes frame = robot.receive();
  ASSERT_EQ(frame.size(), 16U);
  EXPECT_EQ(frame[1], 13);
  EXPECT_EQ(frame[2], 1);
  EXPECT_EQ(frame[13], 35);
}

// More than the wire carries: the room fills up, and then bytes are missing within frames.
TEST(Stream, IsCorruptedInTheEndWhereItDoesNotFit) {
  Example robot;
  robot.send({148, 2, 6, 6});  // 109 bytes, of which 86 fit into a tick
  robot.wait(200ms);
  EXPECT_EQ(robot.device.counters().bytes_lost, 0U);
  robot.wait(3s);
  EXPECT_GT(robot.device.counters().bytes_lost, 500U);
  (void)robot.receive();
  robot.wait(200ms);
  EXPECT_EQ(robot.receive().size(), 1152U) << "the wire is never idle";
}

TEST(Stream, MixesUnframedRepliesIn) {
  Example robot;
  robot.send({148, 1, 35});
  robot.to_tick();
  robot.send({142, 35});
  robot.wait(5ms);
  EXPECT_EQ(robot.receive(), (Bytes{19, 2, 35, 1, 199, 1}));
}

TEST(Stream, GoesOnInsteadOfOneOfMoreThanFortyThreePackets) {
  Robot robot;
  robot.send({128, 148, 2, 35, 37});
  Bytes longer{148, 44};
  longer.resize(46, 7);
  robot.send(longer);
  EXPECT_EQ(robot.device.stream().packets().size(), 2U);
  EXPECT_EQ(robot.device.counters().commands_out_of_range, 1U);
  longer.resize(45);
  longer[1] = 43;
  robot.send(longer);
  EXPECT_EQ(robot.device.stream().packets().size(), 43U);
  EXPECT_EQ(robot.device.counters().commands_out_of_range, 1U);
}

}  // namespace
}  // namespace cargobay::hal::sim
