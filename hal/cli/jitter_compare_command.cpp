// `cargobay jitter compare`: results of several runs side by side.
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/drawing/picture.hpp"
#include "hal/cli/jitter/jitter_comparison.hpp"
#include "hal/cli/jitter/jitter_plot.hpp"
#include "hal/cli/jitter/jitter_summary.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/operands.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"

namespace cargobay::cli {
namespace {

hal::Result<JitterSummary> load_summary(const std::string& path) {
  const auto text = read_all(path);
  if (!text) return text.failure();
  return read_jitter(*text, path);
}

int run_compare(const std::vector<std::string>& files, const std::string& plot_file) {
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  if (const auto good = check_picture_name("--plot", plot_file); !good) return fail(good.failure());
  Outputs outputs;
  for (const std::string& file : files) outputs.protect("a file to be compared", file);
  if (const auto done = outputs.open("--plot", plot_file); !done) return fail(done.failure());
  std::vector<JitterSummary> all;
  for (const std::string& file : files) {
    auto summary = load_summary(file);
    if (!summary) return fail(summary.failure());
    all.push_back(std::move(*summary));
  }
  fmt::print("{}", comparison(all));
  if (plot_file.empty()) return kSuccess;
  const auto drawing = picture(jitter_plot(all, "Timing jitter, compared"), plot_file);
  if (!drawing) return fail(drawing.failure());
  const auto done = outputs.write("--plot", *drawing);
  return done ? kSuccess : fail(done.failure());
}

}  // namespace

void add_jitter_compare(CLI::App& jitter, Action& chosen) {
  CLI::App* command = jitter.add_subcommand(
      "compare",
      "Put results side by side, each against the first: the ratios of the figures shown, with "
      "95 % confidence\nintervals if there are enough data for one. Ratios whose intervals do not "
      "contain 1 differ by more than chance.\nSays what else was different: kernel, load, "
      "governor, processor and more.");
  auto files = std::make_shared<std::vector<std::string>>();
  auto plot = std::make_shared<std::string>();
  command->add_option("FILE", *files, "Results written by --json")->required()->expected(2, 16);
  command->add_option("--plot", *plot,
                      "Draw all of them into this file: SVG, or PNG if it ends in .png");
  command->callback(
      [files, plot, &chosen] { chosen = [files, plot] { return run_compare(*files, *plot); }; });
}

}  // namespace cargobay::cli
