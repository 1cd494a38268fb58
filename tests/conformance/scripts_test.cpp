// What any Create does of its manual's Scripts and Waits, asked only over its serial line, so
// that any other device can be asked the same.
#include <gtest/gtest.h>

#include "tests/conformance/subject.hpp"

namespace cargobay::conformance {
namespace {

using ScriptCommands = Conformance;
using WaitCommands = Conformance;

// --- Scripts (OI p. 15) ---

TEST_F(ScriptCommands, ShowReturnsWhatWasStored) {
  const Bytes script{13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0};
  Bytes command{152};
  command.insert(command.end(), script.begin(), script.end());
  send(command);
  EXPECT_EQ(ask({154}, script.size()), script);
  send({152, 0});
  EXPECT_EQ(ask({154}, 1), (Bytes{0}));
}

TEST_F(ScriptCommands, HoldAHundredBytes) {
  Bytes command{152, 100};
  command.resize(102, 128);
  send(command);
  EXPECT_EQ(ask({154}, 101).size(), 101U);
}

TEST_F(ScriptCommands, OfMoreThanAHundredBytesAreNotStored) {
  send({152, 2, 128, 128});
  Bytes longer{152, 101};
  longer.resize(103, 132);
  send(longer);
  EXPECT_EQ(ask({154}, 3), (Bytes{2, 128, 128}));
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(ScriptCommands, ShowHaltsTheStream) {
  send({152, 0, 148, 1, 35});
  (void)receive(5);
  send({154});
  wait(100ms);
  EXPECT_TRUE(listen(100ms).empty());
  send({150, 1});
  EXPECT_EQ(receive(5).size(), 5U);
}

TEST_F(ScriptCommands, ArePlayed) {
  send({152, 3, 132, 142, 35});
  EXPECT_EQ(mode(), 1) << "stored is not played";
  EXPECT_EQ(ask({153}, 1), (Bytes{3}));
  EXPECT_EQ(ask({153}, 1), (Bytes{3})) << "and again";
}

TEST_F(ScriptCommands, AreKeptThroughModesAndReplacedByTheNext) {
  send({152, 2, 128, 128, 132, 131, 128});
  EXPECT_EQ(ask({154}, 3), (Bytes{2, 128, 128}));
  send({152, 1, 128});
  EXPECT_EQ(ask({154}, 2), (Bytes{1, 128}));
  EXPECT_TRUE(listen(50ms).empty());
}

TEST_F(ScriptCommands, DriveAndTellWhenTheyAreThrough) {
  (void)moved_within(0ms);
  send({152, 18, 132, 137, 0, 100, 128, 0, 156, 0, 40, 137, 0, 0, 128, 0, 128, 149, 1, 35, 153});
  EXPECT_EQ(receive(1, 5s), (Bytes{1}));
  wait(500ms);
  const std::int16_t moved = word_packet(19);
  EXPECT_GE(moved, 36);
  EXPECT_LT(moved, 80);
}

TEST_F(ScriptCommands, LoopWithPlayScriptAsTheirLastCommand) {
  send({152, 5, 142, 35, 155, 1, 153, 153});
  const Bytes ticks = receive(5, 3s);
  send({152, 0});  // the next round plays an empty script
  EXPECT_EQ(ticks, (Bytes{1, 1, 1, 1, 1}));
  wait(500ms);
  EXPECT_EQ(mode(), 1);
}

// --- Waits (OI p. 15, 16) ---

TEST_F(WaitCommands, WaitTimeHoldsBackWhatComesBehindIt) {
  const rt::TimePoint before = stream().now();
  EXPECT_EQ(ask({155, 5, 142, 35}, 1), (Bytes{1}));
  const rt::Duration waited = stream().now() - before;
  EXPECT_GE(waited, 490ms);
  EXPECT_LT(waited, 800ms);
}

TEST_F(WaitCommands, WaitDistanceEndsThere) {
  send({132, 137, 0, 100, 128, 0, 156, 0, 50, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 5s), (Bytes{3}));
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  EXPECT_GE(distance, 45);
  EXPECT_LT(distance, 90);
}

TEST_F(WaitCommands, WaitAngleEndsThere) {
  send({132, 137, 0, 100, 0xff, 0xff, 157, 0xff, 0xe2, 137, 0, 0, 128, 0, 142, 35});  // -30 degrees
  EXPECT_EQ(receive(1, 5s), (Bytes{3}));
  wait(500ms);
  const std::int16_t angle = word_packet(20);
  EXPECT_LE(angle, -26);
  EXPECT_GT(angle, -60);
}

TEST_F(WaitCommands, WaitAngleGoesCounterClockwiseToo) {
  send({132, 137, 0, 100, 0, 1, 157, 0, 30, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 5s), (Bytes{3}));
  wait(500ms);
  const std::int16_t angle = word_packet(20);
  EXPECT_GE(angle, 26);
  EXPECT_LT(angle, 60);
}

TEST_F(WaitCommands, WaitDistanceClearsTheDistance) {
  (void)moved_within(0ms);
  send({132, 145, 0, 150, 0, 150});
  wait(1s);
  send({156, 0, 20, 149, 1, 19});
  const Bytes distance = receive(2, 5s);
  send({145, 0, 0, 0, 0});
  ASSERT_EQ(distance.size(), 2U);
  EXPECT_EQ(distance[0], 0);
  EXPECT_GE(distance[1], 19);
  EXPECT_LT(distance[1], 40) << "what was driven before is forgotten";
  wait(500ms);
}

TEST_F(WaitCommands, WaitAngleClearsTheAngle) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 150, 0, 1});
  wait(1s);
  send({157, 0, 10, 149, 1, 20});
  const Bytes angle = receive(2, 5s);
  send({137, 0, 0, 0, 0});
  ASSERT_EQ(angle.size(), 2U);
  EXPECT_EQ(angle[0], 0);
  EXPECT_GE(angle[1], 9);
  EXPECT_LT(angle[1], 30) << "what was turned before is forgotten";
  wait(500ms);
}

TEST_F(WaitCommands, WaitDistanceGoesBackwardToo) {
  send({132, 137, 0xff, 0x9c, 128, 0, 156, 0xff, 0xce, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 5s), (Bytes{3}));
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  EXPECT_LE(distance, -45);
  EXPECT_GT(distance, -90);
}

// Backward too, and clockwise: a 0 that is only reached going forward would never end.
TEST_F(WaitCommands, NoDistanceAndNoAngleEndAtOnce) {
  send({132, 137, 0xff, 0x9c, 128, 0});
  wait(300ms);
  send({156, 0, 0, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 1s), (Bytes{3}));
  send({137, 0, 100, 0xff, 0xff});
  wait(300ms);
  send({157, 0, 0, 137, 0, 0, 128, 0, 142, 35});
  EXPECT_EQ(receive(1, 1s), (Bytes{3}));
}

TEST_F(WaitCommands, SilenceTheStream) {
  send({148, 1, 35});
  (void)receive(5);
  send({155, 5});
  wait(100ms);
  EXPECT_TRUE(listen(300ms).empty());
  EXPECT_EQ(receive(5).size(), 5U);
  send({150, 0});
}

TEST_F(WaitCommands, AreDeafAndKeepWhatTheyHear) {
  send({155, 4});
  wait(50ms);
  send({132, 142, 35});
  EXPECT_TRUE(listen(200ms).empty());
  EXPECT_EQ(receive(1), (Bytes{3}));
}

TEST_F(WaitCommands, WaitEventSeesWhatIsSoAlready) {
  EXPECT_EQ(ask({158, 22, 142, 35}, 1), (Bytes{1})) << "Passive";
  EXPECT_EQ(ask({158, 251, 142, 35}, 1), (Bytes{1})) << "no bump";
}

}  // namespace
}  // namespace cargobay::conformance
