// `cargobay top`: what a robot and the loop that drives it are doing, live.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/drive/drive_options.hpp"
#include "hal/cli/live/own_robot.hpp"
#include "hal/cli/live/top_view.hpp"
#include "hal/cli/live/typed.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/cli/view/screen.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr rt::Duration kTopRefresh = std::chrono::milliseconds{200};
constexpr rt::Duration kLineEvery = std::chrono::seconds{1};
constexpr const char* kTopMessages =
    R"({"do":"subscribe","types":["state","sensors","statistics","truth"],"every":8})";

bool is_end(std::string_view keys) { return keys.find_first_of("qQ") != std::string_view::npos; }

// Until a signal, a q, or the feed's end.
hal::Result<void> watch(hal::FeedReader& reader, StopSignals& signals) {
  FeedNews news;
  if (const auto asked = reader.ask(kTopMessages); !asked) return asked;
  const std::unique_ptr<Screen> screen = Screen::open(ControlZ::suspends);
  const rt::Duration period = screen ? kTopRefresh : kLineEvery;
  rt::TimePoint next = rt::Clock::now() + kTopRefresh;  // by then something has come
  while (!signals.wait(rt::Duration::zero()).has_value() && !output_error()) {
    if (const auto taken = take_news(reader, news, {}); !taken) return taken;
    if (screen && is_end(typed())) break;
    const bool now = screen && screen->attend();
    if (now || rt::Clock::now() >= next) {
      next = rt::Clock::now() + period;
      if (screen) {
        screen->draw(top_view(news, HeldMessages::so_far(), screen->size()));
      } else {
        fmt::print("{}\n", top_line(news));
        (void)std::fflush(stdout);
      }
    }
    // Not later than a signal may wait.
    wait_for_input(reader, -1, std::min(next, rt::Clock::now() + kTopRefresh));
  }
  return {};
}

int top(const DriveOptions& options) {
  StopSignals signals;
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  auto attached = attach(options, "cargobay top");
  if (!attached) return fail(attached.failure());
  const auto watched = watch(attached->reader, signals);
  if (attached->own) {
    if (const auto ended = attached->own->end(); !ended) return fail(ended.failure());
  }
  return watched ? kSuccess : fail(watched.failure());
}

}  // namespace

void add_top(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<DriveOptions>();
  CLI::App* command = app.add_subcommand(
      "top",
      "Show what a robot and the loop that drives it are doing: wheels, pose, hazards, sensors,\n"
      "events, latency; on a terminal live, otherwise a line each second.\n"
      "Reads the feed of the process that drives the robot; without --port, of the only one there\n"
      "is. If nothing drives it, this does: the robot is brought up, and stands. Without --port,\n"
      "that is a virtual Create of its own. q ends it.");
  add_port_options(*command, options->connection);
  command->footer(
      "Examples:\n"
      "  cargobay drive --port /dev/ttyUSB0 --duration 600 &\n"
      "  cargobay top --port /dev/ttyUSB0");
  command->callback([options, &chosen] { chosen = [options] { return top(*options); }; });
}

}  // namespace cargobay::cli
