// A drawing of a drive that is still under way, made again and again from its feed.
#pragma once

#include <string>

#include "hal/result.hpp"

namespace cargobay::cli {

struct LivePlotOptions {
  std::string port{};    // whose feed; empty for the only one there is
  std::string output{};  // "-" is written once, at the end
  double last_s = 0.0;   // so much of the drive is drawn
};

// Writes the drawing every 2 s, and once more when a signal comes or the feed ends. Blocks until
// then. The failure says what could not be read or written; what was drawn before stays.
hal::Result<void> plot_live(const LivePlotOptions& options);

}  // namespace cargobay::cli
