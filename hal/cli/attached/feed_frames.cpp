#include "hal/cli/attached/feed_frames.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "oi/dialect.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr rt::Duration kFramePatience = std::chrono::milliseconds{100};

bool has_any(const oi::SensorValues& values, const std::vector<oi::PacketId>& packets) {
  return std::ranges::any_of(packets, [&](oi::PacketId packet) {
    return (oi::packet_bits(oi::kCreate.packet(packet)) & values.present()) != 0;
  });
}

}  // namespace

std::optional<FeedFrames> FeedFrames::attach(const std::string& port) {
  auto reader = hal::FeedReader::attach(port);
  if (!reader) return std::nullopt;
  FeedFrames frames{std::move(*reader)};
  const rt::TimePoint deadline = rt::Clock::now() + std::chrono::seconds{1};
  while (rt::Clock::now() < deadline) {
    const auto line = frames.reader_.next(deadline);
    if (!line || !*line) return std::nullopt;
    if (frames.news_.hear(**line) != hal::FeedType::hello) continue;
    if (!frames.reader_.ask(R"({"do":"subscribe","types":["sensors"]})")) return std::nullopt;
    return frames;
  }
  return std::nullopt;
}

hal::Result<std::optional<hal::SensorFrame>> FeedFrames::next(
    const std::vector<oi::PacketId>& packets) {
  const rt::TimePoint deadline = rt::Clock::now() + kFramePatience;
  for (;;) {
    const auto line = reader_.next(deadline);
    if (!line) return line.failure();
    if (!*line) return std::optional<hal::SensorFrame>{};
    if (news_.hear(**line) != hal::FeedType::sensors) continue;
    const hal::heard::Sensors& sensors = news_.sensors;
    if (sensors.tick == last_tick_ || !has_any(sensors.record.values, packets)) continue;
    return std::optional{frame()};
  }
}

hal::SensorFrame FeedFrames::frame() {
  const std::int64_t tick = news_.sensors.tick;
  const hal::SensorRecord& record = news_.sensors.record;
  if (last_tick_ < 0) {  // the first one
    seen_ = record;
  } else if (tick < last_tick_) {  // the robot came back, and counts from 0 again
    ticks_before_ += last_tick_ + 1;
    seen_ = {};
  } else {
    missed_ += tick - last_tick_ - 1;
  }
  last_tick_ = tick;
  sums_.values = record.values;
  sums_.arrival = rt::TimePoint{(ticks_before_ + tick) * oi::kTick};
  sums_.distance_mm += record.distance_sum_mm - seen_.distance_sum_mm;
  sums_.angle_deg += record.angle_sum_deg - seen_.angle_sum_deg;
  seen_ = record;
  return sums_;
}

std::string publisher(const FeedNews& news) {
  return fmt::format("{} (process {}) drives it", news.hello.program, news.hello.process);
}

}  // namespace cargobay::cli
