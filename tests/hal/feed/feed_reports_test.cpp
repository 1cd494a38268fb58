// What is told of a robot, and what was gone before it could be told.
#include "hal/feed/feed_reports.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace cargobay::hal {
namespace {

using nlohmann::json;

class FeedReportsTest : public testing::Test {
 protected:
  void drive(int states) const {
    const StateObserver observer = tap_->observer();
    for (int i = 0; i < states; ++i) observer.function(observer.context, {.tick = i});
  }
  void note(int events) const {
    const StateObserver observer = tap_->observer();
    for (int i = 0; i < events; ++i)
      observer.event(observer.context, {.what = EventKind::bump_began, .tick = i});
  }
  void collect() { reports_.collect(nullptr, {}, rt::TimePoint{}, outlet_); }

  std::unique_ptr<FeedTap> tap_ = std::make_unique<FeedTap>();
  FeedReports reports_{{.tap = tap_.get(), .wheel_base_mm = 258.0}};
  std::map<FeedType, std::vector<json>> told_{};
  std::map<FeedType, std::uint64_t> lost_{};
  FeedOutlet outlet_{
      .begin = [](FeedType type) { return message(type, 1); },
      .tell = [this](FeedType type,
                     JsonObject message) { told_[type].push_back(json::parse(message.take())); },
      .lost = [this](FeedType type, std::uint64_t count) { lost_[type] += count; }};
};

TEST_F(FeedReportsTest, TellEachStateAndEventOnce) {
  drive(FeedTap::kStates);
  note(3);
  collect();
  collect();
  EXPECT_EQ(told_[FeedType::state].size(), FeedTap::kStates);
  EXPECT_EQ(told_[FeedType::event].size(), 3U);
  EXPECT_TRUE(lost_.empty());
}

TEST_F(FeedReportsTest, CountWhatWasOverwrittenMeanwhile) {
  drive(1);
  note(1);
  collect();
  constexpr int kMore = static_cast<int>(FeedTap::kStates) + 44;
  drive(kMore);
  note(static_cast<int>(kMostEvents) + 7);
  collect();
  EXPECT_EQ(told_[FeedType::state].size(), 1 + FeedTap::kStates);
  EXPECT_EQ(lost_[FeedType::state], 44U);
  EXPECT_EQ(told_[FeedType::event].size() + lost_[FeedType::event], 1 + kMostEvents + 7);
  EXPECT_GT(lost_[FeedType::event], 0U);
}

TEST_F(FeedReportsTest, CountNothingThatNobodyWaitedFor) {
  drive(2 * static_cast<int>(FeedTap::kStates));
  reports_.skip();
  drive(1);
  collect();
  EXPECT_EQ(told_[FeedType::state].size(), 1U);
  EXPECT_TRUE(lost_.empty());
}

}  // namespace
}  // namespace cargobay::hal
