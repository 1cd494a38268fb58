// `cargobay send`: sends commands to a robot by hand, and prints the answers.

#include <poll.h>
#include <unistd.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/bring_up/other_end.hpp"
#include "hal/cli/commands.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/send/listening.hpp"
#include "hal/cli/send/send_plan.hpp"
#include "hal/cli/send/sending.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/in_range.hpp"
#include "hal/cli/terminal/operands.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/guard/duty.hpp"
#include "hal/result.hpp"
#include "oi/dialect.hpp"
#include "oi/text/command_text.hpp"
#include "oi/text/song.hpp"

namespace cargobay::cli {
namespace {

constexpr int kNoPriority = 0;

struct Options {
  PortOptions connection{};
  SendOptions sending{};
  std::optional<double> listen_s{};
};

bool may_move(const std::vector<PlannedCommand>& commands) {
  Expectation robot{oi::Mode::full, oi::kCreate.default_baud};
  for (const PlannedCommand& command : commands) robot.take(command);
  return robot.has_moved();
}

int report(const Sent& sent) {
  if (!sent) {
    print_error(sent.failure().message);
    return kFailure;
  }
  return *sent ? kSignalled + **sent : kSuccess;
}

bool has_words(const std::string& text) {
  return text.find_first_not_of(" \t\r\n;") != std::string::npos;
}

// Whether standard input has a text, or is at its end: not a terminal, and not a pipe that is only
// open, as under ssh.
bool input_speaks() {
  constexpr int kPatienceMs = 300;
  if (isatty(STDIN_FILENO) == 1) return false;
  pollfd waited{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (poll(&waited, 1, kPatienceMs) != 0) return true;
  print_remark(
      "standard input says nothing: only listening; to wait for its commands, end with: -");
  return false;
}

// The text of the commands; nothing if only listening is wanted: --listen, and nothing to send.
hal::Result<std::optional<std::string>> text_to_send(const CLI::App& command,
                                                     const Options& options) {
  const bool listens = options.listen_s.has_value() && command.remaining().empty();
  if (listens && !input_speaks()) return std::optional<std::string>{};
  auto text = joined_operands(command);
  if (!text) return text.failure();
  if (listens && !has_words(*text)) return std::optional<std::string>{};
  return std::optional{*text};
}

// For tunes longer than a song.
void say_how_to_play(const std::vector<PlannedCommand>& commands) {
  std::string play;
  std::size_t songs = 0;
  for (const PlannedCommand& command : commands) {
    const auto* song = command.is_raw() ? nullptr : std::get_if<oi::Song>(&command.command);
    if (song == nullptr) continue;
    const double time_s = oi::duration(song->notes).value / 64.0;
    play += fmt::format("{}play {} ({:.2f} s)", songs == 0 ? "" : ", then ", song->slot, time_s);
    ++songs;
  }
  if (songs > 1) print_remark("the songs: " + play + "; a robot that plays ignores the next play");
}

int send(const CLI::App& command, const Options& options) {
  StopSignals signals;
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  const auto config = configuration(options.connection);
  if (!config) return fail(config.failure());
  const auto text = text_to_send(command, options);
  if (!text) return fail(text.failure());
  std::vector<PlannedCommand> commands;
  if (*text) {
    const auto bytes = encode_or_explain(**text, oi::Beyond::manual);
    if (!bytes) return kFailure;
    commands = divide(*bytes);
  }
  if (const auto refused = objection(commands, std::nullopt, *config->baud))
    return fail({*refused});
  const auto chosen = find_plain_robot(*config);  // outlives the port
  if (!chosen) return fail(chosen.failure());
  auto port = open_plain(*chosen, *config->baud);
  if (!port) return fail(port.failure());
  if (commands.empty()) return report(listen_only(**port, signals, *options.listen_s));
  // Without a guard the wheels would keep turning for ever if this program were killed.
  const bool guarded = may_move(commands) && !options.sending.leave_running;
  using Use = hal::GuardOptions::Use;
  auto duty = hal::Duty::begin(**port, {.use = guarded ? Use::required : Use::none}, kNoPriority);
  if (!duty) return fail(duty.failure());
  SendOptions sending = options.sending;
  sending.listen_s = options.listen_s.value_or(sending.listen_s);
  const Sent sent = send_commands(**port, **duty, signals, sending, commands);
  if (!sent) {
    std::optional<Progress> progress{std::in_place, "looking at what is there"};
    const hal::Failure why = hal::name_other_end(**port, sent.failure(), StopSignals::came);
    progress.reset();
    return fail(why);
  }
  say_how_to_play(commands);
  return report(sent);
}

}  // namespace

void add_send(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "send",
      "Send Open Interface commands to a robot and print what it answers: sensor values, stored\n"
      "script, stream frames, text. If they start the wheels it stays until Ctrl-C, then stops "
      "them.\nWhile a script that it started waits, it waits too: the robot is deaf till then.\n"
      "Without --port, to a virtual Create of its own, which is off at first.");
  take_operands(
      *command, "TEXT...",
      "commands as for `cargobay encode`; `stop` stops the wheels in any mode: by drive_direct 0 "
      "0, or in\nPassive, where only a demo turns them, by ending that. Without TEXT, or with '-': "
      "standard input.\nWith --listen and nothing to send: only listen.");
  add_port_options(*command, options->connection);
  command
      ->add_option("--listen", options->listen_s,
                   "Print the frames of a stream for this many seconds [1]; without commands: all "
                   "that arrives")
      ->check(in_range(0.0, 1e6));
  command
      ->add_option("--duration", options->sending.duration_s,
                   "Stop the wheels after this many seconds instead of at Ctrl-C")
      ->check(in_range(0.0, 1e6));
  command->add_flag("--leave-running", options->sending.leave_running,
                    "Exit at once and leave wheels and stream as they are");
  command->footer(
      "Examples:\n"
      "  cargobay send --port /dev/ttyUSB0 'start; sensors oi_mode'\n"
      "  cargobay send --port /dev/ttyUSB0 --duration 2 'start; safe; drive 200 straight'\n"
      "  cargobay send --port /dev/ttyUSB0 --listen 5 'stream distance angle'\n"
      "  cargobay send --port /dev/ttyUSB0 --listen 60\n"
      "  cargobay send --port /dev/ttyUSB0 'start; safe; tune 0 joy:d=4,o=5,b=120:e,e,f,g; play "
      "0'\n"
      "  cargobay send --port /dev/ttyUSB0 'bytes 142 35; firmware_date'");
  command->callback([options, command, &chosen] {
    chosen = [options, command] { return send(*command, *options); };
  });
}

}  // namespace cargobay::cli
