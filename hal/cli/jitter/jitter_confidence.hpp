// How certain the figures of `cargobay jitter` are, in words.
#pragma once

#include <span>
#include <string>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {

// "1.074 [1.038, 1.110]", or "1.074 [none]".
std::string ratio_text(const hal::jitter::Estimate& ratio);

// Why figures of these channels, and so their ratios, have no interval: a line for each reason and
// percentile, with the duration that would give them one. Nothing if all have one.
std::string lacks(std::span<const JitterSummary> runs, std::span<const std::string> channels);

}  // namespace cargobay::cli
