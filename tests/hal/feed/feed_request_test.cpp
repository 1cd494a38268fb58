// What a reader may ask, and what is said of everything else.
#include "hal/feed/feed_request.hpp"

#include <string>
#include <string_view>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using testing::HasSubstr;

Result<FeedRequest::What> request_of(std::string_view line) {
  std::string id;
  return parse_request(line, id);
}

template <typename Kind>
Kind wanted(std::string_view line) {
  const auto what = request_of(line);
  if (!what) ADD_FAILURE() << what.failure().message;
  if (!what || !std::holds_alternative<Kind>(*what)) return {};
  return std::get<Kind>(*what);
}

TEST(FeedRequest, DrivesByWheelsOrByTwist) {
  const auto wheels =
      wanted<feed_request::DriveWheels>(R"({"do":"drive","left_mm_s":100,"right_mm_s":-200.5})");
  EXPECT_EQ(wheels.speeds, (rt::WheelSpeeds{100, -200.5}));
  const auto twist = wanted<feed_request::DriveTwist>(
      R"({"do":"drive","velocity_mm_s":150,"turn_rate_rad_s":0.5})");
  EXPECT_EQ(twist.twist.velocity_mm_s, 150);
  EXPECT_EQ(twist.twist.turn_rate_rad_s, 0.5);
}

TEST(FeedRequest, KnowsTheRest) {
  const auto hold = wanted<feed_request::Hold>(R"({"do":"hold","name":"ann","take":true})");
  EXPECT_EQ(hold.name, "ann");
  EXPECT_TRUE(hold.take);
  EXPECT_FALSE(wanted<feed_request::Hold>(R"({"do":"hold","name":"bob"})").take);
  EXPECT_EQ(wanted<feed_request::Hold>(R"({"do":"hold","name":"Zo\u00eb \u00a0"})").name,
            "Zo\xC3\xAB \xC2\xA0");
  (void)wanted<feed_request::Release>(R"({"do":"release"})");
  (void)wanted<feed_request::Stop>(R"({"do":"stop"})");
  (void)wanted<feed_request::Rearm>(R"({"do":"rearm"})");
  const auto pose = wanted<feed_request::ResetOdometry>(
      R"({"do":"reset_odometry","x_mm":1,"y_mm":2,"heading_rad":3})");
  EXPECT_EQ(pose.pose.y_mm, 2);
  EXPECT_EQ(wanted<feed_request::Send>(R"({"do":"send","command":"leds play 0 255"})").command,
            "leds play 0 255");
  EXPECT_EQ(wanted<feed_request::Control>(R"({"do":"control","line":"bump left"})").line,
            "bump left");
}

TEST(FeedRequest, SubscribesToTypesAndToOneInSoMany) {
  const auto wish =
      wanted<feed_request::Subscribe>(R"({"do":"subscribe","types":["state","truth"],"every":5})");
  EXPECT_EQ(wish.choice.every, 5U);
  const auto has = [&](FeedType type) {
    return wish.choice.types.test(static_cast<std::size_t>(type));
  };
  EXPECT_TRUE(has(FeedType::state));
  EXPECT_TRUE(has(FeedType::event)) << "news come in any case";
  EXPECT_FALSE(has(FeedType::sensors));
  EXPECT_TRUE(wanted<feed_request::Subscribe>(R"({"do":"subscribe"})").choice.types.all());
}

TEST(FeedRequest, KeepsTheIdentityOfWhatItCannotDo) {
  std::string id;
  EXPECT_FALSE(parse_request(R"({"id":"a\"b","do":"fly"})", id));
  EXPECT_EQ(id, R"("a\"b")");
  EXPECT_FALSE(parse_request(R"({"id":17,"do":"hold"})", id));
  EXPECT_EQ(id, "17");
}

struct Wrong {
  const char* line;
  const char* said;
};
class WrongFeedRequest : public testing::TestWithParam<Wrong> {};

TEST_P(WrongFeedRequest, IsRefusedWithWhatWouldBeRight) {
  const auto what = request_of(GetParam().line);
  ASSERT_FALSE(what) << GetParam().line;
  EXPECT_THAT(what.failure().message, HasSubstr(GetParam().said));
}

INSTANTIATE_TEST_SUITE_P(
    Each, WrongFeedRequest,
    testing::Values(Wrong{"", "not a JSON object"}, Wrong{"drive 100 100", "not a JSON object"},
                    Wrong{"[1,2]", "not a JSON object"},
                    Wrong{R"({"do":"drive")", "not a JSON object"},
                    Wrong{"{\"do\":\"stop\xff\"}", "not a JSON object"},
                    Wrong{"{}", "`do` must be a text"}, Wrong{R"({"do":7})", "`do` must be a text"},
                    Wrong{R"({"do":"fly"})", "there are subscribe, hold"},
                    Wrong{R"({"id":{},"do":"stop"})", "`id` must be"},
                    Wrong{R"({"do":"drive"})", "`velocity_mm_s` must be a number"},
                    Wrong{R"({"do":"drive","left_mm_s":100})", "`right_mm_s` must be a number"},
                    Wrong{R"({"do":"drive","left_mm_s":"100","right_mm_s":1})",
                          "`left_mm_s` must be a number"},
                    Wrong{R"({"do":"drive","left_mm_s":1e999,"right_mm_s":1})", ""},
                    Wrong{R"({"do":"hold","name":""})", "`name` must be a text of 1 to 64 bytes"},
                    Wrong{R"({"do":"hold","name":"x","take":1})", "`take` must be true or false"},
                    Wrong{R"({"do":"hold","name":"\u001b[2J"})", "without control characters"},
                    Wrong{R"({"do":"hold","name":"a\nb"})", "without control characters"},
                    Wrong{R"({"do":"hold","name":"\u009b2J"})", "without control characters"},
                    Wrong{R"({"do":"subscribe","types":["stat"]})", "`types` must be a list"},
                    Wrong{R"({"do":"subscribe","types":"state"})", "`types` must be a list"},
                    Wrong{R"({"do":"subscribe","every":0})", "`every` must be a number from 1"},
                    Wrong{R"({"do":"control"})", "`line` must be a text"}));

}  // namespace
}  // namespace cargobay::hal
