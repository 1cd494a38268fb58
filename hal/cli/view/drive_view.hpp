// The live picture of `cargobay drive`.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hal/cli/view/screen.hpp"
#include "hal/cycle/cycle_state.hpp"

namespace cargobay::cli {

struct DrivePicture {
  std::string what{};  // profile and loop
  double duration_s = 0.0;
  hal::CycleState state{};
  hal::FrameCounters frames{};
  std::vector<std::string> events{};    // the latest last, each one line
  std::vector<std::string> messages{};  // of the command, the same
};

// Four lines, not wider than 60 columns: mode, battery, bumps, charger, wheel drops and cliffs.
std::vector<ScreenLine> safety_lines(const hal::CycleState& state);

// Those lines first, then the wheels, the way, and the latest
// events as far as there is room.
std::vector<ScreenLine> drive_view(const DrivePicture& picture, const WindowSize& window);

}  // namespace cargobay::cli
