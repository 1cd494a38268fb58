#include "hal/cli/jitter/jitter_table.hpp"

#include <langinfo.h>

#include <algorithm>
#include <array>
#include <clocale>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "hal/cli/jitter/jitter_confidence.hpp"

namespace cargobay::cli {
namespace {

constexpr std::size_t kColumns = 28;

// The headline of a channel, in words.
std::string_view what(const ChannelSummary& channel) {
  if (channel.headline == "woken") return "due to awake";
  return channel.name == "robot" ? "frame to command written" : "frame to answer written";
}

struct Decades {
  double low = 0.0;  // log10 of nanoseconds
  double high = 1.0;
};
Decades decades(const std::vector<ChannelSummary>& channels) {
  std::uint64_t least = ~std::uint64_t{0};
  std::uint64_t most = 1;
  for (const ChannelSummary& channel : channels) {
    if (channel.figures.count == 0) continue;
    least = std::min(least, std::max<std::uint64_t>(channel.figures.min, 100));
    most = std::max(most, channel.figures.max);
  }
  const double low = std::log10(static_cast<double>(std::min(least, most)));
  return {low, std::max(std::log10(static_cast<double>(most)), low + 0.1)};
}

// Each column shows a share of the values, its height logarithmic, so that one in a thousand shows.
std::string histogram(const ChannelSummary& channel, const Decades& range, Bars bars) {
  std::array<double, kColumns> columns{};
  for (const auto& [value, count] : channel.buckets) {
    const double place = (std::log10(std::max(static_cast<double>(value), 1.0)) - range.low) /
                         (range.high - range.low) * static_cast<double>(kColumns);
    const double last = static_cast<double>(kColumns - 1);
    columns[static_cast<std::size_t>(std::clamp(place, 0.0, last))] += static_cast<double>(count);
  }
  static constexpr std::array<const char*, 9> kBlocks{" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  static constexpr std::array<const char*, 9> kAscii{" ", ".", ".", ":", ":", "+", "+", "#", "#"};
  const double most = *std::ranges::max_element(columns);
  std::string out;
  for (const double column : columns) {
    const double height = column == 0.0 ? 0.0 : 8.0 + 2.0 * std::log10(column / most);
    const auto step = static_cast<std::size_t>(std::clamp(height, column == 0.0 ? 0.0 : 1.0, 8.0));
    out += bars == Bars::blocks ? kBlocks[step] : kAscii[step];
  }
  return out;
}

void put_headline(std::string& out, const JitterSummary& summary) {
  const auto to_out = std::back_inserter(out);
  const std::string held = summary.settings ? held_back(*summary.settings) : std::string{};
  fmt::format_to(to_out, "Timing jitter, {:.1f} s{}{}, ", summary.seconds,
                 summary.load.empty() ? "" : ", load " + summary.load,
                 held.empty() ? "" : ", " + held);
  if (summary.fifo) {
    fmt::format_to(to_out, "SCHED_FIFO priority {}, memory {}locked\n", summary.priority,
                   summary.memory_locked ? "" : "not ");
  } else {
    fmt::format_to(to_out,
                   "WITHOUT real-time rights: these figures are those of ordinary scheduling, and\n"
                   "say nothing about what the loop does with SCHED_FIFO; run it as root, or see: "
                   "cargobay doctor\n");
  }
}

void put_channels(std::string& out, const JitterSummary& summary, Bars bars) {
  const auto to_out = std::back_inserter(out);
  const Decades range = decades(summary.channels);
  fmt::format_to(to_out, "{:<7}{:<26}{:>8}{:>7}{:>9}{:>9}{:>9}{:>9}{:>10}  us\n", "Channel", "",
                 "frames", "missed", "min", "p50", "p99", "p99.9", "max");
  for (const ChannelSummary& channel : summary.channels) {
    const Percentiles& p = channel.figures;
    fmt::format_to(to_out, "{:<7}{:<26}{:>8}{:>7}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>10.1f}\n",
                   channel.name, what(channel), channel.frames, channel.missed, us(p.min),
                   us(p.p50), us(p.p99), us(p.p999), us(p.max));
  }
  fmt::format_to(to_out, "{:<7}{:>10.1f} us {:>{}.0f} us, logarithmic in time and number\n", "",
                 std::pow(10.0, range.low) / 1e3, std::pow(10.0, range.high) / 1e3, kColumns - 7);
  for (const ChannelSummary& channel : summary.channels) {
    fmt::format_to(to_out, "{:<7}   |{}|\n", channel.name, histogram(channel, range, bars));
  }
}

void put_stages(std::string& out, const JitterSummary& summary) {
  const auto to_out = std::back_inserter(out);
  fmt::format_to(to_out, "{:<33}{:>15}{:>14}{:>9}{:>10}  us\n", "Stages, from the frame complete",
                 "", "p50", "p99", "max");
  for (const ChannelSummary& channel : summary.channels) {
    for (const auto& [name, p] : channel.stages) {
      fmt::format_to(to_out, "  {:<9}{:<37}{:>14.1f}{:>9.1f}{:>10.1f}\n", channel.name, name,
                     us(p.p50), us(p.p99), us(p.max));
    }
  }
}

void put_ratios(std::string& out, const JitterSummary& summary) {
  const auto to_out = std::back_inserter(out);
  if (summary.ratios.empty()) return;
  fmt::format_to(to_out, "{:<28}{:<25}{}\n", "Ratios, 95 % confidence", "p50", "p99");
  for (const RatioSummary& ratio : summary.ratios) {
    const bool same = ratio.over == "again";
    fmt::format_to(to_out, "  {:<26}{:<25}{}{}\n", ratio.over + " / " + ratio.under,
                   ratio_text(ratio.p50), ratio_text(ratio.p99),
                   same ? "  the same thing twice: the noise" : "");
  }
  std::vector<std::string> channels;
  for (const RatioSummary& ratio : summary.ratios) {
    channels.push_back(ratio.over);
    channels.push_back(ratio.under);
  }
  out += lacks({&summary, 1}, channels);
}

void put_conditions(std::string& out, const JitterSummary& summary) {
  const auto to_out = std::back_inserter(out);
  const hal::jitter::Conditions& now = summary.conditions;
  fmt::format_to(to_out, "Machine    {}{}, {} x {}, Linux {}, preemption {}\n", now.board,
                 now.board.empty() ? "unknown board" : "", now.processors, now.processor,
                 now.kernel, now.preemption);
  fmt::format_to(to_out, "           governor {}, {}, {}, load {:.2f}\n",
                 now.governor.empty() ? "none" : now.governor,
                 now.temperature_c ? fmt::format("{:.0f} deg C", *now.temperature_c)
                                   : std::string{"temperature unknown"},
                 now.throttled ? fmt::format("throttled {:#x}", *now.throttled)
                               : std::string{"throttling unknown"},
                 now.load);
  const hal::jitter::Usage& used = summary.usage;
  fmt::format_to(to_out,
                 "Meanwhile  {:.2f} s of processor time, {:.2f} s stolen by a hypervisor, {} + {} "
                 "context switches, {} page faults\n",
                 used.busy_s, used.steal_s, used.voluntary_switches, used.involuntary_switches,
                 used.minor_faults + used.major_faults);
  if (!summary.link.empty()) fmt::format_to(to_out, "Robot      {}\n", summary.link);
}

}  // namespace

Bars bars_of_locale() {
  // No other thread of the command uses the locale.
  std::setlocale(LC_CTYPE, "");                       // NOLINT(concurrency-mt-unsafe): see above
  const std::string_view set = nl_langinfo(CODESET);  // NOLINT(concurrency-mt-unsafe): see above
  return set == "UTF-8" || set == "utf8" ? Bars::blocks : Bars::ascii;
}

std::string table(const JitterSummary& summary, Bars bars) {
  std::string out;
  put_headline(out, summary);
  put_channels(out, summary, bars);
  put_stages(out, summary);
  put_ratios(out, summary);
  put_conditions(out, summary);
  return out;
}

}  // namespace cargobay::cli
