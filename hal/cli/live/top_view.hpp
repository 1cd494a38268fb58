// The live picture of `cargobay top`, parts of which `cargobay teleop` shows too.
#pragma once

#include <string>
#include <vector>

#include "hal/cli/attached/feed_news.hpp"
#include "hal/cli/view/screen.hpp"

namespace cargobay::cli {

// Mode, battery, bumps, wheel drops, cliffs; each wheel's speeds; the pose and, of a virtual
// Create, the true one. One line says so while nothing is known. Not wider than 60 columns.
std::vector<ScreenLine> robot_lines(const FeedNews& news);

// Who steers, "nobody" at times; and what the robot's program is up to, if it does not drive it.
std::string steering_text(const FeedNews& news);

// The latest events and then the command's own messages, as many as fit so many lines.
std::vector<ScreenLine> news_lines(const FeedNews& news, const std::vector<std::string>& messages,
                                   int room);

// The histogram from its least to its largest value, on a logarithmic scale in both directions: one
// character per bucket, blank for nothing, `#` for the most. `columns` may be 0.
std::string sparkline(const hal::heard::Durations& durations, int columns);

// The whole of it, for any window: the robot, link and loop first; then events, the other sensors
// and bars of the histograms, as far as there is room. `messages` are the command's own.
std::vector<ScreenLine> top_view(const FeedNews& news, const std::vector<std::string>& messages,
                                 const WindowSize& window);

// One line, for terminals that can only print one line after the other.
std::string top_line(const FeedNews& news);

}  // namespace cargobay::cli
