// What some firmware has beyond the manual.
#include "oi/extensions.hpp"

#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

Parameters extended() {
  Parameters parameters = ideal_wheels();
  parameters.dialect = &oi::kCreateWithExtensions;
  return parameters;
}

TEST(Extensions, AreOffUnlessAskedFor) {
  Robot robot;
  robot.send({128});
  EXPECT_TRUE(robot.ask({149, 2, 43, 44}).empty());
  EXPECT_TRUE(robot.ask({8}).empty());
}

TEST(Extensions, AnswerWithRawCountsThatGoUpBothWays) {
  Robot robot{extended()};
  robot.send({128, 132, 145, 0, 100, 0xff, 0x9c});  // right 100 mm/s, left -100
  robot.wait(10s);
  robot.send({145, 0, 0, 0, 0});
  robot.to_tick();
  const Bytes counts = robot.ask({149, 2, 43, 44});
  ASSERT_EQ(counts.size(), 4U);
  EXPECT_NEAR(word(counts, 0), 7832, 30);
  EXPECT_NEAR(word(counts, 2), 7832, 30);
}

TEST(Extensions, WrapTheRawCounts) {
  Robot robot{extended()};
  robot.send({128, 132, 145, 1, 244, 1, 244});
  robot.wait(20s);  // 78324 counts
  robot.send({145, 0, 0, 0, 0});
  robot.to_tick();
  const Bytes counts = robot.ask({149, 1, 43});
  EXPECT_NEAR(word(counts, 0), 78324 - 65536, 100);
}

TEST(Extensions, StreamRawCounts) {
  Robot robot{extended()};
  robot.send({128, 148, 2, 43, 35});
  robot.to_tick();
  robot.wait(10ms);
  EXPECT_EQ(robot.receive().size(), 8U);
}

TEST(Extensions, AnswerOpcode8WithTheFirmwaresDate) {
  Robot robot{extended()};
  robot.send({128});
  const Bytes answer = robot.ask({8});
  const auto date = oi::parse_firmware_date(answer);
  ASSERT_TRUE(date);
  EXPECT_EQ(date->year, 7);
  EXPECT_EQ(date->month, 9);
  EXPECT_EQ(date->day, 24);
}

TEST(Extensions, AreNotOutOfRange) {
  Parameters parameters;
  parameters.dialect = &oi::kCreateWithExtensions;
  for (const bool known : {true, false}) {
    Robot robot{known ? parameters : Parameters{}};
    robot.send({128, 149, 2, 43, 44});
    EXPECT_EQ(robot.device.counters().commands_out_of_range, known ? 0U : 1U);
  }
}

}  // namespace
}  // namespace cargobay::hal::sim
