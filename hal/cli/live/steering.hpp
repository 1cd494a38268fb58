// Steers through a feed: holds its lease, and renews the setpoint for as long as somebody wants the
// robot to move.
#pragma once

#include <cstdint>
#include <string>

#include "hal/cli/attached/feed_news.hpp"
#include "hal/feed/feed_reader.hpp"
#include "hal/feed/message/messages.hpp"
#include "hal/result.hpp"
#include "rt/clock.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::cli {

// One thread. Allocates. Sends ten setpoints a second while it holds the lease, standing ones too:
// if this process dies, hangs or is suspended, the last of them lapses and the robot stops.
class Steering {
 public:
  static constexpr rt::Duration kEvery = std::chrono::milliseconds{100};

  // `reader` and `news` outlive it.
  Steering(hal::FeedReader& reader, FeedNews& news);

  // Asks for the lease and waits up to 2 s for the answer: no if another has it, unless `take`.
  hal::Result<void> begin(bool take);
  // The same later, without waiting: the news will tell.
  hal::Result<void> ask_again(bool take);
  // Call it after all news and at least every kEvery. Sends a setpoint that has changed at once.
  hal::Result<void> steer(const rt::WheelSpeeds& speeds, rt::TimePoint now);
  // The robot stands, whoever steers it.
  hal::Result<void> stop();
  hal::Result<void> rearm();
  // Gives the lease back, and so the robot stops.
  void end();

  bool holds() const { return holds_; }
  const std::string& name() const { return name_; }
  // Why a request of late was refused; empty if none was within a second.
  std::string complaint(rt::TimePoint now) const;
  // Call it after each message that `news` has heard.
  void hear(hal::FeedType type);

 private:
  hal::Result<void> hold(bool take);

  hal::FeedReader& reader_;
  FeedNews& news_;
  std::string name_;
  bool holds_ = false;
  std::uint64_t lease_ = 0;  // the number of ours
  std::string complaint_{};
  rt::TimePoint complained_{};
  rt::WheelSpeeds sent_{};
  rt::TimePoint next_{};
};

}  // namespace cargobay::cli
