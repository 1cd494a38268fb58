#include "hal/cli/attached/feed_news.hpp"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/json_object.hpp"

namespace cargobay::cli {
namespace {

using testing::HasSubstr;

std::string line(hal::FeedType type, const std::string& members) {
  return fmt::format(R"({{"type":"{}","seq":1{}}})", hal::name(type), members);
}

TEST(FeedNews, TakesAStateAsTheFeedMakesIt) {
  hal::CycleState state;
  state.tick = 100;
  state.mode = oi::Mode::safe;
  state.set = {.left_mm_s = 10.5, .right_mm_s = -20.25};
  state.estimate = {.left_mm_s = 9.0, .right_mm_s = -19.0};
  state.command = {.left_mm_s = 11.0, .right_mm_s = -21.0};
  state.hazards = hal::Hazards{}.with(hal::Hazard::cliff_left).with(hal::Hazard::charger);
  state.limits = hal::Limits{}.with(hal::Limit::acceleration);
  state.bumps = hal::Bumps{}.with(oi::Bump::bump_left);
  state.battery_mv = 15'600;
  state.distance_mm = 123.5;
  state.pose = {.x_mm = 1.0, .y_mm = 2.0, .heading_rad = 0.5};
  state.pose_covariance.xy = -0.25;
  hal::JsonObject message = hal::message(hal::FeedType::state, 7);
  hal::put_state(message, {.stamp = {.unix_ns = 1'000'500'000'000}, .state = state});
  FeedNews news;
  ASSERT_EQ(news.hear(message.take()), hal::FeedType::state);
  ASSERT_TRUE(news.state);
  EXPECT_EQ(news.state->tick, 100);
  EXPECT_EQ(news.state->mode, oi::Mode::safe);
  EXPECT_EQ(news.state->set, state.set);
  EXPECT_EQ(news.state->estimate, state.estimate);
  EXPECT_EQ(news.state->command, state.command);
  EXPECT_EQ(news.state->hazards, state.hazards);
  EXPECT_EQ(news.state->limits, state.limits);
  EXPECT_EQ(news.state->bumps, state.bumps);
  EXPECT_EQ(news.state->battery_mv, 15'600);
  EXPECT_EQ(news.state->distance_mm, 123.5);
  EXPECT_EQ(news.state->pose.heading_rad, 0.5);
  EXPECT_EQ(news.state->pose_covariance.xy, -0.25);
  EXPECT_EQ(news.state_unix_ns, 1'000'500'000'000);
}

TEST(FeedNews, KnowsOnlyThePacketsThatWereRead) {
  FeedNews news;
  ASSERT_TRUE(
      news.hear(line(hal::FeedType::sensors, R"(,"tick":5,"distance":-3,"voltage":15000)")));
  EXPECT_EQ(news.sensors.tick, 5);
  EXPECT_EQ(news.sensors.record.values.raw(oi::PacketId::distance), -3);
  EXPECT_TRUE(news.sensors.record.values.has(oi::PacketId::voltage));
  EXPECT_FALSE(news.sensors.record.values.has(oi::PacketId::wall_signal));
}

TEST(FeedNews, KeepsTheLatestEvents) {
  FeedNews news;
  for (std::size_t i = 0; i < FeedNews::kMostEvents + 10; ++i) {
    (void)news.hear(
        line(hal::FeedType::event, fmt::format(R"(,"robot_time_s":{},"text":"event {}")", i, i)));
  }
  EXPECT_EQ(news.events.size(), FeedNews::kMostEvents);
  EXPECT_THAT(news.events.back(), HasSubstr("event 209"));
  EXPECT_THAT(news.events.front(), HasSubstr("event 10"));
}

TEST(FeedNews, TellsWhoSteersAndWhatWasMissed) {
  FeedNews news;
  (void)news.hear(line(hal::FeedType::holder, R"(,"name":"page","lease":3)"));
  EXPECT_EQ(news.holder, "page");
  EXPECT_EQ(news.lease, 3U);
  (void)news.hear(line(hal::FeedType::holder, R"(,"name":null,"lease":null)"));
  EXPECT_EQ(news.holder, "");
  EXPECT_EQ(news.lease, 0U);
  (void)news.hear(line(hal::FeedType::missed, R"(,"messages":3)"));
  (void)news.hear(line(hal::FeedType::missed, R"(,"messages":4)"));
  EXPECT_EQ(news.missed, 7U);
  (void)news.hear(R"({"type":"answer","id":"hold","ok":false,"error":"no"})");
  EXPECT_EQ(news.answer.id, R"("hold")");
  EXPECT_FALSE(news.answer.ok);
  EXPECT_EQ(news.answer.error, "no");
}

TEST(FeedNews, LeavesWhatItDoesNotUnderstand) {
  FeedNews news;
  (void)news.hear(line(hal::FeedType::status, R"(,"stage":"driving","text":"it drives")"));
  for (const char* const odd :
       {"", "{", "[]", "7", "null", R"({"type":7})", R"({"type":"news"})", R"({"seq":1})"})
    EXPECT_EQ(news.hear(odd), std::nullopt) << odd;
  (void)news.hear(line(hal::FeedType::status, R"(,"stage":7,"text":["a"])"));
  EXPECT_EQ(news.stage, "driving");
  (void)news.hear(
      line(hal::FeedType::state, R"(,"mode":7,"pose":[],"hazards":{"a":1},"tick":"x")"));
  (void)news.hear(
      line(hal::FeedType::statistics, R"(,"frames":[],"period_ns":{"histogram":[[1]]})"));
  (void)news.hear(line(hal::FeedType::sensors, R"(,"distance":"far","angle":1.5)"));
  EXPECT_EQ(news.sensors.record.values.present(), 0U);
  ASSERT_TRUE(news.statistics.period);
  EXPECT_TRUE(news.statistics.period->histogram.empty());
}

}  // namespace
}  // namespace cargobay::cli
