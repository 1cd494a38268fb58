// Messages for Foxglove, each as its schema says.
#include "hal/export/foxglove_schemas.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace cargobay::hal {
namespace {

using nlohmann::json;

constexpr std::int64_t kTime = 1'700'000'000'000'000'005;
constexpr rt::OdometryPose kPose{1000.0, -500.0, std::numbers::pi / 2.0};

// What a schema requires, a message has; and it has nothing else.
void expect_follows(const json& message, const json& schema) {
  if (schema.contains("oneOf")) return;
  if (schema.at("type") == "array") {
    for (const json& each : message) expect_follows(each, schema.at("items"));
    return;
  }
  if (schema.at("type") != "object") {
    const bool fits = schema.at("type") == "string" ? message.is_string() : message.is_number();
    EXPECT_TRUE(fits) << message;
    return;
  }
  EXPECT_EQ(message.size(), schema.at("properties").size());
  for (const auto& [name, member] : schema.at("properties").items()) {
    ASSERT_TRUE(message.contains(name)) << name;
    expect_follows(message.at(name), member);
  }
}

json checked(const std::string& message, const FoxgloveSchema& schema) {
  const json parsed = json::parse(message);
  const json definition = json::parse(schema.json);
  EXPECT_EQ(definition.at("title"), schema.name);
  expect_follows(parsed, definition);
  EXPECT_EQ(parsed.at("timestamp"), (json{{"sec", 1'700'000'000}, {"nsec", 5}}));
  return parsed;
}

TEST(FoxgloveMessages, HaveThePoseInMetresAndAsAQuaternion) {
  std::string text;
  append_pose_in_frame(text, kTime, kPose);
  const json message = checked(text, pose_in_frame_schema());
  const json& pose = message.at("pose");
  EXPECT_DOUBLE_EQ(pose.at("position").at("x").get<double>(), 1.0);
  EXPECT_DOUBLE_EQ(pose.at("position").at("y").get<double>(), -0.5);
  EXPECT_NEAR(pose.at("orientation").at("z").get<double>(), std::numbers::sqrt2 / 2.0, 1e-12);
  EXPECT_NEAR(pose.at("orientation").at("w").get<double>(), std::numbers::sqrt2 / 2.0, 1e-12);
}

TEST(FoxgloveMessages, HaveTheRobotInTheFrameOfTheOdometry) {
  std::string text;
  append_frame_transform(text, kTime, kPose);
  const json message = checked(text, frame_transform_schema());
  EXPECT_EQ(message.at("parent_frame_id"), "odom");
  EXPECT_EQ(message.at("child_frame_id"), "base_link");
  EXPECT_DOUBLE_EQ(message.at("translation").at("x").get<double>(), 1.0);
}

TEST(FoxgloveMessages, HaveTheWay) {
  std::string text;
  append_poses_in_frame(text, kTime, std::vector{kPose, rt::OdometryPose{}});
  EXPECT_EQ(checked(text, poses_in_frame_schema()).at("poses").size(), 2U);
  text.clear();
  append_poses_in_frame(text, kTime, {});
  EXPECT_TRUE(checked(text, poses_in_frame_schema()).at("poses").empty());
}

TEST(FoxgloveMessages, HaveEventsInWordsAndHowBadTheyAre) {
  std::string text;
  append_log(text, kTime, {.what = EventKind::mode_lost, .mode = oi::Mode::passive});
  const json message = checked(text, log_schema());
  EXPECT_EQ(message.at("level"), 4);
  EXPECT_EQ(message.at("name"), "mode_lost");
  EXPECT_EQ(message.at("message"),
            "the robot went to passive mode by itself, and no sensor says why");
  text.clear();
  append_log(text, kTime, {.what = EventKind::bump_ended});
  EXPECT_EQ(checked(text, log_schema()).at("level"), 2);
}

TEST(WaySoFar, KeepsWithinItsBoundAndHasBothEnds) {
  WaySoFar way;
  for (int i = 0; i <= 100000; ++i) way.add({.x_mm = 3.0 * i});
  EXPECT_LE(way.poses().size(), 256U);
  EXPECT_GE(way.poses().size(), 100U);
  EXPECT_EQ(way.poses().front().x_mm, 0.0);
  EXPECT_EQ(way.poses().back().x_mm, 300000.0);
}

TEST(WaySoFar, DoesNotGrowWhileTheRobotStands) {
  WaySoFar way;
  for (int i = 0; i < 1000; ++i) way.add({.x_mm = 1.0});
  EXPECT_LE(way.poses().size(), 2U);
}

}  // namespace
}  // namespace cargobay::hal
