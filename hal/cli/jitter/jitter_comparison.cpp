#include "hal/cli/jitter/jitter_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "hal/cli/jitter/jitter_confidence.hpp"

namespace cargobay::cli {
namespace {

std::string or_none(const std::string& text) { return text.empty() ? "none" : text; }

// What a figure depends on besides what is compared.
struct Condition {
  const char* name;
  std::function<std::string(const JitterSummary&)> value;
};

std::string periods(const JitterSummary& run) {
  std::string all;
  for (const ChannelSummary& channel : run.channels) {
    const double ms = static_cast<double>(channel.period_ns) / 1e6;
    if (channel.name != "robot" && all.empty()) all = fmt::format("{:g} ms", ms);
  }
  return or_none(all);
}

std::string cpus(const JitterSettings& settings) {
  const auto named = [](const std::optional<int>& cpu) {
    return cpu ? std::to_string(*cpu) : std::string{"any"};
  };
  return fmt::format("{}, far end {}", named(settings.cpu), named(settings.source_cpu));
}

// Of a setting, in words.
Condition set(const char* name, std::function<std::string(const JitterSettings&)> value) {
  return {name, [value = std::move(value)](const JitterSummary& run) {
            return run.settings ? or_none(value(*run.settings)) : std::string{"unknown"};
          }};
}

const std::vector<Condition>& conditions() {
  static const std::vector<Condition> kAll{
      {"kernel", [](const JitterSummary& run) { return run.conditions.kernel; }},
      {"preemption", [](const JitterSummary& run) { return run.conditions.preemption; }},
      {"board", [](const JitterSummary& run) { return or_none(run.conditions.board); }},
      {"processor",
       [](const JitterSummary& run) {
         return fmt::format("{} x {}", run.conditions.processors, run.conditions.processor);
       }},
      {"governor", [](const JitterSummary& run) { return or_none(run.conditions.governor); }},
      {"throttling",
       [](const JitterSummary& run) {
         return run.conditions.throttled ? fmt::format("{:#x}", *run.conditions.throttled)
                                         : std::string{"unknown"};
       }},
      {"load asked for", [](const JitterSummary& run) { return or_none(run.load); }},
      {"scheduler",
       [](const JitterSummary& run) {
         return run.fifo ? fmt::format("SCHED_FIFO {}", run.priority)
                         : std::string{"no real-time rights"};
       }},
      {"memory",
       [](const JitterSummary& run) { return run.memory_locked ? "locked" : "not locked"; }},
      {"period", periods},
      set("CPU", cpus),
      set("warm-up", [](const JitterSettings& it) { return fmt::format("{} frames", it.warm_up); }),
      set("on purpose", held_back),
      {"robot", [](const JitterSummary& run) { return or_none(run.link); }},
      {"correction",
       [](const JitterSummary& run) {
         return run.format == 1 ? "of an older version, which counts waits below one period"
                                : "by HdrHistogram's rule";
       }},
  };
  return kAll;
}

// One-minute averages differ by chance; these do not.
bool loads_differ(double one, double other) {
  const double most = std::max(one, other);
  return most - std::min(one, other) > 0.5 && most > 1.5 * std::min(one, other);
}

std::string differences(const JitterSummary& first, const JitterSummary& other) {
  std::string out;
  const auto differs = [&](const std::string& what, const std::string& here,
                           const std::string& there) {
    out += fmt::format("Different: {}: {} in {}, {} in {}\n", what, there, first.label, here,
                       other.label);
  };
  for (const Condition& condition : conditions()) {
    const std::string here = condition.value(other);
    const std::string there = condition.value(first);
    if (here != there) differs(condition.name, here, there);
  }
  if (loads_differ(first.conditions.load, other.conditions.load)) {
    differs("load average", fmt::format("{:.2f}", other.conditions.load),
            fmt::format("{:.2f}", first.conditions.load));
  }
  // In percent of one processor.
  const auto stolen = [](const JitterSummary& run) {
    return run.seconds > 0.0 ? 100.0 * run.usage.steal_s / run.seconds : 0.0;
  };
  if (std::abs(stolen(first) - stolen(other)) > 1.0) {
    differs("stolen by a hypervisor", fmt::format("{:.1f} %", stolen(other)),
            fmt::format("{:.1f} %", stolen(first)));
  }
  return out;
}

void put_row(std::string& out, std::size_t names, const JitterSummary& run,
             const ChannelSummary& channel, const ChannelSummary* first) {
  const Percentiles& figures = channel.figures;
  fmt::format_to(std::back_inserter(out), "{:<7} {:<{}}{:>9.1f}{:>9.1f}{:>10.1f}", channel.name,
                 run.label, names, us(figures.p50), us(figures.p99), us(figures.max));
  if (first != nullptr) {
    fmt::format_to(std::back_inserter(out), "      p50 x {}  p99 x {}",
                   ratio_text(ratio(channel.p50, first->p50)),
                   ratio_text(ratio(channel.p99, first->p99)));
  }
  out += '\n';
}

// Channels that only one of them has.
void put_unmatched(std::string& out, const JitterSummary& first, const JitterSummary& other) {
  const auto only = [&out](const JitterSummary& in, const JitterSummary& not_in) {
    for (const ChannelSummary& channel : in.channels) {
      if (not_in.channel(channel.name) == nullptr)
        out += fmt::format("Only in {}: {}\n", in.label, channel.name);
    }
  };
  only(first, other);
  only(other, first);
}

// The channels of the first that another has as well.
std::vector<std::string> compared(const std::vector<JitterSummary>& all) {
  std::vector<std::string> names;
  for (const ChannelSummary& channel : all.front().channels) {
    const bool elsewhere = std::any_of(
        std::next(all.begin()), all.end(),
        [&channel](const JitterSummary& run) { return run.channel(channel.name) != nullptr; });
    if (elsewhere) names.push_back(channel.name);
  }
  return names;
}

}  // namespace

std::string comparison(const std::vector<JitterSummary>& all) {
  const JitterSummary& first = all.front();
  std::size_t names = 16;
  for (const JitterSummary& run : all) names = std::max(names, run.label.size());
  std::string out =
      fmt::format("{:<7} {:<{}}{:>9}{:>9}{:>10}  us   ratios to the first, 95 % confidence\n",
                  "Channel", "", names, "p50", "p99", "max");
  for (const ChannelSummary& channel : first.channels) {
    put_row(out, names, first, channel, nullptr);
    for (auto other = std::next(all.begin()); other != all.end(); ++other) {
      const ChannelSummary* const same = other->channel(channel.name);
      if (same != nullptr) put_row(out, names, *other, *same, &channel);
    }
  }
  out += lacks(all, compared(all));
  for (const JitterSummary& run : all) {
    fmt::format_to(std::back_inserter(out), "{}: {}, Linux {}, preemption {}, {}\n", run.label,
                   run.conditions.processor, run.conditions.kernel, run.conditions.preemption,
                   run.fifo ? fmt::format("SCHED_FIFO {}", run.priority)
                            : std::string{"without real-time rights"});
  }
  for (auto other = std::next(all.begin()); other != all.end(); ++other) {
    put_unmatched(out, first, *other);
    out += differences(first, *other);
  }
  return out;
}

}  // namespace cargobay::cli
