#include "hal/cli/live/top_view.hpp"

#include <algorithm>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/cli/live/teleop_view.hpp"

namespace cargobay::cli {
namespace {

using testing::HasSubstr;

// As a terminal of that width shows it.
std::string shown(const std::vector<ScreenLine>& lines, int columns) {
  std::string all;
  for (const ScreenLine& line : lines) {
    std::string text;
    for (const ScreenText& part : line) text += part.text;
    text.resize(std::min(text.size(), static_cast<std::size_t>(columns)));
    all += text + '\n';
  }
  return all;
}

FeedNews full_news() {
  FeedNews news;
  news.hello = {.program = "cargobay serve",
                .port = "/dev/ttyUSB0",
                .robot = "virtual Create",
                .process = 1234,
                .baud = 57600,
                .steerable = true,
                .max_speed_mm_s = 500.0};
  news.stage = "driving";
  news.holder = "page on phone";
  news.state.emplace();
  news.state->mode = oi::Mode::safe;
  news.state->set = {.left_mm_s = -500.0, .right_mm_s = -500.0};
  news.state->estimate = {.left_mm_s = -499.9, .right_mm_s = -499.9};
  news.truth = hal::heard::Truth{.pose = {.x_mm = 500.0, .y_mm = 1500.0},
                                 .wheels = {.left_mm_s = -498.8, .right_mm_s = -498.8}};
  news.statistics.frames = {.good = 123'456, .bad = 12, .lost = 34, .late = 56};
  news.statistics.period = hal::heard::Durations{.count = 10,
                                                 .p50_ns = 15e6,
                                                 .p99_ns = 16e6,
                                                 .max_ns = 38.1e6,
                                                 .histogram = {{14e6, 2}, {15e6, 5}, {38e6, 3}}};
  for (int i = 0; i < 50; ++i) news.events.push_back("  1.0 s  event " + std::to_string(i));
  for (std::uint8_t id = oi::kFirstSinglePacket; id <= oi::kLastPacket; ++id)
    news.sensors.record.values.set(static_cast<oi::PacketId>(id), 0);
  return news;
}

TEST(TopView, HasWhatMattersInTheSmallestWindow) {
  const auto lines = top_view(full_news(), {}, {.rows = 15, .columns = 60});
  EXPECT_EQ(lines.size(), 15U);
  const std::string all = shown(lines, 60);
  for (const char* const wanted : {"Mode         safe", "true -498.8 mm/s", "34 lost", "p99 16.000",
                                   "page on phone", "event 49", "q ends it"})
    EXPECT_THAT(all, HasSubstr(wanted));
}

TEST(TopView, FillsAnyWindowAndNoMore) {
  for (int rows = 1; rows <= 70; ++rows) {
    for (const int columns : {1, 20, 60, 80, 200}) {
      const auto lines = top_view(full_news(), {"a message"}, {.rows = rows, .columns = columns});
      EXPECT_LE(lines.size(), static_cast<std::size_t>(std::max(rows, 2)));
    }
  }
  const std::string large = shown(top_view(full_news(), {}, {.rows = 60, .columns = 100}), 100);
  EXPECT_THAT(large, HasSubstr("True   x 0.500 m, y 1.500 m, 0.0 deg"));
  EXPECT_THAT(large, HasSubstr("signal L 0"));
  EXPECT_THAT(large, HasSubstr("38.000 ms"));
  EXPECT_THAT(large, HasSubstr("event 49"));
}

TEST(TopView, SaysSoWhileNothingIsKnown) {
  FeedNews news;
  news.text = "the robot is brought up";
  EXPECT_THAT(shown(top_view(news, {}, {.rows = 15, .columns = 60}), 60),
              HasSubstr("not been heard yet: the robot"));
  EXPECT_THAT(top_line(news), HasSubstr("brought up"));
}

TEST(Sparkline, ShowsWhereAndHowOften) {
  const hal::heard::Durations durations{.count = 1002,
                                        .histogram = {{1e3, 1}, {1e4, 1000}, {1e6, 1}}};
  const std::string line = sparkline(durations, 31);
  ASSERT_EQ(line.size(), 31U);
  EXPECT_EQ(line[10], '#') << line << ": a third of the way, on a logarithmic scale";
  EXPECT_EQ(std::ranges::count(line, ' '), 28) << line;
  EXPECT_EQ(sparkline(durations, 0), "");
  EXPECT_EQ(sparkline({}, 3), "   ");
  EXPECT_EQ(sparkline({.histogram = {{5e3, 7}}}, 3), "#  ") << "a single value";
}

TEST(TeleopView, SaysWhoSteersAndWhyNothingMoves) {
  FeedNews news = full_news();
  const WindowSize window{.rows = 15, .columns = 60};
  const auto picture = [&](const TeleopPicture& of) {
    return shown(teleop_view(of, news, {}, window), 60);
  };
  EXPECT_THAT(picture({.holds = true, .speed_mm_s = 200.0}), HasSubstr("You steer: 200 mm/s"));
  EXPECT_THAT(picture({}), HasSubstr("page on phone steers; t takes it"));
  EXPECT_THAT(picture({.name = "page on phone"}), HasSubstr("Another page on phone steers; t"));
  EXPECT_THAT(picture({.complaint = "no robot"}), HasSubstr("no robot"));
  news.state->mode = oi::Mode::passive;
  EXPECT_THAT(picture({.holds = true}), HasSubstr("r goes back to it"));
  news.holder.clear();
  EXPECT_THAT(picture({}), HasSubstr("Nobody steers"));
  EXPECT_THAT(picture({}), HasSubstr("q: end")) << "is cut off";
}

}  // namespace
}  // namespace cargobay::cli
