// What any Create does of its manual's Actuators and Songs, asked only over its serial line, so
// that any other device can be asked the same.
#include <cstdlib>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "tests/conformance/subject.hpp"

namespace cargobay::conformance {
namespace {

using ActuatorCommands = Conformance;
using SongCommands = Conformance;

// --- Actuators (OI p. 9 to 11) ---

TEST_F(ActuatorCommands, DriveIsReadBack) {
  send({132, 137, 0xff, 0xce, 1, 244});  // -50 mm/s, radius 500 mm
  EXPECT_EQ(word_packet(39), -50);
  EXPECT_EQ(word_packet(40), 500);
}

TEST_F(ActuatorCommands, SpeedsAndRadiiOutOfRangeAreBroughtIntoIt) {
  send({132, 137, 0, 0, 0x07, 0xd1});  // 2001 mm
  EXPECT_EQ(word_packet(40), 2000);
  send({145, 0x01, 0xf5, 0, 0, 142, 41, 145, 0, 0, 0, 0});  // 501 mm/s, for an instant
  EXPECT_EQ(receive(2), (Bytes{0x01, 0xf4}));
}

TEST_F(ActuatorCommands, DriveDirectIsReadBackRightAndLeft) {
  send({132, 145, 0, 40, 0xff, 0xd8});
  EXPECT_EQ(word_packet(41), 40);
  EXPECT_EQ(word_packet(42), -40);
}

TEST_F(ActuatorCommands, DrivingIsMeasured) {
  send({132, 142, 2});
  (void)receive(6);
  send({145, 0, 100, 0, 100});
  wait(1s);
  send({145, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  EXPECT_GT(distance, 60);
  EXPECT_LT(distance, 120);
  EXPECT_EQ(word_packet(19), 0) << "a reading clears";
}

TEST_F(ActuatorCommands, DriveGoesStraightByEitherOfTwoRadii) {
  for (const auto& [high, low] : {std::pair{0x80, 0x00}, std::pair{0x7f, 0xff}}) {
    send({132, 142, 2});
    (void)receive(6);
    send({137, 0, 100, static_cast<std::uint8_t>(high), static_cast<std::uint8_t>(low)});
    wait(1s);
    send({137, 0, 0, 0, 0});
    wait(500ms);
    EXPECT_GT(word_packet(19), 60);
    EXPECT_LE(std::abs(word_packet(20)), 5) << "a degree or two of droop";
  }
}

TEST_F(ActuatorCommands, DrivingBackwardIsNegative) {
  (void)moved_within(0ms);
  send({132, 145, 0xff, 0x9c, 0xff, 0x9c});
  const int moved = moved_within(1s);
  send({145, 0, 0, 0, 0});
  EXPECT_LT(moved, -60);
  EXPECT_GT(moved, -120);
  wait(500ms);
}

TEST_F(ActuatorCommands, DriveTurnsClockwiseByRadiusMinusOne) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 100, 0xff, 0xff});
  wait(1s);
  send({137, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t angle = word_packet(20);
  EXPECT_LT(angle, -25);
  EXPECT_GT(angle, -60);
}

TEST_F(ActuatorCommands, DriveTurnsAroundACentreToTheLeft) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 150, 1, 44});  // 150 mm/s, radius 300 mm
  wait(1s);
  send({137, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  const std::int16_t angle = word_packet(20);
  EXPECT_GT(distance, 100);
  EXPECT_GT(angle, 15);
  EXPECT_NEAR(angle, distance * 57.3 / 300.0, 8.0) << "an arc of that radius";
}

TEST_F(ActuatorCommands, TurningIsMeasuredCounterClockwisePositive) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 100, 0, 1});
  wait(1s);
  send({137, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t angle = word_packet(20);
  EXPECT_GT(angle, 25);
  EXPECT_LT(angle, 60);
}

TEST_F(ActuatorCommands, DriveTurnsRightByANegativeRadius) {
  send({132, 142, 2});
  (void)receive(6);
  send({137, 0, 150, 0xfe, 0xd4});  // 150 mm/s, radius -300 mm
  wait(1s);
  send({137, 0, 0, 0, 0});
  wait(500ms);
  const std::int16_t distance = word_packet(19);
  const std::int16_t angle = word_packet(20);
  EXPECT_GT(distance, 100);
  EXPECT_NEAR(angle, distance * -57.3 / 300.0, 8.0);
}

TEST_F(ActuatorCommands, DriveTurnsLessByALongerRadius) {
  const auto turned = [this](std::uint8_t high, std::uint8_t low) {
    send({132, 142, 2});
    (void)receive(6);
    send({137, 0, 150, high, low});
    wait(1s);
    send({137, 0, 0, 0, 0});
    wait(500ms);
    return word_packet(20);
  };
  const std::int16_t short_radius = turned(0, 200);
  const std::int16_t middle = turned(1, 144);   // 400 mm
  const std::int16_t longest = turned(7, 208);  // 2000 mm
  EXPECT_GT(short_radius, middle);
  EXPECT_GT(middle, longest);
}

TEST_F(ActuatorCommands, DriveBacksByANegativeVelocity) {
  (void)moved_within(0ms);
  send({132, 137, 0xff, 0x9c, 128, 0});  // -100 mm/s
  const int moved = moved_within(1s);
  send({137, 0, 0, 0, 0});
  EXPECT_LT(moved, -60);
  EXPECT_GT(moved, -120);
  wait(500ms);
}

TEST_F(ActuatorCommands, DriveDirectMovesEachWheelByItself) {
  for (const auto& [command, forward, left] :
       {std::tuple{Bytes{145, 0, 150, 0, 0}, true, true},          // the right wheel forward
        std::tuple{Bytes{145, 0, 0, 0, 150}, true, false},         // the left wheel forward
        std::tuple{Bytes{145, 0xff, 0x6a, 0, 0}, false, false},    // the right wheel back
        std::tuple{Bytes{145, 0, 0, 0xff, 0x6a}, false, true}}) {  // the left wheel back
    send({132, 142, 2});
    (void)receive(6);
    send(command);
    wait(700ms);
    send({145, 0, 0, 0, 0});
    wait(500ms);
    EXPECT_EQ(word_packet(19) > 15, forward);
    EXPECT_EQ(word_packet(20) > 10, left);
  }
}

TEST_F(ActuatorCommands, AreObeyedInSafeAndKeepTheMode) {
  for (const auto& [opcode, number] : {std::pair{131, 2}, {132, 3}}) {
    send({static_cast<std::uint8_t>(opcode)});
    send({137, 0xff, 0xce, 1, 244});
    EXPECT_EQ(word_packet(39), -50);
    EXPECT_EQ(mode(), number) << "Drive";
    send({145, 0, 40, 0, 20});
    EXPECT_EQ(word_packet(41), 40);
    EXPECT_EQ(word_packet(42), 20);
    send({145, 0, 0, 0, 0});
    EXPECT_EQ(mode(), number) << "Drive Direct";
    send({140, 2, 1, 60, 8, 141, 2});
    EXPECT_EQ(packet(37), 1);
    EXPECT_EQ(mode(), number) << "Play Song";
    wait(300ms);
    for (const Bytes& command :
         {Bytes{139, 8, 0, 128}, Bytes{147, 5}, Bytes{144, 32, 0, 16}, Bytes{138, 2},
          Bytes{151, 77}, Bytes{138, 0}, Bytes{147, 0}, Bytes{139, 0, 0, 0}}) {
      send(command);
      EXPECT_EQ(mode(), number) << int{command[0]};
    }
  }
}

TEST_F(ActuatorCommands, TakeTheirBytesAndNoMore) {
  for (const Bytes& command :
       {Bytes{139, 8, 0, 128}, Bytes{138, 2}, Bytes{144, 32, 0, 128}, Bytes{147, 5}, Bytes{151, 77},
        Bytes{138, 0}, Bytes{147, 0}, Bytes{139, 0, 0, 0}}) {
    send({132});
    send(command);
    EXPECT_EQ(mode(), 3) << int{command[0]};
  }
}

// What they do shows only on the robot; that they leave the rest alone shows here, too.
TEST_F(ActuatorCommands, LedsOutputsDriversAndIrLeaveTheWheelsAndTheStreamAlone) {
  send({132, 145, 0, 0, 0, 30, 148, 1, 35});
  for (const Bytes& command :
       {Bytes{139, 10, 128, 255}, Bytes{147, 7}, Bytes{138, 7}, Bytes{144, 128, 64, 1},
        Bytes{151, 200}, Bytes{139, 0, 0, 0}, Bytes{147, 0}, Bytes{138, 0}, Bytes{144, 0, 0, 0}}) {
    send(command);
    const Bytes frames = receive(10);
    ASSERT_EQ(frames.size(), 10U) << int{command[0]};
    EXPECT_EQ(frames[3], 3) << int{command[0]};
  }
  send({150, 0});
  wait(100ms);
  EXPECT_EQ(word_packet(42), 30);
  EXPECT_EQ(packet(14), 0) << "no overcurrent";
}

// --- Songs (OI p. 11, 12) ---

TEST_F(SongCommands, OutlastTheirMode) {
  send({132, 140, 0, 1, 60, 32, 141, 0, 128});
  EXPECT_EQ(packet(37), 1);
  wait(700ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, PlayForAsLongAsTheirNotesSay) {
  send({132, 140, 3, 2, 60, 32, 30, 32});  // half a second, and a rest of the same length
  send({141, 3});
  EXPECT_EQ(packet(36), 3);
  EXPECT_EQ(packet(37), 1);
  wait(800ms);
  EXPECT_EQ(packet(37), 1);
  wait(400ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, PlayIsIgnoredWhileASongPlays) {
  send({132, 140, 1, 1, 60, 48, 140, 2, 1, 62, 48, 141, 1, 141, 2});
  EXPECT_EQ(packet(36), 1);
  wait(900ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, AreOverwritten) {
  send({132, 140, 4, 1, 60, 255, 140, 4, 1, 60, 8, 141, 4});
  wait(300ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, PlayOnWhenTheirNumberIsGivenAway) {
  send({132, 140, 5, 1, 60, 48, 141, 5, 140, 5, 1, 62, 4});
  wait(400ms);
  EXPECT_EQ(packet(37), 1) << "the new one would be over";
  wait(600ms);
  EXPECT_EQ(packet(37), 0);
}

TEST_F(SongCommands, OfSeventeenNotesAreNotStored) {
  send({132, 140, 7, 1, 60, 8});
  Bytes longer{140, 7, 17};
  for (int i = 0; i < 17; ++i) longer.insert(longer.end(), {70, 32});
  send(longer);
  send({141, 7});
  wait(400ms);
  EXPECT_EQ(packet(37), 0) << "the one before was an eighth of a second";
}

TEST_F(SongCommands, HoldSixteenNotes) {
  Bytes song{132, 140, 15, 16};
  for (int i = 0; i < 16; ++i) song.insert(song.end(), {70, 4});
  send(song);
  send({141, 15});
  wait(800ms);
  EXPECT_EQ(packet(37), 1);
  wait(400ms);
  EXPECT_EQ(packet(37), 0);
}

}  // namespace
}  // namespace cargobay::conformance
