#include "hal/cli/jitter/jitter_confidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace cargobay::cli {
namespace {

using hal::jitter::Estimate;
using hal::jitter::Lack;

struct Reason {
  Lack lack;
  const char* words;
};
constexpr std::array<Reason, 5> kReasons{
    {{Lack::slices, "fewer than 30 slices"},
     {Lack::values, "fewer than 200 frames slower than this"},
     {Lack::steadiness, "latencies changed too slowly for so short a run"},
     {Lack::time, "it was ended early, with many frames to look at"},
     {Lack::unknown, "measured by an older version, which did not say"}}};

// Seconds after which this run would have had enough; 0 if it cannot be said.
double enough_s(const JitterSummary& run, const ChannelSummary& channel, Lack lack,
                double percent) {
  double times = 0.0;
  if (lack == Lack::slices && !channel.slices.empty()) {
    times =
        static_cast<double>(hal::jitter::kLeastSlices) / static_cast<double>(channel.slices.size());
  }
  if (channel.frames == 0) return 0.0;
  const double beyond = (1.0 - percent / 100.0) * static_cast<double>(channel.frames);
  if (lack == Lack::slices || lack == Lack::values)
    times = std::max(times, hal::jitter::kLeastBeyond / beyond);
  if (lack == Lack::steadiness) times = 4.0;
  return std::ceil(1.05 * times * run.seconds);
}

// Channels that lack the same for the same percentile; those of one period need as long.
struct Key {
  Lack lack;
  double percent;
  std::uint64_t period_ns;
  auto operator<=>(const Key&) const = default;
};
struct Found {
  std::vector<std::string> where{};
  double seconds = 0.0;
};

std::map<Key, Found> find(std::span<const JitterSummary> runs,
                          std::span<const std::string> channels) {
  std::map<Key, Found> all;
  for (const JitterSummary& run : runs) {
    for (const ChannelSummary& channel : run.channels) {
      if (channel.frames == 0 || std::ranges::count(channels, channel.name) == 0) continue;
      for (const auto& [estimate, percent] :
           {std::pair{&channel.p50, 50.0}, {&channel.p99, 99.0}}) {
        if (estimate->interval) continue;
        Found& found = all[{estimate->lack, percent, channel.period_ns}];
        found.where.push_back(run.label.empty() ? channel.name : channel.name + " " + run.label);
        found.seconds = std::max(found.seconds, enough_s(run, channel, estimate->lack, percent));
      }
    }
  }
  return all;
}

std::string words(Lack lack) {
  const auto* const found = std::ranges::find(kReasons, lack, &Reason::lack);
  return found == kReasons.end() ? "it is not known why" : found->words;
}

}  // namespace

std::string ratio_text(const Estimate& ratio) {
  if (!ratio.interval) return fmt::format("{:.3f} [none]", ratio.value);
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", ratio.value, ratio.interval->low,
                     ratio.interval->high);
}

std::string lacks(std::span<const JitterSummary> runs, std::span<const std::string> channels) {
  std::string out;
  for (const auto& [key, found] : find(runs, channels)) {
    constexpr std::size_t kNamed = 2;
    const std::size_t named = std::min(found.where.size(), kNamed);
    std::string where = fmt::format(
        "{}", fmt::join(found.where.begin(),
                        found.where.begin() + static_cast<std::ptrdiff_t>(named), ", "));
    if (named < found.where.size())
      where += fmt::format(" and {} more", found.where.size() - named);
    out += fmt::format("[none] at p{:g}: {} ({}){}\n", key.percent, words(key.lack), where,
                       found.seconds > 0.0 ? fmt::format("; try --duration {:.0f}", found.seconds)
                                           : std::string{});
  }
  return out;
}

}  // namespace cargobay::cli
