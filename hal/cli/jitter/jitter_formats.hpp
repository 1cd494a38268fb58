// The results of `cargobay jitter` in other programs' formats, for existing plotters.
#pragma once

#include <string>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {

// HdrHistogram's percentile output (hdr_percentiles_print), in microseconds, for one channel.
std::string hgrm(const ChannelSummary& channel);

// The histogram of `cyclictest -h`, one column per channel, in buckets of `bucket_us`. cyclictest
// has buckets of 1 us and does not correct for coordinated omission; this does not correct either.
// Values of `most_us` and more overflow.
std::string cyclictest(const JitterSummary& summary, std::uint64_t bucket_us,
                       std::uint64_t most_us);

}  // namespace cargobay::cli
