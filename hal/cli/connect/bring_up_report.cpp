#include "hal/cli/connect/bring_up_report.hpp"

#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "oi/value_names.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

double milliseconds(rt::Duration duration) { return 1e3 * rt::seconds(duration); }

std::string widths(const gpio::PlayReport& played) {
  std::string text;
  for (const gpio::PlayedPulse& pulse : played.pulses()) {
    text += fmt::format("{}{:.1f} {}", text.empty() ? "" : ", ", milliseconds(pulse.lasted),
                        pulse.wanted.level == gpio::Level::low ? "low" : "high");
  }
  return text;
}

}  // namespace

std::string line(const hal::BringUpEvent& event) {
  return fmt::format("{:7.3f} s  {:<14} {}\n", rt::seconds(event.time), event.step, event.detail);
}

std::string in_words(const hal::BringUpEvent& event) {
  return fmt::format("bring-up: {}{}{}", event.step, event.detail.empty() ? "" : ", ",
                     event.detail);
}

std::string summary(const BringUpRecord& record, const hal::BringUpReport& report) {
  std::string text = fmt::format("{:7.3f} s  {} mode at {} baud", rt::seconds(report.took),
                                 oi::name(report.mode), record.baud);
  if (report.found_baud != record.baud) text += fmt::format(", found at {}", report.found_baud);
  if (report.battery_mv != 0)
    text += fmt::format(", battery {:.1f} V", static_cast<double>(report.battery_mv) / 1e3);
  text += '\n';
  if (report.brc.count > 0) text += fmt::format("BRC pulses: {} ms\n", widths(report.brc));
  return text;
}

std::string json(const BringUpRecord& record, const hal::Result<hal::BringUpReport>& result) {
  using nlohmann::json;
  json out{{"port", record.port}, {"robot", record.robot}, {"baud", record.baud}};
  out["ok"] = static_cast<bool>(result);
  out["steps"] = json::array();
  for (const hal::BringUpEvent& event : record.steps) {
    out["steps"].push_back(
        {{"time_s", rt::seconds(event.time)}, {"step", event.step}, {"detail", event.detail}});
  }
  if (!result) {
    out["error"] = result.failure().message;
    return out.dump(2) + "\n";
  }
  out["took_s"] = rt::seconds(result->took);
  out["found_baud"] = result->found_baud;
  out["rate_change"] = hal::name(result->rate_change);
  out["powered_on"] = result->powered_on;
  out["resynchronised"] = result->resynchronised;
  out["mode"] = oi::name(result->mode);
  out["battery_mv"] = result->battery_mv != 0 ? json(result->battery_mv) : json{};
  out["brc_pulses"] = json::array();
  for (const gpio::PlayedPulse& pulse : result->brc.pulses()) {
    out["brc_pulses"].push_back({{"level", pulse.wanted.level == gpio::Level::low ? "low" : "high"},
                                 {"wanted_ms", pulse.wanted.duration.count()},
                                 {"lasted_ms", milliseconds(pulse.lasted)}});
  }
  return out.dump(2) + "\n";
}

}  // namespace cargobay::cli
