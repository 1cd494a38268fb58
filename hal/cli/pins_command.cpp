// `cargobay pins`: the GPIO chips and lines of this machine, who holds them, and the level of one.

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "gpio/line.hpp"
#include "hal/cli/commands.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr std::chrono::milliseconds kSlice{50};  // longest time until a signal is noticed

struct PinsOptions {
  gpio::LineAddress watched{};
  bool active_low = false;
  bool as_json = false;
};

// Why the chip cannot be opened.
std::string explain(const gpio::ChipInfo& chip) {
  const bool denied = chip.error == EACCES || chip.error == EPERM;
  gpio::LineError error{.path = chip.path, .group = chip.group, .error = chip.error};
  error.address = {.chip = chip.name, .line = "0"};
  if (denied) error.kind = gpio::LineError::Kind::no_permission;
  return gpio::explain(error);
}

// An object: path, name, and its lines or why it cannot be opened. All lines, by offset.
nlohmann::ordered_json to_json(const gpio::ChipInfo& chip) {
  nlohmann::ordered_json one{{"path", chip.path}, {"name", chip.name}};
  if (chip.error != 0) {
    one["error"] = explain(chip);
    return one;
  }
  one["label"] = chip.label;
  one["lines"] = nlohmann::ordered_json::array();
  for (std::size_t offset = 0; offset < chip.lines.size(); ++offset) {
    const gpio::LineInfo& line = chip.lines[offset];
    nlohmann::ordered_json entry{{"offset", offset}, {"name", line.name}, {"used", line.used}};
    if (line.used) entry["consumer"] = line.consumer;
    one["lines"].push_back(std::move(entry));
  }
  return one;
}

void print(const gpio::ChipInfo& chip) {
  if (chip.error != 0) {
    fmt::print("{}: {}\n", chip.name, explain(chip));
    return;
  }
  fmt::print("{} [{}] {} lines\n", chip.name, chip.label, chip.lines.size());
  for (std::size_t offset = 0; offset < chip.lines.size(); ++offset) {
    const gpio::LineInfo& line = chip.lines[offset];
    if (line.name.empty() && !line.used) continue;  // nothing to report
    fmt::print("{:4}  {:<16}", offset, line.name);
    if (line.used) fmt::print(" used by {}", line.consumer.empty() ? "the kernel" : line.consumer);
    fmt::print("\n");
  }
}

const char* word(gpio::Level level) { return level == gpio::Level::high ? "high" : "low"; }

int watch(const PinsOptions& options) {
  StopSignals signals;
  gpio::LineError error;
  const auto line = gpio::open_input(
      options.watched,
      {.polarity = options.active_low ? gpio::Polarity::inverted : gpio::Polarity::direct,
       .edges = gpio::InputOptions::Edges::both},
      error);
  if (!line) {
    print_error(gpio::explain(error));
    return kFailure;
  }
  if (const auto level = line->level()) fmt::print("{}\n", word(*level));
  rt::TimePoint before = rt::Clock::now();
  for (;;) {
    std::fflush(stdout);
    if (signals.wait(rt::Duration::zero())) return kSuccess;
    const auto edge = line->wait_for_edge(rt::Clock::now() + kSlice);
    if (!edge) continue;
    fmt::print("{} after {:.1f} ms\n", word(edge->level), 1e3 * rt::seconds(edge->time - before));
    before = edge->time;
  }
}

int pins(const PinsOptions& options) {
  if (!options.watched.line.empty()) return watch(options);
  if (!options.watched.chip.empty()) {
    print_error("--chip needs --watch");
    return kUsageError;
  }
  const std::vector<gpio::ChipInfo> found = gpio::chips();
  if (options.as_json) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const gpio::ChipInfo& chip : found) list.push_back(to_json(chip));
    fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return kSuccess;
  }
  for (const gpio::ChipInfo& chip : found) print(chip);
  if (found.empty()) fmt::print("no GPIO chip here (/dev/gpiochip*)\n");
  return kSuccess;
}

}  // namespace

void add_pins(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<PinsOptions>();
  CLI::App* command =
      app.add_subcommand("pins",
                         "List the GPIO chips and their lines, or watch one line until Ctrl-C.\n"
                         "Lines that have no name and are not used are left out.");
  CLI::Option* const watched =
      command->add_option("--watch", options->watched.line,
                          "Print each edge of this line, by offset or name, and the time since the "
                          "last");
  command->add_option("--chip", options->watched.chip, "Its chip, by label or name");
  command->add_flag("--active-low", options->active_low, "The line comes through an inverter");
  command
      ->add_flag("--json", options->as_json,
                 "Print the list as a JSON array, with all lines of each chip")
      ->excludes(watched);
  command->callback([options, &chosen] { chosen = [options] { return pins(*options); }; });
}

}  // namespace cargobay::cli
