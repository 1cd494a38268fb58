#include "hal/cli/view/drive_view.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "hal/sensing/events.hpp"
#include "oi/value_names.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

using hal::Hazard;

struct Named {
  Hazard hazard{};
  std::string_view text{};
};

std::string list(hal::Hazards hazards, std::initializer_list<Named> all) {
  std::string text;
  for (const Named& one : all) {
    if (hazards.has(one.hazard)) text += fmt::format("{}{}", text.empty() ? "" : ", ", one.text);
  }
  return text.empty() ? "none" : text;
}

ScreenText alarming(const std::string& text, int columns) {
  return {fitted(text, columns), text == "none" ? TextStyle::plain : TextStyle::alarm};
}

std::string bumps(hal::Bumps bumps) {
  const bool left = bumps.has(oi::Bump::bump_left);
  const bool right = bumps.has(oi::Bump::bump_right);
  if (left && right) return "left, right";
  if (left) return "left";
  return right ? "right" : "none";
}

constexpr int kHalf = 30;  // columns: two cells fit the smallest window

ScreenLine wheels(std::string_view what, const rt::WheelSpeeds& speeds) {
  return {{fmt::format("{:<12}{:>8.1f}{:>9.1f}  mm/s", what, speeds.left_mm_s, speeds.right_mm_s)}};
}

std::vector<ScreenLine> how_it_drives(const DrivePicture& picture) {
  const hal::CycleState& state = picture.state;
  std::string limits;
  for (const hal::Limit limit : {hal::Limit::speed, hal::Limit::acceleration}) {
    if (state.limits.has(limit))
      limits += fmt::format("{}{}", limits.empty() ? "" : ", ", hal::name(limit));
  }
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  return {{{fmt::format("{:<12}{:>8}{:>9}", "Wheels", "left", "right")}},
          wheels("  set", state.set),
          wheels("  measured", state.estimate),
          wheels("  command", state.command),
          {{fmt::format("Pose         x {:.3f} m, y {:.3f} m, {:.1f} deg; way {:.2f} m",
                        state.pose.x_mm / 1e3, state.pose.y_mm / 1e3,
                        state.pose.heading_rad * kDegrees, state.distance_mm / 1e3)}},
          {{fmt::format("Frames       {} good, {} bad, {} lost; held by {}", picture.frames.good,
                        picture.frames.bad, picture.frames.lost,
                        limits.empty() ? "nothing" : limits)}}};
}

}  // namespace

std::vector<ScreenLine> safety_lines(const hal::CycleState& state) {
  const bool driven = state.mode == oi::Mode::safe || state.mode == oi::Mode::full;
  const std::string battery =
      state.battery_mv == 0 ? "not known yet"
                            : fmt::format("{:.2f} V", static_cast<double>(state.battery_mv) / 1e3);
  const std::string drops = list(state.hazards, {{Hazard::wheel_drop_left, "left"},
                                                 {Hazard::wheel_drop_right, "right"},
                                                 {Hazard::wheel_drop_front, "front"}});
  const std::string cliffs = list(state.hazards, {{Hazard::cliff_left, "left"},
                                                  {Hazard::cliff_front_left, "front left"},
                                                  {Hazard::cliff_front_right, "front right"},
                                                  {Hazard::cliff_right, "right"}});
  return {{{"Mode         "},
           {fitted(std::string{oi::name(state.mode)}, kHalf - 13),
            driven ? TextStyle::good : TextStyle::alarm},
           {"Battery  " + battery}},
          {{"Bumps        "},
           alarming(bumps(state.bumps), kHalf - 13),
           {"Charger  "},
           alarming(list(state.hazards, {{Hazard::charger, "plugged in"}}), kHalf - 9)},
          {{"Wheel drops  "}, alarming(drops, kHalf)},
          {{"Cliffs       "}, alarming(cliffs, 2 * kHalf - 13)}};
}

std::vector<ScreenLine> drive_view(const DrivePicture& picture, const WindowSize& window) {
  const double time_s = static_cast<double>(picture.state.tick) * 0.015;
  std::vector<ScreenLine> lines{
      {{fitted(fmt::format("drive  {:.1f} of {:g} s  {}", time_s, picture.duration_s, picture.what),
               window.columns),
        TextStyle::title}}};
  for (ScreenLine& line : safety_lines(picture.state)) lines.push_back(std::move(line));
  for (ScreenLine& line : how_it_drives(picture)) lines.push_back(std::move(line));
  const auto room =
      static_cast<std::size_t>(std::max(window.rows - 1 - static_cast<int>(lines.size()), 0));
  std::vector<std::string> news = picture.events;
  news.insert(news.end(), picture.messages.begin(), picture.messages.end());
  if (news.size() > room) news.erase(news.begin(), news.end() - static_cast<std::ptrdiff_t>(room));
  for (std::string& line : news) lines.push_back({{std::move(line)}});
  lines.resize(static_cast<std::size_t>(std::max(window.rows - 1, 1)));
  lines.push_back({{"Ctrl-C stops the robot"}});
  return lines;
}

}  // namespace cargobay::cli
