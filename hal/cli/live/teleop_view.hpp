// The live picture of `cargobay teleop`.
#pragma once

#include <string>
#include <vector>

#include "hal/cli/attached/feed_news.hpp"
#include "hal/cli/view/screen.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::cli {

struct TeleopPicture {
  bool holds = false;  // this command steers
  std::string name{};  // under which it does
  double speed_mm_s = 0.0;
  rt::WheelSpeeds asked{};
  std::string complaint{};  // why the robot does not do as it is told; may be empty
  std::string gamepad{};    // its name; empty if none is used
  bool gamepad_is_silent = false;
};

// Who steers and how fast first, then the robot as `top` shows it, then events. The last line says
// which keys there are.
std::vector<ScreenLine> teleop_view(const TeleopPicture& picture, const FeedNews& news,
                                    const std::vector<std::string>& messages,
                                    const WindowSize& window);

}  // namespace cargobay::cli
