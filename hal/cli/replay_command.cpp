// `cargobay replay`: runs the same loop on a recording and compares it bit for bit, or runs another
// estimator on it and compares it in mm/s.

#include <memory>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/cli/commands.hpp"
#include "hal/cli/drive/drive_report.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/in_range.hpp"
#include "hal/cli/terminal/load_recording.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/recording/estimate_again.hpp"
#include "hal/recording/replay.hpp"

namespace cargobay::cli {
namespace {

struct ReplayOptions {
  std::string file;
  std::string json_file;
  std::optional<std::string> remainder{};
  std::optional<double> lag_s{};
  std::optional<double> wheel_base_mm{};

  bool other_estimator() const { return remainder || lag_s || wheel_base_mm; }
};

nlohmann::json json(const hal::ReplayResult& result) {
  nlohmann::json out{{"same", !result.difference.has_value()},
                     {"frames", result.frames},
                     {"commands", result.commands},
                     {"finished", result.end.has_value()}};
  if (result.difference.has_value()) {
    out["difference"] = {{"after_tick", result.difference->tick},
                         {"seconds", rt::seconds(result.difference->since_start)},
                         {"what", result.difference->what},
                         {"recorded", result.difference->recorded},
                         {"replayed", result.difference->replayed}};
  }
  return out;
}

nlohmann::json json(const hal::EstimateDifference& difference) {
  const auto pair = [](const rt::WheelSpeeds& speeds) {
    return nlohmann::json{{"left", speeds.left_mm_s}, {"right", speeds.right_mm_s}};
  };
  return {{"ticks", difference.ticks},
          {"rms_mm_s", pair(difference.rms)},
          {"most_mm_s", pair(difference.most)},
          {"recorded_remainder", name(difference.recorded_belief)},
          {"remainder", name(difference.belief)}};
}

// Writes the results to a file if one was named, and prints the text unless that is standard
// output.
int conclude(const ReplayOptions& options, const nlohmann::json& results, const std::string& text,
             Outputs& outputs) {
  if (options.json_file != "-") fmt::print("{}\n", text);
  const auto done = outputs.write("--json", results.dump(2) + "\n");
  if (done) return kSuccess;
  print_error(done.failure().message);
  return kFailure;
}

int compare_loop(const ReplayOptions& options, const hal::Recording& recording, Outputs& outputs) {
  std::optional<Progress> progress{std::in_place, "replaying"};
  const auto result = hal::replay(recording);
  progress.reset();
  if (!result) {
    print_error(options.file + " " + result.failure().message);
    return kFailure;
  }
  const std::string counted =
      fmt::format("{} frames, {} commands", result->frames, result->commands);
  if (!result->difference)
    return conclude(options, json(*result), counted + ", all identical", outputs);
  (void)conclude(options, json(*result), counted + " are identical, then they differ", outputs);
  const hal::ReplayDifference& first = *result->difference;
  print_error(fmt::format(
      "after tick {} ({:.3f} s) the {} differs: recorded {}, replayed {}; it was recorded by {}",
      first.tick, rt::seconds(first.since_start), first.what, first.recorded, first.replayed,
      recording.header().software));
  return kFailure;
}

int compare_estimate(const ReplayOptions& options, const hal::Recording& recording,
                     Outputs& outputs) {
  rt::WheelEstimator::Parameters parameters = recording.header().parameters.loop.estimator;
  if (options.remainder == "carried") parameters.remainder = rt::Remainder::carried;
  if (options.remainder == "lost") parameters.remainder = rt::Remainder::lost;
  if (options.remainder == "unknown") parameters.remainder.reset();
  parameters.likely_lag_s = options.lag_s.value_or(parameters.likely_lag_s);
  parameters.wheel_base_mm = options.wheel_base_mm.value_or(parameters.wheel_base_mm);
  std::optional<Progress> progress{std::in_place, "estimating again"};
  const hal::EstimateDifference difference = hal::estimate_again(recording, parameters);
  progress.reset();
  return conclude(options, json(difference),
                  fmt::format("{} ticks, estimates differ by {:.2f} / {:.2f} mm/s rms, {:.2f} / "
                              "{:.2f} at most (left / right)\n"
                              "remainder of distance and angle: recorded {}, now {}",
                              difference.ticks, difference.rms.left_mm_s, difference.rms.right_mm_s,
                              difference.most.left_mm_s, difference.most.right_mm_s,
                              name(difference.recorded_belief), name(difference.belief)),
                  outputs);
}

int replay(const ReplayOptions& options) {
  Outputs outputs;
  outputs.protect("the recording", options.file);
  if (const auto done = outputs.open("--json", options.json_file); !done) {
    print_error(done.failure().message);
    return kFailure;
  }
  const auto loaded = load_recording(options.file);
  if (!loaded) {
    print_error(loaded.failure().message);
    return kFailure;
  }
  return options.other_estimator() ? compare_estimate(options, loaded->recording, outputs)
                                   : compare_loop(options, loaded->recording, outputs);
}

}  // namespace

void add_replay(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand(
      "replay",
      "Run the loop again on a recorded drive: on the same bytes at the same times it must send\n"
      "the same commands, and come to the same estimates, to the last bit. Exit status 1 if "
      "it\ndoes not: another version of the program, another machine, or memory that is failing.");
  command
      ->add_option("file", options->file, "A file written by drive --record; - for standard input")
      ->required();
  command->add_option("--json", options->json_file,
                      "Write the results to this file; - for standard output");
  command
      ->add_option("--remainder", options->remainder,
                   "Do not compare the loop; estimate again, as for a robot whose remainder is "
                   "carried or lost, or unknown and to be found out")
      ->check(CLI::IsMember({"carried", "lost", "unknown"}));
  command->add_option("--lag", options->lag_s, "The same, with this lag of the wheels in seconds")
      ->check(in_range(0.001, 10.0));
  command
      ->add_option("--wheel-base", options->wheel_base_mm, "The same, with this wheel base in mm")
      ->check(in_range(1.0, 10000.0));
  command->footer(
      "Examples:\n"
      "  cargobay drive --record drive.rec\n"
      "  cargobay replay drive.rec\n"
      "  cargobay replay drive.rec --lag 0.12");
  command->callback([options, &chosen] { chosen = [options] { return replay(*options); }; });
}

}  // namespace cargobay::cli
