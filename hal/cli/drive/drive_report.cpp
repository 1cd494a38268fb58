#include "hal/cli/drive/drive_report.hpp"

#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/cli/connect/findings.hpp"
#include "hal/cli/drive/drive_events.hpp"

namespace cargobay::cli {
namespace {

double milliseconds(std::uint64_t ns) { return static_cast<double>(ns) / 1e6; }

void put_wheels(std::string& out, const DriveFigures& figures) {
  const auto row = [&](std::string_view what, double left, double right) {
    fmt::format_to(std::back_inserter(out), "  {:<34}{:>10.1f}{:>10.1f}  mm/s\n", what, left,
                   right);
  };
  const WheelFigures& l = figures.left;
  const WheelFigures& r = figures.right;
  fmt::format_to(std::back_inserter(out), "{:<36}{:>10}{:>10}\n", "Wheel speed", "left", "right");
  row("set, mean", l.mean_set_mm_s, r.mean_set_mm_s);
  row("estimated, mean", l.mean_estimate_mm_s, r.mean_estimate_mm_s);
  if (figures.has_truth) row("true, mean", l.mean_truth_mm_s, r.mean_truth_mm_s);
  const std::string_view witness = figures.has_truth ? "true" : "estimated";
  if (figures.has_steady)
    row(fmt::format("steady error ({} - set)", witness), l.steady_error_mm_s, r.steady_error_mm_s);
  row(fmt::format("tracking error, rms ({} - set)", witness), l.tracking_rmse_mm_s,
      r.tracking_rmse_mm_s);
  if (figures.has_truth)
    row("estimate error, rms (est. - true)", l.estimate_rmse_mm_s, r.estimate_rmse_mm_s);
}

void put_timing(std::string& out, std::string_view what, const rt::Histogram& histogram) {
  fmt::format_to(std::back_inserter(out), "  {:<34}{:>10.3f}{:>10.3f}{:>10.3f}  ms\n", what,
                 milliseconds(histogram.percentile(50)), milliseconds(histogram.percentile(99)),
                 milliseconds(histogram.max()));
}

std::string rights(const rt::RealtimeGrant& grant) {
  std::string out = grant.fifo ? fmt::format("SCHED_FIFO priority {}", grant.priority)
                               : "ordinary scheduling (SCHED_OTHER)";
  out += ", " + rt::describe_memory(grant);
  if (grant.cpu.has_value()) out += fmt::format(", CPU {}", *grant.cpu);
  return out;
}

// With one standard deviation.
void put_learnt(std::string& out, const DriveReport& report) {
  if (!report.learnt) return;
  const rt::LearntPlant& it = *report.learnt;
  const auto to_out = std::back_inserter(out);
  fmt::format_to(to_out, "Learnt     lag {:.0f} +- {:.0f} ms, dead time {:.0f} +- {:.0f} ms, ",
                 1e3 * it.lag_s, 1e3 * it.lag_sd_s, 1e3 * it.dead_time_s, 1e3 * it.dead_time_sd_s);
  // A ramp this steep cannot be told from none.
  constexpr double kNoRampS2Mm = 1.0 / 3000.0;
  if (it.ramp_s2_mm < kNoRampS2Mm) {
    out += "no ramp,\n";
  } else {
    fmt::format_to(to_out, "ramp {:.0f} mm/s^2 +- {:.0f} %,\n", 1.0 / it.ramp_s2_mm,
                   1e2 * it.ramp_sd_s2_mm / it.ramp_s2_mm);
  }
  fmt::format_to(to_out,
                 "           gain {:.3f} +- {:.3f} left, {:.3f} +- {:.3f} right; began from {}\n",
                 it.gain_left, it.gain_left_sd, it.gain_right, it.gain_right_sd,
                 report.began_from_earlier ? "what an earlier drive learnt" : "nothing");
}

// Says nothing of what is in order.
void put_findings(std::string& out, const std::vector<hal::Finding>& findings) {
  for (const hal::Finding& finding : findings) {
    if (finding.verdict == hal::Finding::Verdict::good) continue;
    const std::string_view label = finding.verdict == hal::Finding::Verdict::bad ? "Bad" : "Advice";
    fmt::format_to(std::back_inserter(out), "{:<11}{}: {}\n", label, finding.what, finding.remedy);
  }
}

nlohmann::json learnt_json(const DriveReport& report) {
  if (!report.learnt) return {};
  const rt::LearntPlant& it = *report.learnt;
  nlohmann::json file;
  if (!report.learnt_file.empty()) file = report.learnt_file;
  return {{"lag_s", it.lag_s},
          {"lag_sd_s", it.lag_sd_s},
          {"dead_time_s", it.dead_time_s},
          {"dead_time_sd_s", it.dead_time_sd_s},
          {"ramp_s2_mm", it.ramp_s2_mm},
          {"ramp_sd_s2_mm", it.ramp_sd_s2_mm},
          {"gain_left", it.gain_left},
          {"gain_left_sd", it.gain_left_sd},
          {"gain_right", it.gain_right},
          {"gain_right_sd", it.gain_right_sd},
          {"remainder", name(it.remainder)},
          {"log_odds_carried", it.log_odds_carried},
          {"moved_s", it.moved_s},
          {"began_from_earlier", report.began_from_earlier},
          {"file", file}};
}

}  // namespace

std::string name(rt::RemainderBelief belief) {
  switch (belief) {
    case rt::RemainderBelief::unknown: return "unknown";
    case rt::RemainderBelief::carried: return "carried";
    case rt::RemainderBelief::lost: return "lost";
  }
  return "unknown";
}

std::string table(const DriveReport& report) {
  std::string out;
  const auto to_out = std::back_inserter(out);
  put_wheels(out, report.figures);
  fmt::format_to(to_out, "{:<36}{:>10}{:>10}{:>10}\n", "Timing", "p50", "p99", "max");
  put_timing(out, "loop period", *report.period_ns);
  put_timing(out, "frame to command", *report.frame_to_command_ns);
  fmt::format_to(to_out, "Frames     {} good, {} bad, {} lost\n", report.frames.good,
                 report.frames.bad, report.frames.lost);
  const hal::PhaseOverruns& late = report.overruns;
  fmt::format_to(to_out, "Overruns   {} wait, {} read, {} control function, {} write\n", late.wait,
                 late.read, late.user, late.write);
  if (report.refused_controls > 0) {
    fmt::format_to(to_out, "Refused    {} results of the control function\n",
                   report.refused_controls);
  }
  if (report.events_dropped > 0) {
    fmt::format_to(to_out, "Events     {} dropped for lack of room\n", report.events_dropped);
  }
  if (report.reconnects > 0)
    fmt::format_to(to_out, "Link       {} reconnected, {:.1f} s without a link\n",
                   report.reconnects, rt::seconds(report.without_link));
  fmt::format_to(to_out, "Robot      {} on {} at {} baud, remainder of distance and angle: {}\n",
                 report.robot, report.port, report.baud, name(report.remainder));
  put_learnt(out, report);
  fmt::format_to(to_out, "Real time  {}\n", rights(report.grant));
  put_findings(out, report.findings);
  return out;
}

std::string json(const DriveReport& report) {
  using nlohmann::json;
  const auto pair = [](double left, double right) {
    return json{{"left", left}, {"right", right}};
  };
  const WheelFigures& l = report.figures.left;
  const WheelFigures& r = report.figures.right;
  json out{
      {"port", report.port},
      {"baud", report.baud},
      {"loop", report.open_loop ? "open" : "closed"},
      {"remainder", name(report.remainder)},
      {"scheduler", report.grant.fifo ? "SCHED_FIFO" : "SCHED_OTHER"},
      {"priority", report.grant.priority},
      {"memory_locked", report.grant.memory_locked},
      {"ticks", report.ticks},
      {"frames_good", report.frames.good},
      {"frames_bad", report.frames.bad},
      {"frames_lost", report.frames.lost},
      {"overruns",
       {{"wait", report.overruns.wait},
        {"read", report.overruns.read},
        {"user", report.overruns.user},
        {"write", report.overruns.write}}},
      {"control_refused", report.refused_controls},
      {"events", json::parse(cli::json(report.events, *report.states))},
      {"events_dropped", report.events_dropped},
      {"reconnects", report.reconnects},
      {"without_link_s", rt::seconds(report.without_link)},
      {"steady_error_mm_s",
       report.figures.has_steady ? pair(l.steady_error_mm_s, r.steady_error_mm_s) : json{}},
      {"tracking_rmse_mm_s", pair(l.tracking_rmse_mm_s, r.tracking_rmse_mm_s)},
      {"period_ns",
       {{"p50", report.period_ns->percentile(50)},
        {"p99", report.period_ns->percentile(99)},
        {"max", report.period_ns->max()}}},
      {"frame_to_command_ns",
       {{"p50", report.frame_to_command_ns->percentile(50)},
        {"p99", report.frame_to_command_ns->percentile(99)},
        {"p999", report.frame_to_command_ns->percentile(99.9)},
        {"max", report.frame_to_command_ns->max()}}},
  };
  out["learnt"] = learnt_json(report);
  out["findings"] = json::parse(cli::json(report.findings));
  if (report.figures.has_truth)
    out["estimate_rmse_mm_s"] = pair(l.estimate_rmse_mm_s, r.estimate_rmse_mm_s);
  return out.dump(2) + "\n";
}

}  // namespace cargobay::cli
