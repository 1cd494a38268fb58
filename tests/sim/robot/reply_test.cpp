// OI p. 13: replies come whole, at the line's pace.
#include <gtest/gtest.h>

#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct Asked : Robot {
  explicit Asked(std::uint8_t mode = 128) { send({128, mode}); }
  // 255 times group 6: 13260 bytes, which take 2.3 s.
  void ask_for_all() {
    Bytes list{149, 255};
    list.resize(257, 6);
    send(list);
  }
  // Everything that comes within that time, read as it comes.
  Bytes listen(rt::Duration period) {
    Bytes heard;
    for (rt::Duration left = period; left > 0ms; left -= 10ms) {
      wait(10ms);
      const Bytes piece = receive();
      heard.insert(heard.end(), piece.begin(), piece.end());
    }
    return heard;
  }
};
constexpr std::size_t kAll = 255 * std::size_t{52};

TEST(Replies, ComeWholeHoweverLong) {
  Asked robot;
  robot.ask_for_all();
  std::size_t heard = robot.listen(2s).size();
  EXPECT_NEAR(static_cast<double>(heard), 2.0 * 5760.0, 60.0) << "at the line's pace";
  heard += robot.listen(1s).size();
  EXPECT_EQ(heard, kAll);
  EXPECT_EQ(robot.device.counters().bytes_lost, 0U);
}

TEST(Replies, KeepWhatComesMeanwhileForLater) {
  Asked robot{132};
  robot.ask_for_all();
  // A command, a whole script and another question.
  robot.send({139, 8, 0, 0, 152, 3, 1, 2, 3, 154, 142, 35});
  EXPECT_TRUE(robot.device.replying());
  EXPECT_FALSE(robot.device.actuators().lit(oi::Led::advance));
  const Bytes heard = robot.listen(3s);
  ASSERT_EQ(heard.size(), kAll + 5);
  EXPECT_EQ((Bytes{heard.end() - 5, heard.end()}), (Bytes{3, 1, 2, 3, 3}));
  EXPECT_TRUE(robot.device.actuators().lit(oi::Led::advance));
}

TEST(Replies, HaveNoFramesInThem) {
  Asked robot;
  robot.send({148, 1, 35});
  robot.wait(100ms);
  robot.ask_for_all();
  const std::uint64_t frames = robot.device.counters().frames_sent;
  (void)robot.listen(2s);
  EXPECT_EQ(robot.device.counters().frames_sent, frames);
  (void)robot.listen(1s);
  EXPECT_GT(robot.device.counters().frames_sent, frames);
  EXPECT_EQ(robot.device.counters().bytes_lost, 0U);
}

// A stream that does not fit the line has filled the robot's memory when the question comes.
TEST(Replies, ComeWholeBehindAStreamThatDoesNotFit) {
  Asked robot;
  Bytes stream{148, 4, 6, 6, 6, 6};
  robot.send(stream);
  (void)robot.listen(1s);
  EXPECT_GT(robot.device.counters().bytes_lost, 0U);
  robot.send({150, 0, 149, 2, 35, 35, 154});
  const Bytes heard = robot.listen(1s);
  ASSERT_GT(heard.size(), 3U);
  EXPECT_EQ((Bytes{heard.end() - 3, heard.end()}), (Bytes{1, 1, 0}));
}

TEST(Replies, EndWithThePower) {
  Asked robot;
  robot.ask_for_all();
  robot.device.press_power();
  robot.device.press_power();
  robot.wait(4s);
  EXPECT_FALSE(robot.device.replying());
  robot.send({128});
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

// The manual has 43 ids (OI p. 13). A client that asks for another gets no bytes for it, but those
// of the others.
TEST(Replies, PassOverWhatIsNoPacket) {
  Asked robot;
  EXPECT_EQ(robot.ask({149, 4, 35, 43, 200, 37}), (Bytes{1, 0}));
  EXPECT_TRUE(robot.ask({142, 255}).empty());
  EXPECT_EQ(robot.device.counters().commands_out_of_range, 2U);
  robot.send({148, 3, 35, 100, 37});
  robot.wait(20ms);
  const Bytes frame = robot.receive();
  ASSERT_GE(frame.size(), 7U);
  EXPECT_EQ((Bytes{frame.begin(), frame.begin() + 6}), (Bytes{19, 4, 35, 1, 37, 0}));
  EXPECT_EQ(robot.device.stream().packets().size(), 2U) << "what packet 38 says";
}

}  // namespace
}  // namespace cargobay::hal::sim
