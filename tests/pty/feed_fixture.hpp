// A robot whose feed is read by the test, and whoever reads it.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "drive_fixture.hpp"
#include "hal/feed/feed_reader.hpp"

namespace cargobay::test {

using nlohmann::json;

// One who reads the feed.
class Watcher {
 public:
  explicit Watcher(const std::string& port) {
    EXPECT_TRUE(eventually([&] {
      auto attached = hal::FeedReader::attach(port);
      if (attached) reader_.emplace(std::move(*attached));
      return reader_.has_value();
    }));
  }
  // The next message for which `matches` is true; null after `wait`, or when the feed has ended.
  json next(const std::function<bool(const json&)>& matches,
            rt::Duration wait = std::chrono::seconds{10}) {
    const rt::TimePoint deadline = rt::Clock::now() + wait;
    while (reader_) {
      const auto line = reader_->next(deadline);
      if (!line || !*line) break;
      json message = json::parse(**line);
      if (matches(message)) return message;
    }
    return {};
  }
  json next(const std::string& type) {
    return next([&](const json& message) { return message["type"] == type; });
  }
  void tell(const json& request) {
    ASSERT_TRUE(reader_);
    EXPECT_TRUE(reader_->ask(request.dump()));
  }
  // The answer.
  json ask(json request) {
    request["id"] = ++asked_;
    tell(request);
    return next([&](const json& message) {
      return message["type"] == "answer" && message["id"] == asked_;
    });
  }
  // Steers for as long as `goes_on`.
  void drive_while(double speed_mm_s, const std::function<bool()>& goes_on) {
    while (goes_on()) {
      tell({{"do", "drive"}, {"left_mm_s", speed_mm_s}, {"right_mm_s", speed_mm_s}});
      (void)next("state");
    }
  }
  hal::FeedReader& reader() { return *reader_; }
  void go() { reader_.reset(); }

 private:
  std::optional<hal::FeedReader> reader_{};
  int asked_ = 0;
};

class FeedTest : public DriveTest {
 protected:
  std::vector<std::string> serve_command() const { return {"serve", "--port", port_, "--no-http"}; }
  // Once it is served.
  static void wait_until_served(Command& command) {
    ASSERT_TRUE(eventually([&] {
      (void)command.running();
      return command.out().find("serving ") != std::string::npos;
    })) << command.err();
  }
  // Within 10 s.
  bool comes_to_stand() const {
    return eventually([this] {
      return server_->snapshot().commanded == hal::sim::WheelSpeeds{} && stands_still();
    });
  }
  double left_mm_s() const { return server_->snapshot().truth.speeds.left_mm_s; }
  void drive_until_it_moves(Watcher& watcher) const {
    ASSERT_EQ(watcher.ask({{"do", "hold"}, {"name", "test"}})["ok"], true);
    int states = 0;
    watcher.drive_while(200.0, [&] { return left_mm_s() < 100.0 && ++states < 400; });
    ASSERT_GE(left_mm_s(), 100.0);
  }
};

}  // namespace cargobay::test
