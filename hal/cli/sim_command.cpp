// `cargobay sim`: a virtual Create on a pseudo-terminal, for any Open Interface client.

#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/exit_codes.hpp"
#include "hal/cli/print.hpp"
#include "hal/cli/signals.hpp"
#include "hal/cli/sim_options.hpp"
#include "hal/sim/server.hpp"
#include "oi/baud.hpp"

namespace cargobay::cli {
namespace {

struct Options {
  SimOptions sim{};
  std::string link;
  std::uint32_t boot_baud = oi::kDefaultBaud;
  std::size_t batch_bytes = hal::sim::ServerOptions{}.batch_bytes;
  int priority = 0;
};

int serve(const Options& options) {
  StopSignals signals;
  hal::sim::Parameters robot = parameters(options.sim);
  robot.boot_baud = options.boot_baud;
  if (!oi::baud_code(options.boot_baud).has_value()) {
    print_error(fmt::format("the robot has no {} baud; choose 57600 or 19200", options.boot_baud));
    return kFailure;
  }
  auto server = hal::sim::Server::open(
      robot,
      {.link = options.link, .priority = options.priority, .batch_bytes = options.batch_bytes});
  if (!server) {
    print_error(server.failure().message);
    return kFailure;
  }
  if (const std::error_code error = (*server)->start(); error) {
    print_error("cannot start the virtual Create: " + error.message());
    return kFailure;
  }
  if ((*server)->priority_error() != 0) {
    print_remark("SCHED_FIFO refused: run as root or grant CAP_SYS_NICE; serving without");
  }
  fmt::print("listening on {}\n", options.link.empty() ? (*server)->path() : options.link);
  std::fflush(stdout);
  while (!signals.wait(std::chrono::hours{1}).has_value()) {
  }
  (*server)->stop();
  return kSuccess;
}

}  // namespace

void add_sim(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("sim",
                         "Serve a virtual Create on a pseudo-terminal until Ctrl-C.\n"
                         "Prints `listening on PATH`; open PATH with any Open Interface client as "
                         "if it were a serial port.");
  command->add_option("--link", options->link,
                      "Make this symbolic link to the pseudo-terminal, and print it instead");
  command
      ->add_option("--boot-baud", options->boot_baud,
                   "Baud rate at power-on: 57600, or 19200 as with Play held down")
      ->capture_default_str();
  command
      ->add_option("--batch", options->batch_bytes,
                   "Hand bytes over to the client in batches of at most so many, as a UART's FIFO "
                   "does; 1: each by itself")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_option("--priority", options->priority, "Ask for this SCHED_FIFO priority; 0: none")
      ->check(CLI::Range(0, 98))
      ->capture_default_str();
  add_sim_options(*command, options->sim);
  command->callback([options, &chosen] { chosen = [options] { return serve(*options); }; });
}

}  // namespace cargobay::cli
