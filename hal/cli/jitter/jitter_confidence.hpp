// How certain the figures of `cargobay jitter` are, in words.
#pragma once

#include <span>
#include <string>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {

// "1.074 [1.038, 1.110]", or "1.074 [none]".
std::string ratio_text(const hal::jitter::Estimate& ratio);

// A line for each reason why some ratio of these runs has no interval: which, and what would give
// it one. Nothing if all have one.
std::string lacks(std::span<const JitterSummary> runs);

}  // namespace cargobay::cli
