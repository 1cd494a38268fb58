// `cargobay jitter compare`: results side by side.
#pragma once

#include <string>
#include <vector>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {

// Each channel of every run, compared with the first run: ratios of the figures shown. Then what
// was different about the runs besides, a line each, and why ratios have no interval.
std::string comparison(const std::vector<JitterSummary>& all);

}  // namespace cargobay::cli
