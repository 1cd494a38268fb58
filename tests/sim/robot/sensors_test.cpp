// OI p. 13, 17 to 21: Sensors, Query List and their answers.
#include <numeric>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "oi/packet_table.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

struct Passive : Robot {
  explicit Passive(const Parameters& parameters = {}) : Robot{parameters} { send({128}); }
};

TEST(Sensors, AnswersEveryPacketWithItsSize) {
  Passive robot;
  for (std::uint8_t id = 0; id < oi::kPacketCount; ++id) {
    EXPECT_EQ(robot.ask({142, id}).size(), oi::kCreate.packet_size(id)) << int{id};
  }
}

TEST(Sensors, IsSilentForWhatIsNoPacket) {
  Passive robot;
  EXPECT_TRUE(robot.ask({142, 43}).empty());
  EXPECT_TRUE(robot.ask({142, 255}).empty());
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Sensors, ReportsWhatIsSeenAtATick) {
  Passive robot;
  robot.to_tick();
  robot.device.inputs().bump_left = true;
  robot.device.inputs().wheel_drop_caster = true;
  EXPECT_EQ(robot.ask({142, 7}), (Bytes{0})) << "not before the next tick";
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 7}), (Bytes{0b10010}));
}

TEST(Sensors, PutsEachInputInItsBit) {
  Passive robot;
  Inputs& inputs = robot.device.inputs();
  inputs.bump_right = true;
  inputs.wheel_drop_right = true;
  inputs.overcurrent_low_side_driver = {false, true, false};
  inputs.overcurrent_left_wheel = true;
  inputs.play_button = true;
  inputs.advance_button = true;
  inputs.digital = {false, false, true, false};
  inputs.home_base = true;
  inputs.cliff_front_left = {.cliff = true, .signal = 0x0225};
  inputs.infrared = 254;
  inputs.analog = 1023;
  robot.to_tick();
  EXPECT_EQ(robot.ask({142, 7}), (Bytes{0b00101}));
  EXPECT_EQ(robot.ask({142, 14}), (Bytes{0b10001})) << "driver 1 is bit 0";
  EXPECT_EQ(robot.ask({142, 18}), (Bytes{0b101}));
  EXPECT_EQ(robot.ask({142, 32}), (Bytes{0b10100})) << "the Baud Rate Change pin is high";
  EXPECT_EQ(robot.ask({142, 34}), (Bytes{0b10}));
  EXPECT_EQ(robot.ask({142, 10}), (Bytes{1}));
  EXPECT_EQ(robot.ask({142, 29}), (Bytes{2, 37}));
  EXPECT_EQ(robot.ask({142, 17}), (Bytes{254}));
  EXPECT_EQ(robot.ask({142, 33}), (Bytes{3, 255}));
}

TEST(Sensors, ReportsWhatWasRequestedLast) {
  Passive robot;
  robot.send({132, 137, 0xff, 56, 1, 244, 145, 0, 1, 0xff, 0xff});
  EXPECT_EQ(robot.ask({149, 4, 39, 40, 41, 42}), (Bytes{0xff, 56, 1, 244, 0, 1, 0xff, 0xff}));
}

TEST(QueryList, AnswersInTheOrderAsked) {
  Passive robot;
  robot.device.inputs().cliff_left.cliff = true;
  robot.to_tick();
  EXPECT_EQ(robot.ask({149, 2, 9, 13}), (Bytes{1, 0}));  // the manual's example
  EXPECT_EQ(robot.ask({149, 3, 13, 9, 35}), (Bytes{0, 1, 1}));
}

TEST(QueryList, OfNothingAnswersNothing) {
  Passive robot;
  EXPECT_TRUE(robot.ask({149, 0}).empty());
  EXPECT_EQ(robot.ask({142, 35}), (Bytes{1}));
}

TEST(Distance, IsClearedByAReadByAnyRoute) {
  for (const Bytes& reading : {Bytes{142, 19}, Bytes{142, 2}, Bytes{142, 0}, Bytes{142, 6},
                               Bytes{149, 1, 19}, Bytes{149, 1, 2}, Bytes{148, 1, 19, 150, 0}}) {
    Passive robot{ideal_wheels()};
    robot.send({132, 145, 0, 100, 0, 100});
    robot.wait(1s);
    robot.send({145, 0, 0, 0, 0});
    robot.to_tick();
    robot.to_tick();
    if (reading[0] == 148) {
      robot.send({148, 1, 19});
      robot.to_tick();
      robot.send({150, 0});
    } else {
      robot.send(reading);
    }
    robot.wait(10ms);
    (void)robot.receive();
    EXPECT_EQ(word(robot.ask({142, 19}), 0), 0) << int{reading[0]} << ' ' << int{reading[1]};
  }
}

// The same motion read every tick by the two kinds of robot.
std::int32_t sum_of_distances(Remainder remainder) {
  Parameters parameters = ideal_wheels();
  parameters.remainder = remainder;
  Passive robot{parameters};
  robot.send({132, 145, 0, 100, 0, 100});
  std::int32_t sum = 0;
  for (int i = 0; i < 200; ++i) {
    robot.to_tick();
    sum += word(robot.ask({142, 19}), 0);
  }
  return sum;
}

TEST(Distance, AddsUpWhereTheRemainderIsCarried) {
  EXPECT_NEAR(sum_of_distances(Remainder::carried), 300, 2);
}

TEST(Distance, FallsShortWhereTheRemainderIsLost) {
  // 1.5 mm per tick, in counts of 0.13 mm: one remains each time.
  EXPECT_NEAR(sum_of_distances(Remainder::lost), 200, 4);
}

}  // namespace
}  // namespace cargobay::hal::sim
