// The results of `cargobay jitter` in other programs' formats, for existing plotters.
#pragma once

#include <span>
#include <string>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {

// HdrHistogram's percentile output (hdr_percentiles_print), in microseconds, for one channel.
std::string hgrm(const ChannelSummary& channel);

// What `cyclictest -h ROWS --histfile` of rt-tests 2.4 writes, byte for byte: one thread for each
// channel, as measured, in whole microseconds, rounded down. ROWS is the first of 1000, 10 000 and
// 100 000 that holds all values, or the last; what is longer overflows.
std::string cyclictest(std::span<const hal::jitter::Measured* const> channels);

}  // namespace cargobay::cli
