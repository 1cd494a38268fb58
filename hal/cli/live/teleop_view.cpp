#include "hal/cli/live/teleop_view.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "hal/cli/live/top_view.hpp"
#include "oi/command_table.hpp"

namespace cargobay::cli {
namespace {

ScreenLine who_steers(const TeleopPicture& picture, const FeedNews& news) {
  if (picture.holds) {
    return {{"You steer", TextStyle::good},
            {fmt::format(": {:.0f} mm/s; asked for {:.0f} and {:.0f}", picture.speed_mm_s,
                         picture.asked.left_mm_s, picture.asked.right_mm_s)}};
  }
  if (news.holder.empty())
    return {{"Nobody steers", TextStyle::strong}, {"; an arrow key takes over"}};
  const std::string other = news.holder == picture.name ? "Another " : "";
  return {{other + news.holder + " steers", TextStyle::alarm},
          {"; t takes it from them, space stops"}};
}

// Why nothing moves, and what to do about it.
ScreenLine advice(const TeleopPicture& picture, const FeedNews& news) {
  if (!picture.complaint.empty()) return {{picture.complaint, TextStyle::alarm}};
  const bool passive = news.state && news.state->mode != oi::Mode::safe &&
                       news.state->mode != oi::Mode::full && news.stage == "driving";
  if (passive) return {{"The robot left its mode; r goes back to it", TextStyle::alarm}};
  if (news.stage != "driving" && !news.text.empty()) return {{news.text, TextStyle::strong}};
  if (picture.gamepad.empty()) return {};
  if (picture.gamepad_is_silent)
    return {
        {"Gamepad: " + picture.gamepad + " is silent; move its stick to go on", TextStyle::alarm}};
  return {{"Gamepad: " + picture.gamepad + "; hold a shoulder button to move"}};
}

}  // namespace

std::vector<ScreenLine> teleop_view(const TeleopPicture& picture, const FeedNews& news,
                                    const std::vector<std::string>& messages,
                                    const WindowSize& window) {
  const std::string title = fmt::format(
      "teleop  {}{}, by {}", news.hello.robot == "virtual Create" ? "virtual Create on " : "",
      news.hello.port, news.hello.program);
  std::vector<ScreenLine> lines{{{fitted(title, window.columns), TextStyle::title}},
                                who_steers(picture, news),
                                advice(picture, news)};
  std::vector<ScreenLine> robot = robot_lines(news);
  std::move(robot.begin(), robot.end(), std::back_inserter(lines));
  std::vector<ScreenLine> events =
      news_lines(news, messages, window.rows - 1 - static_cast<int>(lines.size()));
  std::move(events.begin(), events.end(), std::back_inserter(lines));
  lines.resize(static_cast<std::size_t>(std::max(window.rows - 1, 1)));
  lines.push_back({{"arrows/WASD held: drive   space: stop   +/-: speed   q: end"}});
  return lines;
}

}  // namespace cargobay::cli
