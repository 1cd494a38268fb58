// The frames of a robot that another process drives, from its feed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hal/bring_up/sensor_stream.hpp"
#include "hal/cli/attached/feed_news.hpp"
#include "hal/columns/records.hpp"
#include "hal/feed/feed_reader.hpp"
#include "hal/result.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::cli {

// One thread. Allocates.
class FeedFrames {
 public:
  // Attaches to the feed of the port. Nothing if nothing publishes it, or its publisher is not to
  // be trusted: then the port itself says what is wrong. Blocks for up to a second.
  static std::optional<FeedFrames> attach(const std::string& port);

  // The next frame that has any of these packets, with what has been read of them so far; nothing
  // if none comes within 100 ms. Times are the robot's. The sums begin with 0 at the first frame;
  // they have the frames that did not come here too. Fails when the feed ends.
  hal::Result<std::optional<hal::SensorFrame>> next(const std::vector<oi::PacketId>& packets);

  const FeedNews& news() const { return news_; }
  // Frames of the robot that did not come here.
  std::int64_t missed() const { return missed_; }

 private:
  explicit FeedFrames(hal::FeedReader reader) : reader_{std::move(reader)} {}
  hal::SensorFrame frame();

  hal::FeedReader reader_;
  FeedNews news_{};
  hal::SensorFrame sums_{};
  hal::SensorRecord seen_{};  // the last
  std::int64_t last_tick_ = -1;
  std::int64_t ticks_before_ = 0;  // of links before this one
  std::int64_t missed_ = 0;
};

// "cargobay drive (process 123) drives it": whose feed it is.
std::string publisher(const FeedNews& news);

}  // namespace cargobay::cli
