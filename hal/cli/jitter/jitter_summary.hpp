// The results of a run of `cargobay jitter`, as they are printed, written, and read back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "hal/doctor/conditions.hpp"
#include "hal/jitter/estimate.hpp"
#include "hal/jitter/run.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

inline double us(std::uint64_t ns) { return static_cast<double>(ns) / 1e3; }

// Durations in nanoseconds.
struct Percentiles {
  std::uint64_t count = 0;
  std::uint64_t min = 0;
  std::uint64_t p50 = 0;
  std::uint64_t p90 = 0;
  std::uint64_t p99 = 0;
  std::uint64_t p999 = 0;
  std::uint64_t max = 0;
};

struct ChannelSummary {
  std::string name{};
  std::string headline{};  // the stage that these figures are of
  std::uint64_t period_ns = 0;
  std::uint64_t frames = 0;
  std::uint64_t missed = 0;
  Percentiles figures{};        // corrected for coordinated omission
  Percentiles raw{};            // as measured
  hal::jitter::Estimate p50{};  // those of `figures`
  hal::jitter::Estimate p99{};
  std::vector<std::pair<std::string, Percentiles>> stages{};
  std::vector<std::pair<std::uint64_t, std::uint64_t>> buckets{};      // corrected: value, count
  std::vector<std::pair<std::uint64_t, std::uint64_t>> raw_buckets{};  // as measured
  std::vector<std::pair<std::uint64_t, std::uint64_t>> slices{};       // p50 and p99 of each
};

// The ratio of two channels' figures.
struct RatioSummary {
  std::string over{};
  std::string under{};
  hal::jitter::Estimate p50{};
  hal::jitter::Estimate p99{};
};

// How it was measured.
struct JitterSettings {
  std::optional<int> cpu{};         // of the measured thread; none if it could migrate
  std::optional<int> source_cpu{};  // of the far end
  std::size_t warm_up = 0;          // frames of each slice that were not counted
  std::size_t hold_every = 0;       // every Nth frame was held back; 0: none
  double hold_ms = 0.0;
};

// Of the JSON. Format 1 counted waits below one period that nobody had, and had no intervals.
inline constexpr int kJitterFormat = 2;

struct JitterSummary {
  std::string label{};  // the file it was read from; empty for this run
  int format = kJitterFormat;
  std::string link{};  // "virtual Create", a port, or empty
  double seconds = 0.0;
  bool fifo = false;
  int priority = 0;
  bool memory_locked = false;
  std::string load{};                        // as requested; empty for none
  std::optional<JitterSettings> settings{};  // none of older versions
  hal::jitter::Conditions conditions{};
  hal::jitter::Usage usage{};
  std::vector<ChannelSummary> channels{};
  std::vector<RatioSummary> ratios{};

  const ChannelSummary* channel(std::string_view name) const;
};

// "1 frame in 10 held back for 20 ms", or nothing.
std::string held_back(const JitterSettings& settings);

// full: takes a second for each million frames at worst. hurried, when a user waits for the end: a
// channel of more than a million frames has no intervals, and percentiles to 0.8 %.
enum class Care : std::uint8_t { full, hurried };
JitterSummary summarise(const hal::jitter::Run& run, Care care);

std::string json(const JitterSummary& summary);
// Fails, and says why, if the text is not what json() writes.
hal::Result<JitterSummary> read_jitter(const std::string& text, const std::string& label);

}  // namespace cargobay::cli
