// `cargobay export`: a recorded drive in files that other programs read.

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/load_recording.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/export/mcap_export.hpp"
#include "hal/export/retelling.hpp"
#include "hal/export/text_export.hpp"

namespace cargobay::cli {
namespace {

struct ExportOptions {
  std::string file;
  std::string csv_file;
  std::string json_lines_file;
  std::string mcap_file;
  std::vector<std::string> topics;
};

std::vector<std::string> topic_names() {
  std::vector<std::string> names;
  names.reserve(hal::kTopics);
  for (std::size_t i = 0; i < hal::kTopics; ++i)
    names.emplace_back(name(static_cast<hal::Topic>(i)));
  return names;
}

hal::Topics topics(const ExportOptions& options) {
  hal::Topics chosen;
  for (std::size_t i = 0; i < hal::kTopics; ++i) {
    const auto topic = static_cast<hal::Topic>(i);
    for (const std::string& wanted : options.topics) {
      if (wanted == name(topic)) chosen = chosen.with(topic);
    }
  }
  return chosen.any() ? chosen : hal::kAllTopics;
}

// One of the files, or standard output.
class Destination {
 public:
  Destination(std::string_view key, const std::string& path, Outputs& outputs)
      : path_{path}, file_{outputs.take(key)} {}

  const std::string& path() const { return path_; }
  hal::Result<void> write(std::string_view bytes) {
    if (file_) return file_->write(bytes);
    (void)std::fwrite(bytes.data(), 1, bytes.size(), stdout);  // output_error() has the result
    const std::error_code error = output_error();
    if (error) return hal::Failure{"cannot write to standard output", error};
    return {};
  }
  hal::Result<void> publish() { return file_ ? file_->publish() : hal::Result<void>{}; }
  bool is_standard_output() const { return !file_; }

 private:
  std::string path_;
  std::optional<hal::OutputFile> file_;
};

// All of the files at once.
class Exports final : public hal::RecordSink {
 public:
  // Those that the options name and `outputs` has opened.
  Exports(const ExportOptions& options, const hal::RecordingHeader& header, Outputs& outputs) {
    const hal::Topics chosen = topics(options);
    if (hal::WriteBytes write = destination("--csv", options.csv_file, outputs))
      all_.push_back(hal::csv_export(chosen, std::move(write)));
    if (hal::WriteBytes write = destination("--jsonl", options.json_lines_file, outputs))
      all_.push_back(hal::json_lines_export(chosen, std::move(write)));
    if (hal::WriteBytes write = destination("--mcap", options.mcap_file, outputs)) {
      all_.push_back(
          hal::mcap_export(chosen, header, "cargobay " CARGOBAY_VERSION, std::move(write)));
    }
  }
  void take(const hal::StateRecord& record) override { pass(record); }
  void take(const hal::SensorRecord& record) override { pass(record); }
  void take(const hal::EventRecord& record) override { pass(record); }
  void take(const hal::CommandRecord& record) override { pass(record); }
  bool wants_more() const override {
    return std::ranges::all_of(all_, [](const auto& one) { return one->wants_more(); });
  }
  // The first failure.
  hal::Result<void> finish() {
    for (const auto& one : all_) {
      if (const auto done = one->finish(); !done) return done;
    }
    (void)std::fflush(stdout);
    for (const auto& one : destinations_) {
      if (const auto done = one->publish(); !done) return done;
    }
    return {};
  }
  const std::vector<std::unique_ptr<Destination>>& destinations() const { return destinations_; }

 private:
  hal::WriteBytes destination(std::string_view key, const std::string& path, Outputs& outputs) {
    if (path.empty()) return {};
    destinations_.push_back(std::make_unique<Destination>(key, path, outputs));
    return [to = destinations_.back().get()](std::string_view bytes) { return to->write(bytes); };
  }
  template <typename Record>
  void pass(const Record& record) {
    for (const auto& one : all_) one->take(record);
  }

  std::vector<std::unique_ptr<Destination>> destinations_{};  // outlive the exports
  std::vector<std::unique_ptr<hal::Export>> all_{};
};

hal::Result<void> open_outputs(const ExportOptions& options, Outputs& outputs) {
  outputs.protect("the recording", options.file);
  if (auto done = outputs.open("--csv", options.csv_file); !done) return done;
  if (auto done = outputs.open("--jsonl", options.json_lines_file); !done) return done;
  if (options.mcap_file == "-" && stdout_is_terminal())
    return hal::Failure{"--mcap - is for a pipe or a file: MCAP is binary, not text"};
  return outputs.open("--mcap", options.mcap_file);
}

// What of the drive could not be told.
void remark_on(const hal::Retelling& told) {
  if (told.counts.partial_states == 0) return;
  const std::string why =
      told.difference
          ? fmt::format("at {:.3f} s this program differs from the one that recorded it ({})",
                        rt::seconds(told.difference->since_start), told.difference->what)
          : std::string{"blocks before them are missing"};
  print_remark(fmt::format(
      "{} of {} states have only what is recorded, without odometry, hazards and limits, and there "
      "are no events for them: {}",
      told.counts.partial_states, told.counts.states, why));
}

void summarise(const hal::Narrator::Counts& counts, const Exports& exports) {
  std::string files;
  for (const auto& one : exports.destinations()) {
    if (one->is_standard_output()) return;
    files += (files.empty() ? "" : ", ") + one->path();
  }
  fmt::print("Exported {} states, {} sensor frames, {} events and {} commands to {}\n",
             counts.states, counts.sensors, counts.events, counts.commands, files);
}

int export_drive(const ExportOptions& options) {
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  Outputs outputs;
  if (const auto done = open_outputs(options, outputs); !done) return fail(done.failure());
  const auto loaded = load_recording(options.file);
  if (!loaded) return fail(loaded.failure());
  Exports exports{options, loaded->recording.header(), outputs};
  std::optional<Progress> progress{std::in_place, "exporting"};
  const hal::Retelling told = hal::retell(loaded->recording, exports);
  const auto done = exports.finish();
  progress.reset();
  // What is wrong with standard output is said at the end of the program.
  if (!done) return output_error() ? kFailure : fail(done.failure());
  remark_on(told);
  summarise(told.counts, exports);
  return kSuccess;
}

}  // namespace

void add_export(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export",
      "Write a recorded drive for other programs: the state of the loop at each frame, the "
      "sensors\n"
      "that came, the events, and the commands that were sent. Name one format or several.");
  command
      ->add_option("file", options->file, "A file written by drive --record; - for standard input")
      ->required();
  command->add_option("--csv", options->csv_file,
                      "CSV, for spreadsheets, pandas and PlotJuggler: one header, a row for each "
                      "record, named in the first column; - for standard output");
  command->add_option("--jsonl", options->json_lines_file,
                      "A JSON object in each line, for jq and scripts; - for standard output");
  command->add_option("--mcap", options->mcap_file,
                      "MCAP, for Foxglove: its panels show the pose, the way and the log without "
                      "being set up; - for standard output");
  command->add_option("--topics", options->topics, "Only these, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(topic_names()));
  command->footer(
      "Examples:\n"
      "  cargobay drive --profile square --record square.rec\n"
      "  cargobay export square.rec --mcap square.mcap\n"
      "  cargobay export square.rec --csv - --topics states | head -3\n"
      "  cargobay export square.rec --jsonl - --topics events | jq .text\n"
      "Columns, units and meanings are listed in docs/recording.md; numpy arrays of any of these "
      "files\n"
      "come from cargobay.tables in Python.");
  command->callback([options, &chosen] {
    if (options->csv_file.empty() && options->json_lines_file.empty() &&
        options->mcap_file.empty()) {
      throw CLI::RequiredError{"--csv FILE, --jsonl FILE or --mcap FILE"};
    }
    chosen = [options] { return export_drive(*options); };
  });
}

}  // namespace cargobay::cli
