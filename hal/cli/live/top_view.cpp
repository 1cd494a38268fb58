#include "hal/cli/live/top_view.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "hal/bring_up/sensor_stream.hpp"
#include "hal/cli/view/drive_view.hpp"
#include "hal/cli/view/sensor_view.hpp"
#include "oi/limits.hpp"
#include "oi/packet_table.hpp"
#include "oi/value_names.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr double kNsPerMs = 1e6;

void append(std::vector<ScreenLine>& lines, std::vector<ScreenLine> more) {
  lines.insert(lines.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
}

ScreenLine wheel_line(const FeedNews& news, std::string_view name,
                      double rt::WheelSpeeds::* wheel) {
  std::string text = fmt::format("{:<7}set {:>6.1f}  measured {:>6.1f}", name,
                                 news.state->set.*wheel, news.state->estimate.*wheel);
  if (news.truth) text += fmt::format("  true {:>6.1f}", news.truth->wheels.*wheel);
  return {{text + " mm/s"}};
}

std::string pose_text(const rt::OdometryPose& pose) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  return fmt::format("x {:.3f} m, y {:.3f} m, {:.1f} deg", pose.x_mm / 1e3, pose.y_mm / 1e3,
                     pose.heading_rad * kDegrees);
}

std::string limits_text(hal::Limits limits) {
  std::string text;
  for (const hal::Limit limit : {hal::Limit::speed, hal::Limit::acceleration}) {
    if (limits.has(limit)) text += fmt::format("{}{}", text.empty() ? "" : ", ", hal::name(limit));
  }
  return text.empty() ? "nothing" : text;
}

ScreenLine duration_line(std::string_view name,
                         const std::optional<hal::heard::Durations>& durations, int columns) {
  if (!durations || durations->count == 0) return {{fmt::format("{:<8}not measured yet", name)}};
  std::string text = fmt::format("{:<8}p50 {:.3f}  p99 {:.3f}  max {:.3f} ms  ", name,
                                 durations->p50_ns / kNsPerMs, durations->p99_ns / kNsPerMs,
                                 durations->max_ns / kNsPerMs);
  constexpr int kMost = 60;
  const int room = std::min(columns - static_cast<int>(text.size()) - 2, kMost);
  if (room >= 6) text += "[" + sparkline(*durations, room) + "]";
  return {{text}};
}

std::vector<ScreenLine> loop_lines(const FeedNews& news, int columns) {
  const bool bad = news.statistics.frames.bad + news.statistics.frames.lost > 0;
  return {{{fmt::format("{:<8}", "Frames")},
           {fmt::format("{} good, {} bad, {} lost, {} late", news.statistics.frames.good,
                        news.statistics.frames.bad, news.statistics.frames.lost,
                        news.statistics.frames.late),
            bad ? TextStyle::strong : TextStyle::plain},
           {fmt::format("; {} unsent", news.statistics.unsent)}},
          duration_line("Period", news.statistics.period, columns),
          duration_line("Answer", news.statistics.frame_to_command, columns)};
}

// Those that the lines above do not show.
std::vector<oi::PacketId> other_sensors() {
  using enum oi::PacketId;
  std::vector<oi::PacketId> packets;
  for (std::uint8_t id = oi::kFirstSinglePacket; id <= oi::kLastPacket; ++id) {
    const auto packet = static_cast<oi::PacketId>(id);
    const bool shown = packet == bumps_and_wheel_drops || packet == oi_mode ||
                       (packet >= cliff_left && packet <= cliff_right) || packet == distance ||
                       packet == angle || packet == unused_15 || packet == unused_16;
    if (!shown) packets.push_back(packet);
  }
  return packets;
}

// Few buckets, in one line each.
std::vector<ScreenLine> bars(std::string_view name,
                             const std::optional<hal::heard::Durations>& durations, int columns) {
  std::vector<ScreenLine> lines;
  if (!durations || durations->histogram.empty()) return lines;
  constexpr std::size_t kMost = 8;
  const auto& all = durations->histogram;
  const std::size_t step = (all.size() + kMost - 1) / kMost;
  std::vector<std::pair<double, std::uint64_t>> few;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i % step == 0) few.emplace_back(0.0, 0);
    few.back().first = all[i].first;
    few.back().second += all[i].second;
  }
  const std::uint64_t most = std::max<std::uint64_t>(
      std::ranges::max_element(few, {}, &std::pair<double, std::uint64_t>::second)->second, 1);
  lines.push_back({{fmt::format("{}, up to", name), TextStyle::strong}});
  const int room = std::max(columns - 30, 1);
  for (const auto& [end_ns, count] : few) {
    const auto length = static_cast<std::size_t>(
        std::ceil(static_cast<double>(count) / static_cast<double>(most) * room));
    lines.push_back({{fmt::format("{:>10.3f} ms {:>10}  {}", end_ns / kNsPerMs, count,
                                  std::string(length, '#'))}});
  }
  return lines;
}

std::string title(const FeedNews& news) {
  const double time_s =
      news.state ? static_cast<double>(news.state->tick) * rt::seconds(oi::kTick) : 0.0;
  return fmt::format("top  {:.1f} s  {}{}, by {} ({})", time_s,
                     news.hello.robot == "virtual Create" ? "virtual Create on " : "",
                     news.hello.port, news.hello.program, news.hello.process);
}

}  // namespace

std::string sparkline(const hal::heard::Durations& durations, int columns) {
  std::string line(static_cast<std::size_t>(std::max(columns, 0)), ' ');
  if (line.empty() || durations.histogram.empty()) return line;
  const double first = std::log(std::max(durations.histogram.front().first, 1.0));
  const double last = std::log(std::max(durations.histogram.back().first, 1.0));
  std::vector<std::uint64_t> counts(line.size(), 0);
  for (const auto& [end_ns, count] : durations.histogram) {
    const double part =
        last > first ? (std::log(std::max(end_ns, 1.0)) - first) / (last - first) : 0.0;
    const double place = std::clamp(part, 0.0, 1.0) * static_cast<double>(line.size() - 1);
    counts[static_cast<std::size_t>(std::lround(place))] += count;
  }
  constexpr std::string_view kHeights = ".:-=+*#";
  const double most = std::log1p(static_cast<double>(std::ranges::max(counts)));
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (counts[i] == 0 || most <= 0.0) continue;
    const double height = std::log1p(static_cast<double>(counts[i])) / most;
    line[i] = kHeights[static_cast<std::size_t>(
        std::lround(height * static_cast<double>(kHeights.size() - 1)))];
  }
  return line;
}

std::string steering_text(const FeedNews& news) {
  const std::string by_lease = news.holder.empty() ? "nobody" : news.holder;
  std::string who = news.hello.steerable ? by_lease : news.hello.program;
  if (news.stage.empty() || news.stage == "driving") return who;
  return fmt::format("{}; {}: {}", who, news.stage, news.text);
}

std::vector<ScreenLine> robot_lines(const FeedNews& news) {
  if (!news.state) return {{{"The robot has not been heard yet: " + news.text}}};
  std::vector<ScreenLine> lines = safety_lines(*news.state);
  lines.push_back(wheel_line(news, "Left", &rt::WheelSpeeds::left_mm_s));
  lines.push_back(wheel_line(news, "Right", &rt::WheelSpeeds::right_mm_s));
  lines.push_back({{fmt::format("Pose   {}; way {:.2f} m", pose_text(news.state->pose),
                                news.state->distance_mm / 1e3)}});
  // In a world of its own coordinates: what they differ by is not an error.
  if (news.truth) lines.push_back({{"True   " + pose_text(news.truth->pose)}});
  return lines;
}

std::vector<ScreenLine> news_lines(const FeedNews& news, const std::vector<std::string>& messages,
                                   int room) {
  std::vector<std::string> all{news.events.begin(), news.events.end()};
  all.insert(all.end(), messages.begin(), messages.end());
  const auto most = static_cast<std::size_t>(std::max(room, 0));
  if (all.size() > most) all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(most));
  std::vector<ScreenLine> lines;
  lines.reserve(all.size());
  for (std::string& line : all) lines.push_back({{std::move(line)}});
  return lines;
}

std::vector<ScreenLine> top_view(const FeedNews& news, const std::vector<std::string>& messages,
                                 const WindowSize& window) {
  std::vector<ScreenLine> lines{{{fitted(title(news), window.columns), TextStyle::title}}};
  append(lines, robot_lines(news));
  append(lines, loop_lines(news, window.columns));
  lines.push_back({{fmt::format("{:<8}{}; held by {}", "Steers", steering_text(news),
                                news.state ? limits_text(news.state->limits) : "nothing")}});
  const auto room = [&] { return window.rows - 1 - static_cast<int>(lines.size()); };
  constexpr int kEvents = 4;
  const hal::SensorFrame frame{.values = news.sensors.record.values};
  std::vector<ScreenLine> sensors = sensor_lines(other_sensors(), frame, window.columns);
  if (room() >= kEvents + 1 + static_cast<int>(sensors.size())) {
    lines.emplace_back();
    append(lines, std::move(sensors));
  }
  for (const auto& [name, durations] :
       {std::pair{"Period", &news.statistics.period},
        std::pair{"Frame to command", &news.statistics.frame_to_command}}) {
    std::vector<ScreenLine> more = bars(name, *durations, window.columns);
    if (more.empty() || room() < kEvents + 1 + static_cast<int>(more.size())) continue;
    lines.emplace_back();
    append(lines, std::move(more));
  }
  if (room() > kEvents) lines.emplace_back();
  append(lines, news_lines(news, messages, room()));
  lines.resize(static_cast<std::size_t>(std::max(window.rows - 1, 1)));
  std::string last = "q ends it";
  if (news.missed > 0) last += fmt::format("; {} messages missed", news.missed);
  lines.push_back({{last}});
  return lines;
}

std::string top_line(const FeedNews& news) {
  if (!news.state) return "nothing heard yet: " + news.text;
  const hal::CycleState& state = *news.state;
  return fmt::format(
      "{:.1f} s  {}  set {:.0f} {:.0f}  measured {:.0f} {:.0f} mm/s  {}  {} mV  frames {} bad, {} "
      "lost  steered by {}",
      static_cast<double>(state.tick) * rt::seconds(oi::kTick), oi::name(state.mode),
      state.set.left_mm_s, state.set.right_mm_s, state.estimate.left_mm_s,
      state.estimate.right_mm_s, pose_text(state.pose), state.battery_mv,
      news.statistics.frames.bad, news.statistics.frames.lost, steering_text(news));
}

}  // namespace cargobay::cli
