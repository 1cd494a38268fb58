// What a reader of a feed is answered, and what ends the lease.
#include "hal/feed/feed_desk.hpp"

#include <chrono>
#include <string>
#include <string_view>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace cargobay::hal {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class FeedDeskTest : public testing::Test {
 protected:
  json say(std::string_view line) {
    const auto answer = desk_.hear(client_, line, now_);
    return answer ? json::parse(*answer) : json{};
  }

  int stops_ = 0;
  int drives_ = 0;
  int resets_ = 0;
  FeedDesk desk_{{.drive =
                      [this](const rt::WheelSpeeds&) {
                        ++drives_;
                        return Result<void>{};
                      },
                  .stop = [this] { ++stops_; },
                  .rearm = [] { return Result<void>{}; },
                  .reset_odometry =
                      [this](const rt::OdometryPose&) {
                        ++resets_;
                        return Result<void>{};
                      },
                  .send = [](std::string_view) { return Result<void>{}; }},
                 258.0};
  FeedConnection client_{Descriptor{}, 1, {}};
  rt::TimePoint now_{};
};

TEST_F(FeedDeskTest, AnswersWhatItDoesNotUnderstand) {
  for (const char* const line : {"", " ", "x", "{}", "[]"}) {
    const json answer = say(line);
    EXPECT_EQ(answer["type"], "answer") << line;
    EXPECT_EQ(answer["ok"], false) << line;
    EXPECT_TRUE(answer["id"].is_null()) << line;
  }
}

TEST_F(FeedDeskTest, AnswersWhatWasDoneOnlyIfAsked) {
  EXPECT_TRUE(say(R"({"do":"subscribe"})").is_null());
  EXPECT_EQ(say(R"({"do":"subscribe","id":"a"})"),
            (json{{"type", "answer"}, {"id", "a"}, {"ok", true}}));
}

TEST_F(FeedDeskTest, TakesThePosesOfTheCApi) {
  ASSERT_EQ(say(R"({"do":"hold","name":"ann","id":1})")["ok"], true);
  for (const char* const pose :
       {R"("x_mm":1.1e9,"y_mm":0,"heading_rad":0)", R"("x_mm":0,"y_mm":-1e300,"heading_rad":0)",
        R"("x_mm":0,"y_mm":0,"heading_rad":1.1e6)"}) {
    const json answer = say(std::string{R"({"do":"reset_odometry",)"} + pose + "}");
    EXPECT_THAT(answer["error"].get<std::string>(), HasSubstr("-1e9 to 1e9"));
  }
  EXPECT_EQ(resets_, 0);
  (void)say(R"({"do":"reset_odometry","x_mm":1e9,"y_mm":-1e9,"heading_rad":1e6})");
  EXPECT_EQ(resets_, 1);
}

TEST_F(FeedDeskTest, SaysWhichLeaseItGives) {
  const json first = say(R"({"do":"hold","name":"ann","id":1})");
  EXPECT_EQ(first["result"]["lease"], desk_.lease().number());
  EXPECT_EQ(say(R"({"do":"hold","name":"ann","id":2})")["result"], first["result"]);
  (void)say(R"({"do":"stop"})");
  EXPECT_NE(say(R"({"do":"hold","name":"ann","id":3})")["result"], first["result"]);
}

TEST_F(FeedDeskTest, StopsWhenTheLeaseLapses) {
  ASSERT_EQ(say(R"({"do":"hold","name":"ann","id":1})")["ok"], true);
  (void)say(R"({"do":"drive","left_mm_s":100,"right_mm_s":100})");
  EXPECT_EQ(drives_, 1);
  const int before = stops_;
  now_ += FeedDesk::kLease - std::chrono::milliseconds{1};
  desk_.expire(now_);
  EXPECT_EQ(stops_, before);
  now_ += std::chrono::milliseconds{1};
  desk_.expire(now_);
  EXPECT_EQ(stops_, before + 1);
  EXPECT_EQ(say(R"({"do":"drive","left_mm_s":100,"right_mm_s":100})")["ok"], false);
  EXPECT_EQ(drives_, 1);
}

}  // namespace
}  // namespace cargobay::hal
