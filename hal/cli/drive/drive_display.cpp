#include "hal/cli/drive/drive_display.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <span>
#include <utility>

#include <fmt/core.h>

#include "hal/cli/drive/drive_events.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/view/drive_view.hpp"

namespace cargobay::cli {
namespace {

constexpr std::size_t kHazardTicks = 67;  // 1 s: the battery has a turn too

}  // namespace

DriveDisplay::DriveDisplay(std::string what, double duration_s, const DriveLinks& links,
                           Events events)
    : what_{std::move(what)}, duration_s_{duration_s}, links_{links}, use_{events} {}

// Ctrl-Z ends a drive: suspended, it would leave the robot rolling.
void DriveDisplay::begin() { screen_ = Screen::open(ControlZ::ends); }

void DriveDisplay::show(const hal::FrameCounters& frames) {
  if (!screen_) {
    print_events();
    return;
  }
  const auto& states = links_.states();
  if (states.empty()) return;
  DrivePicture picture{.what = what_,
                       .duration_s = duration_s_,
                       .state = states.back(),
                       .frames = frames,
                       .messages = HeldMessages::so_far()};
  // A frame reports only some of the hazards: what was seen stays until all have been looked at
  // again.
  unsigned hazards = 0;
  for (const hal::CycleState& state : std::span{states}.last(std::min(states.size(), kHazardTicks)))
    hazards |= state.hazards.raw();
  picture.state.hazards = hal::Hazards{static_cast<std::uint8_t>(hazards)};
  constexpr std::size_t kMost = 100;  // more than fit any window
  const auto& events = links_.events();
  const std::size_t first = events.size() - std::min(events.size(), kMost);
  for (std::size_t i = first; i < events.size(); ++i) {
    std::string text = line(events[i]);
    text.pop_back();  // the line break
    picture.events.push_back(std::move(text));
  }
  screen_->draw(drive_view(picture, screen_->size()));
}

void DriveDisplay::end() {
  screen_.reset();
  print_events();
}

void DriveDisplay::print_events() {
  for (; printed_ < links_.events().size(); ++printed_) {
    if (use_ == Events::print) fmt::print("{}", line(links_.events()[printed_]));
  }
  std::fflush(stdout);
}

}  // namespace cargobay::cli
