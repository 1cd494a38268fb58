// `cargobay send`: sends commands to a robot by hand, and prints the answers.

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/conversation.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/send_plan.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/in_range.hpp"
#include "hal/cli/terminal/operands.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/sensor_format.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/guard/duty.hpp"
#include "hal/guard/farewell.hpp"
#include "hal/result.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/text/command_text.hpp"
#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

using std::chrono::milliseconds;

struct SendOptions {
  PortOptions connection{};
  double listen_s = 1.0;
  std::optional<double> duration_s{};
  bool leave_running = false;
};

using hal::kModeChangeWait;

constexpr int kNoPriority = 0;
constexpr milliseconds kFirstLook{40};  // whether a stream is under way already

bool may_move(const std::vector<PlannedCommand>& commands) {
  Expectation robot{oi::Mode::full, oi::kCreate.default_baud};
  for (const PlannedCommand& command : commands) robot.take(command);
  return robot.has_moved();
}

rt::Duration seconds(double count) {
  return std::chrono::duration_cast<rt::Duration>(std::chrono::duration<double>{count});
}

hal::Failure no_answer(std::uint32_t baud, bool begins_with_start) {
  return {
      fmt::format("the robot does not answer at {} baud; is it switched on and connected, and "
                  "is this its baud rate? `cargobay bringup` finds it at any{}",
                  baud, begins_with_start ? "" : ". If it is off, begin with: start")};
}

// One run of the command: a robot, and the commands it gets, in order.
class Sending {
 public:
  // All of them outlive it.
  Sending(hal::ByteStream& port, hal::Duty& duty, StopSignals& signals, const SendOptions& options)
      : port_{port}, duty_{duty}, options_{options}, talk_{port, signals} {}

  // Returns the failure that ended it, after the clean-up that a failure needs.
  hal::Result<void> run(const std::vector<PlannedCommand>& commands) {
    hal::Result<void> sent = send_all(commands);
    if (sent) watch();
    if (const auto stopped = stop(); !stopped && sent) sent = stopped;
    pause_stream();
    talk_.end_text();
    if (sent && talk_.hung_up()) sent = hung_up();
    if (port_.baud() != opened_at_ && sent) {
      print_remark(
          fmt::format("the robot now runs at {0} baud; next time: --baud {0}", port_.baud()));
    }
    return sent;
  }
  std::optional<int> signal() const { return talk_.signal(); }

 private:
  static hal::Failure hung_up() { return {"the port hung up; plug it in and start again"}; }

  // Empty if the robot does not answer.
  std::optional<oi::Mode> ask_mode() {
    const auto request = oi::encode(oi::Sensors{oi::PacketId::oi_mode});
    const std::vector<std::uint8_t> reply = talk_.ask(*request, 1);
    if (reply.size() != 1 || reply[0] > static_cast<std::uint8_t>(oi::Mode::full))
      return std::nullopt;
    return oi::Mode{reply[0]};
  }

  hal::Result<void> send_all(const std::vector<PlannedCommand>& commands) {
    if (!talk_.listen(kFirstLook)) return hung_up();
    talk_.set_streaming(talk_.frames() > 0);
    // In Off the robot hears only Start, so that is the one command to send without asking first.
    const bool starts = std::holds_alternative<oi::Start>(commands.front().command);
    if (!starts) {
      const std::optional<oi::Mode> mode = ask_mode();
      if (talk_.signal()) return {};
      if (!mode) return no_answer(port_.baud(), false);
      robot_ = Expectation{*mode, port_.baud()};
    }
    if (auto refused = objection(commands, robot_.mode(), port_.baud()))
      return hal::Failure{std::move(*refused)};
    for (const PlannedCommand& command : commands) {
      if (talk_.signal()) break;
      if (auto sent = send(command); !sent) return sent;
    }
    return {};
  }

  hal::Result<void> send(const PlannedCommand& command) {
    robot_.take(command);  // before it is sent: the robot may have heard it even if sending fails
    if (robot_.motion() == Motion::demo) duty_.expect_demo();
    return std::visit([&](const auto& one) { return send(command, one); }, command.command);
  }

  // Commands without a reply.
  template <typename Command>
  hal::Result<void> send(const PlannedCommand& command, const Command&) {
    if (!talk_.send(command.bytes)) return not_sent();
    if (command.info->change == oi::ModeChange::none) {
      if (!talk_.listen(rt::Duration::zero())) return hung_up();
      return {};
    }
    if (!talk_.listen(kModeChangeWait)) return hung_up();
    if (robot_.motion() == Motion::script) return {};
    return check_mode(command);
  }
  hal::Result<void> send(const PlannedCommand& command, const oi::Sensors& request) {
    return query(command, {request.packet});
  }
  hal::Result<void> send(const PlannedCommand& command, const oi::QueryList& request) {
    return query(command, {request.packets.begin(), request.packets.end()});
  }
  hal::Result<void> send(const PlannedCommand& command, const oi::Stream& request) {
    if (!talk_.send(command.bytes)) return not_sent();
    begin_stream(!request.packets.empty());
    return {};
  }
  hal::Result<void> send(const PlannedCommand& command, const oi::PauseResumeStream& request) {
    if (!talk_.send(command.bytes)) return not_sent();
    begin_stream(request.state == oi::StreamState::resume);
    return {};
  }
  hal::Result<void> send(const PlannedCommand& command, const oi::Baud& request) {
    if (!talk_.send(command.bytes)) return not_sent();
    const std::uint32_t baud = oi::kCreate.baud_rates[request.code];
    if (talk_.change_baud(baud)) return {};
    return hal::Failure{
        fmt::format("the port does not run at {} baud, but the robot does now; "
                    "switch it off and on again",
                    baud)};
  }
  hal::Result<void> send(const PlannedCommand& command, const oi::ShowScript&) {
    std::vector<std::uint8_t> reply = talk_.ask(command.bytes, 1);
    if (reply.size() != 1) return unanswered();
    talk_.set_streaming(false);  // Show Script halts it (OI p. 15)
    const std::vector<std::uint8_t> body = talk_.more_reply(reply[0]);
    if (body.size() != reply[0]) return unanswered();
    reply.insert(reply.begin(), oi::Script::kOpcode);
    reply.insert(reply.end(), body.begin(), body.end());
    std::array<char, oi::kMaxCommandText> text{};
    const std::size_t size = oi::format_command(reply, text);
    fmt::print("{}\n", size != 0 ? std::string_view{text.data(), size}
                                 : std::string_view{"the reply is not a script"});
    return {};
  }

  hal::Result<void> query(const PlannedCommand& command, const std::vector<oi::PacketId>& packets) {
    std::size_t size = 0;
    for (const oi::PacketId packet : packets) size += oi::kCreate.packet(packet).size;
    const std::vector<std::uint8_t> reply = talk_.ask(command.bytes, size);
    if (reply.size() != size) return unanswered();
    std::span<const std::uint8_t> rest{reply};
    for (const oi::PacketId packet : packets) {
      oi::SensorValues values;
      const std::size_t bytes = oi::kCreate.packet(packet).size;
      // The packet is known and complete.
      (void)oi::decode_packet(static_cast<std::uint8_t>(packet), rest.first(bytes), values);
      fmt::print("{}", lines({packet}, values));
      rest = rest.subspan(bytes);
    }
    std::fflush(stdout);
    return {};
  }

  // After a change of mode: checks that the robot is in it.
  hal::Result<void> check_mode(const PlannedCommand& command) {
    const std::optional<oi::Mode> mode = ask_mode();
    if (talk_.signal()) return {};
    if (!mode) return no_answer(port_.baud(), true);
    if (*mode == robot_.mode()) return {};
    return hal::Failure{
        fmt::format("the robot is in {} mode after {} instead of {}; set it on its "
                    "wheels, away from edges, and unplug the charger",
                    oi::name(*mode), command.info->key, oi::name(robot_.mode()))};
  }

  hal::Result<void> unanswered() {
    if (talk_.signal()) return {};
    if (talk_.hung_up()) return hung_up();
    return no_answer(port_.baud(), true);
  }
  hal::Failure not_sent() const {
    return {
        fmt::format("the port accepts no more bytes at {} baud; check the cable, and that the "
                    "robot's end is running",
                    port_.baud())};
  }
  void begin_stream(bool streaming) {
    talk_.set_streaming(streaming);
    if (!streaming) return;
    talk_.show_frames();
    begun_stream_ = true;
  }

  // Prints frames for a while, and for as long as the wheels may turn.
  void watch() {
    const bool holds = robot_.motion() != Motion::none && !options_.leave_running;
    rt::Duration duration =
        talk_.streaming() && begun_stream_ ? seconds(options_.listen_s) : rt::Duration::zero();
    if (holds && !options_.duration_s) {
      duration = std::chrono::hours{24 * 365};
      if (!talk_.signal()) print_remark("the wheels may be turning; Ctrl-C stops them");
    } else if (holds) {
      duration = std::max(duration, seconds(*options_.duration_s));
    }
    const rt::TimePoint begin = port_.now();
    constexpr milliseconds kLook{100};
    for (rt::Duration left = duration; left > rt::Duration::zero() && !output_error();
         left = begin + duration - port_.now()) {
      if (!talk_.listen(std::min<rt::Duration>(left, kLook)) || talk_.signal()) break;
    }
    if (begun_stream_ && talk_.streaming() && talk_.frames() == 0 &&
        port_.now() - begin > milliseconds{200}) {
      print_remark("no frames arrived");
    }
  }

  // Whatever happened before, the wheels must not be left turning.
  hal::Result<void> stop() {
    if (options_.leave_running && robot_.motion() != Motion::none)
      print_remark("the wheels may still be turning, as asked for by --leave-running");
    if (options_.leave_running || robot_.motion() == Motion::none) {
      duty_.waive();
      return {};
    }
    talk_.ignore_signals();
    begun_stream_ = false;  // the farewell ends the stream
    const hal::Discharge left = duty_.discharge();
    if (talk_.hung_up()) return hal::Failure{hung_up().message + hal::fate(left)};
    if (!left.standing()) {
      return hal::Failure{
          "told the wheels to stop, but the robot does not answer; if it is waiting in a script it "
          "is deaf until that ends: press its power button if it moves"};
    }
    print_remark(left.by_guard ? "the guard stopped the wheels" : "stopped the wheels");
    return {};
  }

  void pause_stream() {
    if (!begun_stream_ || !talk_.streaming() || options_.leave_running || talk_.hung_up()) return;
    // A robot that does not hear it is silent anyway.
    (void)talk_.send(*oi::encode(oi::PauseResumeStream{oi::StreamState::pause}));
    (void)port_.drain(milliseconds{100});
  }

  hal::ByteStream& port_;
  hal::Duty& duty_;
  const SendOptions& options_;
  Conversation talk_;
  std::uint32_t opened_at_ = port_.baud();
  Expectation robot_{oi::Mode::off, port_.baud()};
  bool begun_stream_ = false;
};

int send(const CLI::App& command, const SendOptions& options) {
  StopSignals signals;
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  const auto config = configuration(options.connection);
  if (!config) return fail(config.failure());
  if (!has_port(*config)) return kUsageError;
  const auto text = joined_operands(command);
  if (!text) return fail(text.failure());
  const auto bytes = encode_or_explain(*text);
  if (!bytes) return kFailure;
  const std::vector<PlannedCommand> commands = divide(*bytes);
  if (const auto refused = objection(commands, std::nullopt, *config->baud))
    return fail({*refused});
  auto port = open_for_use(config->port, *config->baud);
  if (!port) return fail(port.failure());
  // Without a guard the wheels would keep turning for ever if this program were killed.
  const bool guarded = may_move(commands) && !options.leave_running;
  using Use = hal::GuardOptions::Use;
  auto duty = hal::Duty::begin(**port, {.use = guarded ? Use::required : Use::none}, kNoPriority);
  if (!duty) return fail(duty.failure());
  Sending sending{**port, **duty, signals, options};
  if (const auto sent = sending.run(commands); !sent) return fail(sent.failure());
  return sending.signal() ? kSignalled + *sending.signal() : kSuccess;
}

}  // namespace

void add_send(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<SendOptions>();
  CLI::App* command = app.add_subcommand(
      "send",
      "Send Open Interface commands to a robot and print what it answers: sensor values, stored\n"
      "script, stream frames, text. If they start the wheels it stays until Ctrl-C, then stops "
      "them.");
  take_operands(
      *command, "TEXT...",
      "commands as for `cargobay encode`; `stop` stops the wheels (drive_direct 0 0). Without "
      "TEXT, or\nwith '-': standard input.");
  add_port_options(*command, options->connection);
  command
      ->add_option("--listen", options->listen_s,
                   "Print the frames of a stream for this many seconds")
      ->check(in_range(0.0, 1e6))
      ->capture_default_str();
  command
      ->add_option("--duration", options->duration_s,
                   "Stop the wheels after this many seconds instead of at Ctrl-C")
      ->check(in_range(0.0, 1e6));
  command->add_flag("--leave-running", options->leave_running,
                    "Exit at once and leave wheels and stream as they are");
  command->footer(
      "Examples:\n"
      "  cargobay send --port /dev/ttyUSB0 'start; sensors oi_mode'\n"
      "  cargobay send --port /dev/ttyUSB0 --duration 2 'start; safe; drive 200 straight'\n"
      "  cargobay send --port /dev/ttyUSB0 --listen 5 'stream distance angle'");
  command->callback([options, command, &chosen] {
    chosen = [options, command] { return send(*command, *options); };
  });
}

}  // namespace cargobay::cli
