// `cargobay doctor`: what spoils real time or the link, and what to do about it.

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/cli/commands.hpp"
#include "hal/cli/connect/findings.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/doctor/doctor.hpp"

namespace cargobay::cli {
namespace {

struct DoctorOptions {
  std::string port;
  int priority = rt::RealtimeRequest{}.priority;
  std::string json_file;
};

std::string report(const std::vector<hal::Finding>& findings) {
  const nlohmann::json out{{"ok", hal::all_well(findings)},
                           {"findings", nlohmann::json::parse(json(findings))}};
  return out.dump(2) + "\n";
}

void print(const std::vector<hal::Finding>& findings) {
  for (const hal::Finding& finding : findings) {
    constexpr std::size_t kIndent = 20;
    const std::size_t columns = terminal_columns(STDOUT_FILENO);
    const std::string what =
        fmt::format("{:<7} {:<11} {}\n", hal::name(finding.verdict), finding.check, finding.what);
    fmt::print("{}", wrapped(what, columns, kIndent));
    if (finding.remedy.empty()) continue;
    fmt::print("{}\n", wrapped(std::string(kIndent, ' ') + finding.remedy, columns, kIndent));
  }
}

int run_doctor(const DoctorOptions& options) {
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  Outputs outputs;
  if (const auto done = outputs.open("--json", options.json_file); !done)
    return fail(done.failure());
  const std::vector<hal::Finding> findings =
      cli::examine(options.port, rt::RealtimeRequest{.priority = options.priority});
  if (options.json_file != "-") print(findings);
  if (const auto done = outputs.write("--json", report(findings)); !done)
    return fail(done.failure());
  return hal::all_well(findings) ? kSuccess : kFailure;
}

}  // namespace

void add_doctor(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand(
      "doctor",
      "Look for what spoils real time or the link on this machine, and say what to do about "
      "it.\nChanges nothing. Exit status 1 if something is bad; advice does not count.");
  command->add_option("--port", options->port,
                      "Check this serial port too, and which processes have it open");
  command->add_option("--priority", options->priority, "SCHED_FIFO priority of the loop")
      ->check(CLI::Range(1, 98))
      ->capture_default_str();
  command->add_option("--json", options->json_file,
                      "Write the findings to this file; - for standard output");
  command->callback([options, &chosen] { chosen = [options] { return run_doctor(*options); }; });
}

}  // namespace cargobay::cli
