#include "hal/cli/jitter/jitter_summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace cargobay::cli {
namespace {

using hal::jitter::Measured;
using hal::jitter::Slice;
using hal::jitter::Stage;

// Nothing was faster than the least that was measured.
Percentiles percentiles(const rt::Histogram& histogram, std::uint64_t least) {
  const auto at = [&](double percent) { return std::max(histogram.percentile(percent), least); };
  return {.count = histogram.count(),
          .min = std::max(histogram.min(), least),
          .p50 = at(50),
          .p90 = at(90),
          .p99 = at(99),
          .p999 = at(99.9),
          .max = histogram.max()};
}

std::vector<std::pair<std::uint64_t, std::uint64_t>> buckets(const rt::Histogram& histogram,
                                                             std::uint64_t least) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> all;
  histogram.visit([&all, least](std::uint64_t value, std::uint64_t count) {
    const std::uint64_t shown = std::max(value, least);
    if (!all.empty() && all.back().first == shown) {
      all.back().second += count;
    } else {
      all.push_back({shown, count});
    }
  });
  return all;
}

std::uint64_t whole(double ns) { return static_cast<std::uint64_t>(std::llround(ns)); }

// From every value, not from the histogram's buckets: intervals may be narrower than those.
void estimate(const Measured& measured, ChannelSummary& summary) {
  hal::jitter::Sample sample{measured.slices, summary.period_ns};
  const auto at = [&sample](double percent) {
    hal::jitter::Estimate estimate = sample.estimate(percent);
    estimate.value = std::round(estimate.value);  // as it is shown
    return estimate;
  };
  summary.p50 = at(50);
  summary.p99 = at(99);
  summary.figures.p50 = whole(summary.p50.value);
  summary.figures.p90 = whole(sample.percentile(90));
  summary.figures.p99 = whole(summary.p99.value);
  summary.figures.p999 = whole(sample.percentile(99.9));
}

constexpr std::uint64_t kManyFrames = 1'000'000;

ChannelSummary summarise(const Measured& measured, Care care) {
  const std::uint64_t least = measured.raw.min();
  ChannelSummary summary{.name = measured.name,
                         .headline = std::string{hal::jitter::name(measured.headline)},
                         .period_ns = static_cast<std::uint64_t>(measured.period.count()),
                         .frames = measured.frames,
                         .missed = measured.missed,
                         .figures = percentiles(measured.headline_ns(), least),
                         .raw = percentiles(measured.raw, 0),
                         .buckets = buckets(measured.headline_ns(), least),
                         .raw_buckets = buckets(measured.raw, 0)};
  for (const Stage stage : hal::jitter::kStages) {
    const auto index = static_cast<std::size_t>(stage);
    if (!measured.seen[index]) continue;
    summary.stages.push_back(
        {std::string{name(stage)}, percentiles(measured.stages[index], measured.least_ns[index])});
  }
  summary.stages.push_back({"interval", percentiles(measured.interval_ns, 0)});
  for (const Slice& slice : measured.slices) {
    if (slice.headline_ns.empty()) continue;
    hal::jitter::Sample sample{{&slice, 1}, summary.period_ns};
    summary.slices.push_back({whole(sample.percentile(50)), whole(sample.percentile(99))});
  }
  if (care == Care::full || measured.frames <= kManyFrames) {
    estimate(measured, summary);
  } else {
    summary.p50 = {.value = static_cast<double>(summary.figures.p50),
                   .lack = hal::jitter::Lack::time};
    summary.p99 = {.value = static_cast<double>(summary.figures.p99),
                   .lack = hal::jitter::Lack::time};
  }
  return summary;
}

}  // namespace

const ChannelSummary* JitterSummary::channel(std::string_view name) const {
  const auto found = std::ranges::find(channels, name, &ChannelSummary::name);
  return found == channels.end() ? nullptr : &*found;
}

std::string held_back(const JitterSettings& settings) {
  if (settings.hold_every == 0) return {};
  return fmt::format("1 frame in {} held back for {:g} ms", settings.hold_every, settings.hold_ms);
}

JitterSummary summarise(const hal::jitter::Run& run, Care care) {
  JitterSummary summary;
  for (const auto& channel : run.channels()) {
    summary.channels.push_back(summarise(channel->measured(), care));
    summary.fifo = channel->grant().fifo;
    summary.priority = channel->grant().priority;
    summary.memory_locked = channel->grant().memory_locked;
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kRatios{
      {{"again", "echo"}, {"loop", "echo"}, {"echo", "pipe"}}};
  // They took turns: what the machine did meanwhile affected both.
  const auto paired = [](const hal::jitter::Estimate& a, const hal::jitter::Estimate& b) {
    return ratio(a, b, correlation(a, b));
  };
  for (const auto& [over, under] : kRatios) {
    const ChannelSummary* const a = summary.channel(over);
    const ChannelSummary* const b = summary.channel(under);
    if (a == nullptr || b == nullptr || a->frames == 0 || b->frames == 0) continue;
    summary.ratios.push_back({.over = std::string{over},
                              .under = std::string{under},
                              .p50 = paired(a->p50, b->p50),
                              .p99 = paired(a->p99, b->p99)});
  }
  return summary;
}

}  // namespace cargobay::cli
