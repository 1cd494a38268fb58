// `cargobay budget`: what a stream costs on the wire, and the control delay that follows.

#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/packet_list.hpp"
#include "hal/cli/terminal/print.hpp"
#include "oi/dialect.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::cli {
namespace {

struct BudgetOptions {
  std::uint32_t baud = oi::kCreate.default_baud;
  std::string packets = "35,19,20";
};

double wire_ms(std::chrono::nanoseconds duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

void print_line(std::string_view what, std::string_view value) {
  fmt::print("{:<42}{:>12}\n", what, value);
}

std::string in_ms(std::chrono::nanoseconds duration) {
  return fmt::format("{:.3f} ms", wire_ms(duration));
}

int budget(const BudgetOptions& options) {
  const auto packets = read_packet_list(options.packets);
  if (!packets) {
    print_error(packets.failure().message);
    return kFailure;
  }
  if (!oi::kCreate.baud_code(options.baud).has_value()) {
    print_error(fmt::format("the robot does not support {} baud; choose from {}", options.baud,
                            fmt::join(oi::kCreate.baud_rates, ", ")));
    return kFailure;
  }
  const std::size_t frame = oi::frame_bytes(*packets);
  const bool fits = oi::fits(*packets, options.baud);
  print_line("Frame", fmt::format("{} bytes", frame));
  print_line(fmt::format("Room in a 15 ms tick at {} baud", options.baud),
             fmt::format("{} bytes", oi::bytes_per_tick(options.baud)));
  print_line("Fits", fits ? "yes" : "no");
  print_line("Frame on the wire", in_ms(oi::wire_time(frame, options.baud)));
  print_line("Drive Direct on the wire (5 bytes)",
             in_ms(oi::command_time(oi::kDriveDirectBytes, options.baud)));
  for (const auto& [board, half_fifo] :
       {std::pair{"Pi 0 to 3 (wakes at 8 bytes)", oi::kPl011HalfFifoPi0To3},
        std::pair{"Pi 4 and 5 (wakes at 16 bytes)", oi::kPl011HalfFifoPi4And5}}) {
    fmt::print("On a PL011, {}:\n", board);
    print_line("  receive time-out after the frame",
               in_ms(oi::pl011_delay(frame, options.baud, half_fifo)));
    print_line("  first sensor bit to last command bit",
               in_ms(oi::control_delay(frame, options.baud, half_fifo)));
  }
  if (fits) return kSuccess;
  print_error(
      fmt::format("{} bytes do not fit; ask for fewer packets or raise the baud rate", frame));
  return kFailure;
}

}  // namespace

void add_budget(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<BudgetOptions>();
  CLI::App* command = app.add_subcommand(
      "budget",
      "Say what a stream costs on the wire: bytes, time, whether it fits the robot's 15 ms tick,\n"
      "and the delay of control that follows. Exit status 1 if it does not fit.");
  command->add_option("--baud", options->baud, "Baud rate")->capture_default_str();
  command
      ->add_option("--packets", options->packets,
                   "Packets by number or name, separated by commas; the default is the loop's own")
      ->capture_default_str();
  command->footer("Example: cargobay budget --baud 19200 --packets 6");
  command->callback([options, &chosen] { chosen = [options] { return budget(*options); }; });
}

}  // namespace cargobay::cli
