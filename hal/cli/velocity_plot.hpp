// Wheel speeds over time as an SVG drawing.
#pragma once

#include <string>
#include <vector>

#include "hal/cli/drive_log.hpp"

namespace cargobay::cli {

// Set, true, estimated and commanded speed of both wheels, each line labelled at its end. Stands by
// itself: no style sheet, no script, a white ground.
std::string velocity_plot(const std::vector<DriveSample>& samples, const std::string& title);

}  // namespace cargobay::cli
