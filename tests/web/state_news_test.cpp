#include "hal/web/state_news.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

namespace web = cargobay::web;

constexpr const char* kDriving = R"({"type":"status","seq":1,"stage":"driving","text":"it runs"})";
constexpr const char* kLost = R"({"type":"status","seq":9,"stage":"lost","text":"no frame came"})";

std::string state(int tick) {
  return R"({"type":"state","seq":2,"tick":)" + std::to_string(tick) + "}";
}

TEST(StateNews, HasTheNewestState) {
  web::StateNews news;
  EXPECT_EQ(news.newest().json, "");
  news.begin("just attached");
  EXPECT_EQ(news.newest().reason, "just attached");
  news.hear(kDriving);
  EXPECT_EQ(news.newest().json, "");
  news.hear(state(1));
  news.hear(state(2));
  EXPECT_EQ(news.newest().json, state(2));
}

TEST(StateNews, HasNoneOfALoopThatHasEnded) {
  web::StateNews news;
  news.hear(kDriving);
  news.hear(state(7));
  news.hear(kLost);
  EXPECT_EQ(news.newest().json, "");
  EXPECT_EQ(news.newest().reason, "no frame came");
  news.hear(state(8));  // of before: the feed tells its last states after that
  EXPECT_EQ(news.newest().json, "");
  news.hear(kDriving);
  EXPECT_EQ(news.newest().json, "");
  news.hear(state(0));
  EXPECT_EQ(news.newest().json, state(0));
}

TEST(StateNews, SaysWhyWithoutALoop) {
  web::StateNews news;
  news.hear(R"({"type":"status","seq":1,"stage":"bring_up","text":""})");
  news.hear(state(7));  // of the loop before
  EXPECT_EQ(news.newest().json, "");
  EXPECT_NE(news.newest().reason, "");
  news.hear("not a message");
  EXPECT_NE(news.newest().reason, "");
}

}  // namespace
