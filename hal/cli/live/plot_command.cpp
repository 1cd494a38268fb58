// `cargobay plot`: a drive as a drawing, recorded or under way.

#include <array>
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/drawing/picture.hpp"
#include "hal/cli/drive/drive_log.hpp"
#include "hal/cli/drive/velocity_plot.hpp"
#include "hal/cli/live/live_plot.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/load_recording.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/recording/recording.hpp"

namespace cargobay::cli {
namespace {

struct PlotOptions {
  std::string file;
  std::string output;
  std::optional<std::string> live{};  // a port, or empty for the only feed
  double last_s = 30.0;
};

// Values that are not numbers cannot be drawn.
bool drawable(const hal::CycleState& state) {
  const auto finite = [](const rt::WheelSpeeds& speeds) {
    return std::isfinite(speeds.left_mm_s) && std::isfinite(speeds.right_mm_s);
  };
  return finite(state.set) && finite(state.estimate) && finite(state.command);
}

std::vector<hal::CycleState> states_of(const hal::Recording& recording) {
  std::vector<hal::CycleState> states;
  hal::Entry entry;
  for (hal::EntryCursor cursor{recording.blocks()}; cursor.next(entry);) {
    if (entry.kind == hal::EntryKind::state && drawable(entry.state)) states.push_back(entry.state);
  }
  return states;
}

std::string title(const hal::RecordingHeader& header) {
  const std::time_t seconds = static_cast<std::time_t>(header.started_ns / 1'000'000'000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  const std::size_t size = std::strftime(text.data(), text.size(), "%F %T", &utc);
  return fmt::format("{}, {} UTC", header.note, std::string_view{text.data(), size});
}

int plot(PlotOptions options) {
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  if (options.live.has_value() == !options.file.empty()) {
    print_error("plot takes either a recording or --live; see cargobay plot --help");
    return kUsageError;
  }
  if (options.output.empty() && options.live) options.output = "live.svg";
  if (options.output.empty()) options.output = options.file == "-" ? "-" : options.file + ".svg";
  if (const auto good = check_picture_name("--output", options.output); !good)
    return fail(good.failure());
  if (options.live) {
    const auto plotted =
        plot_live({.port = *options.live, .output = options.output, .last_s = options.last_s});
    return plotted ? kSuccess : fail(plotted.failure());
  }
  Outputs outputs;
  outputs.protect("the recording", options.file);
  if (const auto done = outputs.open("--output", options.output); !done)
    return fail(done.failure());
  const auto loaded = load_recording(options.file);
  if (!loaded) return fail(loaded.failure());
  const std::vector<hal::CycleState> states = states_of(loaded->recording);
  if (states.empty()) return fail({options.file + " holds no frame: there is nothing to draw"});
  const auto drawing =
      picture(velocity_plot(join(states, {}), title(loaded->recording.header()), Intervals::drawn),
              options.output);
  if (!drawing) return fail(drawing.failure());
  if (const auto done = outputs.write("--output", *drawing); !done) return fail(done.failure());
  if (options.output != "-") fmt::print("Drew {} frames in {}\n", states.size(), options.output);
  return kSuccess;
}

}  // namespace

void add_plot(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<PlotOptions>();
  CLI::App* command =
      app.add_subcommand("plot",
                         "Draw a drive, recorded or under way: set, estimated and commanded speed "
                         "of both wheels, and\n"
                         "the time between its frames, in which late and lost ones stand out.");
  command->add_option("file", options->file,
                      "A file written by drive --record; - for standard input");
  command
      ->add_option("--live", options->live,
                   "Draw what a drive of this port does, or of the only one there is: the file is "
                   "written every 2 s, and once more after Ctrl-C or the drive's end")
      ->expected(0, 1)
      ->default_str("")
      ->option_text("[PORT]");
  command
      ->add_option("--seconds", options->last_s, "How much of a drive --live draws: the last of it")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  command->add_option("-o,--output", options->output,
                      "The SVG file, or PNG if it ends in .png; - for standard output "
                      "[FILE.svg, or live.svg]");
  command->footer(
      "Examples:\n"
      "  cargobay drive --profile steps --record steps.rec\n"
      "  cargobay plot steps.rec -o steps.svg\n"
      "  cargobay plot --live /dev/ttyUSB0 --seconds 60 -o live.png");
  command->callback([options, &chosen] { chosen = [options] { return plot(*options); }; });
}

}  // namespace cargobay::cli
