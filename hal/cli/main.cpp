// The command `cargobay`.

#include <csignal>
#include <cstdio>
#include <exception>
#include <sstream>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/standard_streams.hpp"

namespace {

namespace cli = cargobay::cli;

// Output to a file or a pipe may only now turn out to be unwritable.
int after_output(int code) {
  (void)std::fflush(stdout);  // never fails; output_error() reports the result
  const std::error_code error = cli::output_error();
  const bool ended_by_it = code == cli::kSignalled + SIGPIPE;
  if (!error || (code != cli::kSuccess && !ended_by_it)) return code;
  cli::print_error("cannot write to standard output: " + error.message());
  return cli::kFailure;
}

int run(int argc, char** argv) {
  CLI::App app{
      "Cargobay: real-time control of the iRobot Create, and a virtual Create to try it on.",
      "cargobay"};
  app.set_version_flag("--version", "cargobay " CARGOBAY_VERSION);
  app.require_subcommand(1);
  app.footer(
      "`cargobay COMMAND --help` explains each command. Without a robot, start with: cargobay "
      "drive");
  cli::Action chosen;
  cli::add_drive(app, chosen);
  cli::add_replay(app, chosen);
  cli::add_plot(app, chosen);
  cli::add_calibrate(app, chosen);
  cli::add_bringup(app, chosen);
  cli::add_ports(app, chosen);
  cli::add_pins(app, chosen);
  cli::add_doctor(app, chosen);
  cli::add_jitter(app, chosen);
  cli::add_sim(app, chosen);
  cli::add_sensors(app, chosen);
  cli::add_budget(app, chosen);
  cli::add_send(app, chosen);
  cli::add_encode(app, chosen);
  cli::add_decode(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {  // --help, --version
    std::ostringstream text;
    const int code = app.exit(wish, text, text);
    fmt::print("{}", text.str());
    return after_output(code);
  } catch (const CLI::ParseError& error) {
    cli::print_error(std::string{error.what()} + "; see: cargobay --help");
    return cli::kUsageError;
  }
  return after_output(chosen());
}

}  // namespace

int main(int argc, char** argv) {
  if (!cargobay::cli::open_standard_descriptors()) return cargobay::cli::kFailure;
  cargobay::cli::rely_on_standard_streams();
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    cargobay::cli::print_error(error.what());
    return cargobay::cli::kFailure;
  }
}
