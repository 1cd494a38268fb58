#include "hal/cli/jitter/jitter_summary.hpp"

#include <algorithm>
#include <array>

namespace cargobay::cli {
namespace {

using hal::jitter::Measured;
using hal::jitter::Slice;
using hal::jitter::Stage;

Percentiles percentiles(const rt::Histogram& histogram) {
  return {.count = histogram.count(),
          .min = histogram.min(),
          .p50 = histogram.percentile(50),
          .p90 = histogram.percentile(90),
          .p99 = histogram.percentile(99),
          .p999 = histogram.percentile(99.9),
          .max = histogram.max()};
}

std::vector<std::pair<std::uint64_t, std::uint64_t>> buckets(const rt::Histogram& histogram) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> all;
  histogram.visit(
      [&all](std::uint64_t value, std::uint64_t count) { all.push_back({value, count}); });
  return all;
}

ChannelSummary summarise(const Measured& measured) {
  ChannelSummary summary{.name = measured.name,
                         .headline = std::string{hal::jitter::name(measured.headline)},
                         .period_ns = static_cast<std::uint64_t>(measured.period.count()),
                         .frames = measured.frames,
                         .missed = measured.missed,
                         .figures = percentiles(measured.headline_ns()),
                         .raw = percentiles(measured.raw),
                         .buckets = buckets(measured.headline_ns()),
                         .raw_buckets = buckets(measured.raw)};
  for (const Stage stage : hal::jitter::kStages) {
    const auto index = static_cast<std::size_t>(stage);
    if (measured.seen[index])
      summary.stages.push_back({std::string{name(stage)}, percentiles(measured.stages[index])});
  }
  summary.stages.push_back({"interval", percentiles(measured.interval_ns)});
  for (const Slice& slice : measured.slices) {
    if (slice.headline_ns.empty()) continue;
    const auto of = [&slice](double percent) {
      return static_cast<std::uint32_t>(hal::jitter::percentile({&slice, 1}, percent));
    };
    summary.slices.push_back({of(50), of(99)});
  }
  return summary;
}

const Measured* find(const hal::jitter::Run& run, std::string_view name) {
  for (const auto& channel : run.channels()) {
    if (channel->measured().name == name) return &channel->measured();
  }
  return nullptr;
}

constexpr int kLeastDraws = 20;  // with fewer, an interval says nothing

// As many draws as take about 0.1 s.
int hurried_draws(std::uint64_t frames) {
  constexpr std::uint64_t kFrames = 10'000'000;
  return static_cast<int>(
      std::min<std::uint64_t>(kFrames / std::max<std::uint64_t>(frames, 1), hal::jitter::kDraws));
}

}  // namespace

const ChannelSummary* JitterSummary::channel(std::string_view name) const {
  const auto found = std::ranges::find(channels, name, &ChannelSummary::name);
  return found == channels.end() ? nullptr : &*found;
}

JitterSummary summarise(const hal::jitter::Run& run, Care care) {
  JitterSummary summary;
  for (const auto& channel : run.channels()) {
    summary.channels.push_back(summarise(channel->measured()));
    summary.fifo = channel->grant().fifo;
    summary.priority = channel->grant().priority;
    summary.memory_locked = channel->grant().memory_locked;
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kRatios{
      {{"again", "echo"}, {"loop", "echo"}, {"echo", "pipe"}}};
  for (const auto& [over, under] : kRatios) {
    const Measured* const a = find(run, over);
    const Measured* const b = find(run, under);
    if (a == nullptr || b == nullptr || a->frames == 0 || b->frames == 0) continue;
    const int draws =
        care == Care::full ? hal::jitter::kDraws : hurried_draws(a->frames + b->frames);
    if (draws < kLeastDraws) continue;
    summary.ratios.push_back(
        {.over = std::string{over},
         .under = std::string{under},
         .p50 = ratio_of_percentiles(a->slices, b->slices, 50, hal::jitter::kSeed, draws),
         .p99 = ratio_of_percentiles(a->slices, b->slices, 99, hal::jitter::kSeed, draws)});
  }
  return summary;
}

hal::jitter::Estimate compare(const ChannelSummary& a, const ChannelSummary& b, double percent) {
  const auto slices = [percent](const ChannelSummary& channel) {
    std::vector<Slice> all;
    all.reserve(channel.slices.size());
    for (const auto& [p50, p99] : channel.slices)
      all.push_back({.headline_ns = {percent < 75.0 ? p50 : p99}});
    return all;
  };
  return hal::jitter::ratio_of_percentiles(slices(a), slices(b), 50);
}

}  // namespace cargobay::cli
