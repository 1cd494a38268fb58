// Wheel speeds over time as an SVG drawing.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/cli/drive/drive_log.hpp"

namespace cargobay::cli {

// Whether a third panel shows the time between frames.
enum class Intervals : std::uint8_t { left_out, drawn };

// Set, true, estimated and commanded speed of both wheels on one scale, each curve labelled at its
// end. The title is wrapped. Self-contained: no style sheet, no script, a white background.
std::string velocity_plot(const std::vector<DriveSample>& samples, const std::string& title,
                          Intervals intervals = Intervals::left_out);

}  // namespace cargobay::cli
