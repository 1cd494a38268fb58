#include "hal/cli/jitter/jitter_formats.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <fmt/format.h>

namespace cargobay::cli {
namespace {

constexpr std::uint64_t kFewestRows = 1000;
constexpr std::uint64_t kMostRows = 100'000;

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

// One of cyclictest's threads, in its microseconds: whole ones, rounded down.
struct Column {
  std::vector<std::uint64_t> counts{};
  std::uint64_t within = 0;  // of the histogram
  std::uint64_t cycles = 0;
  std::uint64_t least = ~std::uint64_t{0};
  std::uint64_t most = 0;
  std::uint64_t sum = 0;
  std::vector<std::uint64_t> overflows{};  // their cycles, counted from 0
};

template <typename See>
void see_us(const hal::jitter::Measured& channel, See see) {
  for (const hal::jitter::Slice& slice : channel.slices) {
    for (const float ns : slice.headline_ns) see(static_cast<std::uint64_t>(ns) / 1000);
  }
}

Column column(const hal::jitter::Measured& channel, std::uint64_t rows) {
  Column out{.counts = std::vector<std::uint64_t>(rows)};
  see_us(channel, [&](std::uint64_t us) {
    if (us < rows) {
      ++out.counts[us];
      ++out.within;
    } else {
      out.overflows.push_back(out.cycles);
    }
    ++out.cycles;
    out.least = std::min(out.least, us);
    out.most = std::max(out.most, us);
    out.sum += us;
  });
  if (out.cycles == 0) out.least = 0;
  return out;
}

// As many rows as somebody would have asked cyclictest for.
std::uint64_t rows_for(std::span<const hal::jitter::Measured* const> channels) {
  std::uint64_t most = 0;
  for (const hal::jitter::Measured* channel : channels)
    see_us(*channel, [&most](std::uint64_t us) { most = std::max(most, us); });
  std::uint64_t rows = kFewestRows;
  while (rows <= most && rows < kMostRows) rows *= 10;
  return rows;
}

// It keeps as many overflows as there are rows.
void put_overflows(std::string& out, std::size_t thread, const Column& of) {
  const auto to_out = std::back_inserter(out);
  fmt::format_to(to_out, "# Thread {}:", thread);
  const std::size_t kept = std::min(of.overflows.size(), of.counts.size());
  for (std::size_t i = 0; i < kept; ++i) fmt::format_to(to_out, " {:05}", of.overflows[i]);
  if (kept < of.overflows.size())
    fmt::format_to(to_out, " # {:05} others", of.overflows.size() - kept);
  out += '\n';
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

std::string cyclictest(std::span<const hal::jitter::Measured* const> channels) {
  const std::uint64_t rows = rows_for(channels);
  std::vector<Column> columns;
  columns.reserve(channels.size());
  for (const hal::jitter::Measured* channel : channels) columns.push_back(column(*channel, rows));
  std::string out = "# Histogram\n";
  const auto to_out = std::back_inserter(out);
  for (std::uint64_t row = 0; row < rows; ++row) {
    fmt::format_to(to_out, "{:06} ", row);
    for (std::size_t i = 0; i < columns.size(); ++i)
      fmt::format_to(to_out, "{}{:06}", i == 0 ? "" : "\t", columns[i].counts[row]);
    out += '\n';
  }
  const auto line = [&](const char* what, int digits, auto figure) {
    out += what;
    for (const Column& each : columns)
      fmt::format_to(to_out, " {:0{}}", std::uint64_t{figure(each)}, digits);
    out += '\n';
  };
  line("# Total:", 9, [](const Column& of) { return of.within; });
  line("# Min Latencies:", 5, [](const Column& of) { return of.least; });
  line("# Avg Latencies:", 5,
       [](const Column& of) { return of.cycles == 0 ? 0 : of.sum / of.cycles; });
  line("# Max Latencies:", 5, [](const Column& of) { return of.most; });
  line("# Histogram Overflows:", 5,
       [](const Column& of) { return std::uint64_t{of.overflows.size()}; });
  out += "# Histogram Overflow at cycle number:\n";
  for (std::size_t i = 0; i < columns.size(); ++i) put_overflows(out, i, columns[i]);
  return out + "\n";
}

}  // namespace cargobay::cli
