#include "hal/cli/jitter/jitter_formats.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace cargobay::cli {
namespace {

struct Moments {
  double mean_us = 0.0;
  double deviation_us = 0.0;
};
Moments moments(const ChannelSummary& channel) {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;
  for (const auto& [value, times] : channel.buckets) {
    const auto n = static_cast<double>(times);
    count += n;
    sum += n * us(value);
    squares += n * us(value) * us(value);
  }
  if (count == 0.0) return {};
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean))};
}

// The column of one channel: counts by bucket, and overflows.
struct Column {
  std::vector<std::uint64_t> counts;
  std::uint64_t overflows = 0;
  std::uint64_t total = 0;
  double sum_us = 0.0;
};
Column column(const ChannelSummary& channel, std::uint64_t bucket_us, std::uint64_t most_us) {
  Column out{.counts = std::vector<std::uint64_t>(static_cast<std::size_t>(most_us / bucket_us))};
  for (const auto& [value, count] : channel.raw_buckets) {
    const auto bucket = static_cast<std::size_t>(value / 1000 / bucket_us);
    if (bucket < out.counts.size()) {
      out.counts[bucket] += count;
    } else {
      out.overflows += count;
    }
    out.total += count;
    out.sum_us += us(value) * static_cast<double>(count);
  }
  return out;
}

}  // namespace

std::string hgrm(const ChannelSummary& channel) {
  std::string out = "       Value     Percentile TotalCount 1/(1-Percentile)\n\n";
  const auto to_out = std::back_inserter(out);
  std::uint64_t total = 0;
  for (const auto& [value, count] : channel.buckets) total += count;
  std::uint64_t seen = 0;
  // HdrHistogram halves the distance left to 100 % after every five lines.
  double next = 0.0;
  for (const auto& [value, count] : channel.buckets) {
    seen += count;
    const double share = static_cast<double>(seen) / static_cast<double>(total);
    if (share < next && seen < total) continue;
    if (seen == total) {
      fmt::format_to(to_out, "{:12.3f} {:14.12f} {:10}\n", us(value), 1.0, seen);
      break;
    }
    fmt::format_to(to_out, "{:12.3f} {:14.12f} {:10} {:14.2f}\n", us(value), share, seen,
                   1.0 / (1.0 - share));
    const double halvings = std::floor(-std::log2(1.0 - share)) + 1.0;
    next = share + 1.0 / (5.0 * std::exp2(halvings));
  }
  const Moments all = moments(channel);
  fmt::format_to(to_out, "#[Mean    = {:12.3f}, StdDeviation   = {:12.3f}]\n", all.mean_us,
                 all.deviation_us);
  fmt::format_to(to_out, "#[Max     = {:12.3f}, Total count    = {:12}]\n", us(channel.figures.max),
                 total);
  fmt::format_to(to_out, "#[Buckets = {:12}, SubBuckets     = {:12}]\n", 34, 128);
  return out;
}

std::string cyclictest(const JitterSummary& summary, std::uint64_t bucket_us,
                       std::uint64_t most_us) {
  std::vector<Column> columns;
  columns.reserve(summary.channels.size());
  for (const ChannelSummary& channel : summary.channels)
    columns.push_back(column(channel, bucket_us, most_us));
  std::string out = "# Channels:";
  const auto to_out = std::back_inserter(out);
  for (const ChannelSummary& channel : summary.channels)
    fmt::format_to(to_out, " {}", channel.name);
  out += "\n# Histogram\n";
  const auto buckets = static_cast<std::size_t>(most_us / bucket_us);
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    const bool empty = std::ranges::all_of(
        columns, [bucket](const Column& each) { return each.counts[bucket] == 0; });
    if (empty) continue;
    fmt::format_to(to_out, "{:06}", bucket * bucket_us);
    for (const Column& each : columns) fmt::format_to(to_out, "\t{:06}", each.counts[bucket]);
    out += '\n';
  }
  const auto line = [&](const char* what, auto figure) {
    out += what;
    for (std::size_t i = 0; i < columns.size(); ++i)
      fmt::format_to(to_out, " {:05}", static_cast<std::uint64_t>(figure(i)));
    out += '\n';
  };
  line("# Total:", [&](std::size_t i) { return columns[i].total; });
  line("# Min Latencies:", [&](std::size_t i) { return summary.channels[i].raw.min / 1000; });
  line("# Avg Latencies:", [&](std::size_t i) {
    const auto total = static_cast<double>(std::max<std::uint64_t>(columns[i].total, 1));
    return columns[i].sum_us / total;
  });
  line("# Max Latencies:", [&](std::size_t i) { return summary.channels[i].raw.max / 1000; });
  line("# Histogram Overflows:", [&](std::size_t i) { return columns[i].overflows; });
  return out;
}

}  // namespace cargobay::cli
