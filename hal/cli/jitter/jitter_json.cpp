// The JSON of `cargobay jitter --json`, written and read. Ratios are not read: what is compared is
// the channels' figures.
#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "hal/cli/jitter/jitter_summary.hpp"

namespace cargobay::cli {
namespace {

using nlohmann::json;

json of(const Percentiles& p) {
  return {{"count", p.count}, {"min", p.min},   {"p50", p.p50}, {"p90", p.p90},
          {"p99", p.p99},     {"p999", p.p999}, {"max", p.max}};
}
Percentiles percentiles(const json& in) {
  return {.count = in.at("count"),
          .min = in.at("min"),
          .p50 = in.at("p50"),
          .p90 = in.at("p90"),
          .p99 = in.at("p99"),
          .p999 = in.at("p999"),
          .max = in.at("max")};
}

constexpr std::array kLacks{hal::jitter::Lack::nothing, hal::jitter::Lack::slices,
                            hal::jitter::Lack::values,  hal::jitter::Lack::steadiness,
                            hal::jitter::Lack::time,    hal::jitter::Lack::unknown};

json of(const hal::jitter::Estimate& estimate, const char* what) {
  json out{{what, estimate.value}, {"lack", name(estimate.lack)}};
  out["low"] = estimate.interval ? json(estimate.interval->low) : json{};
  out["high"] = estimate.interval ? json(estimate.interval->high) : json{};
  return out;
}
hal::jitter::Estimate estimate(const json& in, const char* what) {
  hal::jitter::Estimate estimate{.value = in.at(what)};
  const std::string lack = in.at("lack");
  const auto* const found =
      std::ranges::find_if(kLacks, [&lack](hal::jitter::Lack each) { return name(each) == lack; });
  estimate.lack = found == kLacks.end() ? hal::jitter::Lack::unknown : *found;
  if (in.at("low").is_null() || in.at("high").is_null()) return estimate;
  estimate.interval = {.low = in.at("low"), .high = in.at("high")};
  return estimate;
}

constexpr const char* kValue = "value_ns";

json of(const ChannelSummary& channel) {
  json stages = json::object();
  for (const auto& [name, figures] : channel.stages) stages[name] = of(figures);
  return {{"name", channel.name},
          {"headline", channel.headline},
          {"period_ns", channel.period_ns},
          {"frames", channel.frames},
          {"missed", channel.missed},
          {"latency_ns", of(channel.figures)},
          {"uncorrected_ns", of(channel.raw)},
          {"confidence", {{"p50", of(channel.p50, kValue)}, {"p99", of(channel.p99, kValue)}}},
          {"stages_ns", stages},
          {"histogram_ns", channel.buckets},
          {"uncorrected_histogram_ns", channel.raw_buckets},
          {"slices_p50_p99_ns", channel.slices}};
}
ChannelSummary channel(const json& in, int format) {
  ChannelSummary channel{.name = in.at("name"),
                         .headline = in.at("headline"),
                         .period_ns = in.at("period_ns"),
                         .frames = in.at("frames"),
                         .missed = in.at("missed"),
                         .figures = percentiles(in.at("latency_ns")),
                         .raw = percentiles(in.at("uncorrected_ns"))};
  for (const auto& [name, figures] : in.at("stages_ns").items())
    channel.stages.push_back({name, percentiles(figures)});
  in.at("histogram_ns").get_to(channel.buckets);
  in.at("uncorrected_histogram_ns").get_to(channel.raw_buckets);
  in.at("slices_p50_p99_ns").get_to(channel.slices);
  if (format == 1) {
    const auto unknown = [](std::uint64_t value) {
      return hal::jitter::Estimate{.value = static_cast<double>(value),
                                   .lack = hal::jitter::Lack::unknown};
    };
    channel.p50 = unknown(channel.figures.p50);
    channel.p99 = unknown(channel.figures.p99);
  } else {
    channel.p50 = estimate(in.at("confidence").at("p50"), kValue);
    channel.p99 = estimate(in.at("confidence").at("p99"), kValue);
  }
  return channel;
}

json of(const hal::jitter::Conditions& now) {
  return {{"kernel", now.kernel},
          {"preemption", now.preemption},
          {"board", now.board},
          {"processor", now.processor},
          {"processors", now.processors},
          {"governor", now.governor},
          {"temperature_c", now.temperature_c ? json(*now.temperature_c) : json{}},
          {"throttled", now.throttled ? json(*now.throttled) : json{}},
          {"load", now.load}};
}
hal::jitter::Conditions conditions(const json& in) {
  hal::jitter::Conditions then{.kernel = in.at("kernel"),
                               .preemption = in.at("preemption"),
                               .board = in.at("board"),
                               .processor = in.at("processor"),
                               .processors = in.at("processors"),
                               .governor = in.at("governor"),
                               .load = in.at("load")};
  if (!in.at("temperature_c").is_null()) then.temperature_c = in.at("temperature_c").get<double>();
  if (!in.at("throttled").is_null()) then.throttled = in.at("throttled").get<std::uint32_t>();
  return then;
}

json of(const hal::jitter::Usage& usage) {
  return {{"steal_s", usage.steal_s},
          {"busy_s", usage.busy_s},
          {"voluntary_switches", usage.voluntary_switches},
          {"involuntary_switches", usage.involuntary_switches},
          {"minor_faults", usage.minor_faults},
          {"major_faults", usage.major_faults}};
}
hal::jitter::Usage usage(const json& in) {
  return {.steal_s = in.at("steal_s"),
          .busy_s = in.at("busy_s"),
          .voluntary_switches = in.at("voluntary_switches"),
          .involuntary_switches = in.at("involuntary_switches"),
          .minor_faults = in.at("minor_faults"),
          .major_faults = in.at("major_faults")};
}

json of(const std::optional<int>& number) { return number ? json(*number) : json{}; }
std::optional<int> number(const json& in) {
  return in.is_null() ? std::optional<int>{} : in.get<int>();
}

json of(const JitterSettings& settings) {
  return {{"cpu", of(settings.cpu)},
          {"source_cpu", of(settings.source_cpu)},
          {"warm_up", settings.warm_up},
          {"hold_every", settings.hold_every},
          {"hold_ms", settings.hold_ms}};
}
JitterSettings settings(const json& in) {
  return {.cpu = number(in.at("cpu")),
          .source_cpu = number(in.at("source_cpu")),
          .warm_up = in.at("warm_up"),
          .hold_every = in.at("hold_every"),
          .hold_ms = in.at("hold_ms")};
}

}  // namespace

std::string json(const JitterSummary& summary) {
  nlohmann::json channels = nlohmann::json::array();
  for (const ChannelSummary& channel : summary.channels) channels.push_back(of(channel));
  nlohmann::json ratios = nlohmann::json::array();
  for (const RatioSummary& ratio : summary.ratios) {
    ratios.push_back({{"over", ratio.over},
                      {"under", ratio.under},
                      {"p50", of(ratio.p50, "ratio")},
                      {"p99", of(ratio.p99, "ratio")}});
  }
  const nlohmann::json out{
      {"cargobay_jitter", kJitterFormat},
      {"link", summary.link},
      {"seconds", summary.seconds},
      {"scheduler", summary.fifo ? "SCHED_FIFO" : "SCHED_OTHER"},
      {"priority", summary.priority},
      {"memory_locked", summary.memory_locked},
      {"load", summary.load},
      {"settings", summary.settings ? of(*summary.settings) : nlohmann::json{}},
      {"conditions", of(summary.conditions)},
      {"usage", of(summary.usage)},
      {"channels", channels},
      {"ratios", ratios},
  };
  return out.dump(1) + "\n";
}

hal::Result<JitterSummary> read_jitter(const std::string& text, const std::string& label) {
  const std::string remedy = "; such a file is written by: cargobay jitter --json FILE";
  try {
    const nlohmann::json in = nlohmann::json::parse(text);
    const int format = in.at("cargobay_jitter");
    if (format < 1 || format > kJitterFormat)
      return hal::Failure{label + " is from another version of cargobay jitter; measure again"};
    JitterSummary summary{.label = label,
                          .format = format,
                          .link = in.at("link"),
                          .seconds = in.at("seconds"),
                          .fifo = in.at("scheduler") == "SCHED_FIFO",
                          .priority = in.at("priority"),
                          .memory_locked = in.at("memory_locked"),
                          .load = in.at("load"),
                          .conditions = conditions(in.at("conditions")),
                          .usage = usage(in.at("usage"))};
    if (in.contains("settings") && !in["settings"].is_null())
      summary.settings = settings(in["settings"]);
    for (const nlohmann::json& each : in.at("channels"))
      summary.channels.push_back(channel(each, format));
    return summary;
  } catch (const nlohmann::json::exception&) {
    return hal::Failure{label + " is not a result of cargobay jitter" + remedy};
  }
}

}  // namespace cargobay::cli
