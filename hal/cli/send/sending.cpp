#include "hal/cli/send/sending.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "hal/cli/connect/conversation.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/sensor_format.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/guard/farewell.hpp"
#include "hal/trouble.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/extensions.hpp"
#include "oi/text/command_text.hpp"
#include "oi/text/describe.hpp"
#include "oi/value_names.hpp"

namespace cargobay::cli {
namespace {

using hal::kModeChangeWait;

constexpr std::chrono::milliseconds kFirstLook{40};      // whether a stream is under way already
constexpr std::chrono::milliseconds kLook{100};          // until a signal is noticed
constexpr std::chrono::milliseconds kScriptSpare{3000};  // for its beginning and its end
constexpr rt::Duration kForEver = std::chrono::hours{24 * 365};
constexpr std::chrono::seconds kRestart{5};  // after opcode 7

rt::Duration seconds(double count) {
  return std::chrono::duration_cast<rt::Duration>(std::chrono::duration<double>{count});
}

hal::Failure no_answer(std::uint32_t baud, bool begins_with_start, bool stops = false) {
  const std::string_view more =
      stops ? ". It was told to stop all the same; if it moves, press its power button"
      : begins_with_start ? ""
                          : ". If it is off, begin with: start";
  return {fmt::format("the robot does not answer at {} baud; is it switched on and connected, and "
                      "is this its baud rate? `cargobay bringup` finds it at any{}",
                      baud, more),
          hal::Trouble::silent};
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
    if (sent && !options_.leave_running) sent = await_script(Afterwards::nothing);
    if (sent) watch();
    if (const auto stopped = stop(); !stopped && sent) sent = stopped;
    pause_stream();
    talk_.end_text();
    if (sent && talk_.hung_up()) sent = hung_up();
    // Silence after motion is that of a robot: what it is need not be asked.
    if (!sent && robot_.has_moved()) sent = hal::Failure{sent.failure().message};
    if (port_.baud() != opened_at_ && sent) {
      print_remark(
          fmt::format("the robot now runs at {0} baud; next time: --baud {0}", port_.baud()));
    }
    return sent;
  }
  std::optional<int> signal() const { return talk_.signal(); }

 private:
  static hal::Failure hung_up() { return {"the port hung up; plug it in and start again"}; }

  // Asked first: a robot at another rate makes nothing of this question, but commands of others
  // (tests/hal/bring_up/wrong_rate_test.cpp).
  bool answers() { return !talk_.ask(*oi::encode(oi::Sensors{oi::PacketId::wall}), 1).empty(); }

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
    // Raw bytes are for robots that may not answer at all.
    const bool raw = commands.front().is_raw();
    const bool starts = !raw && std::holds_alternative<oi::Start>(commands.front().command);
    if (!starts && !raw) {
      const bool stops = stops_wheels(commands.front());
      const bool heard = answers();
      if (!heard && stops) (void)send_stop();  // the next answer, or none, shows it
      const auto mode = heard || stops ? ask_mode() : std::nullopt;
      if (talk_.signal()) return {};
      if (!mode) return no_answer(port_.baud(), false, stops);
      robot_ = Expectation{*mode, port_.baud()};
    }
    const std::optional<oi::Mode> known = raw ? std::nullopt : std::optional{robot_.mode()};
    if (auto refused = objection(commands, known, port_.baud()))
      return hal::Failure{std::move(*refused)};
    for (const PlannedCommand& command : commands) {
      if (auto waited = await_script(Afterwards::more); !waited) return waited;
      if (talk_.signal()) break;
      if (auto sent = send(command); !sent) return sent;
    }
    return {};
  }

  hal::Result<void> send(const PlannedCommand& command) {
    robot_.take(command);  // before it is sent: the robot may have heard it even if sending fails
    if (robot_.motion() == Motion::demo) duty_.expect_demo();
    if (command.is_raw()) return send_raw(command.bytes);
    if (stops_wheels(command) && robot_.mode() == oi::Mode::passive) return end_demo();
    return std::visit([&](const auto& one) { return send(command, one); }, command.command);
  }

  // In Passive nothing but a demo turns the wheels, and the robot ignores their speeds.
  hal::Result<void> end_demo() {
    if (!send_stop()) return not_sent();
    if (!talk_.listen(kModeChangeWait)) return hung_up();
    print_remark("the robot is in passive mode: if it ran a demo, that was ended");
    return {};
  }

  // In any mode, and also if it is not heard: a robot at another rate takes one in a hundred of
  // these for something else, more of a farewell.
  bool send_stop() {
    return talk_.send(*oi::encode(oi::DriveDirect{})) &&
           talk_.send(*oi::encode(oi::Demo{oi::DemoNumber::abort})) &&
           talk_.send(*oi::encode(oi::Start{}));
  }

  // Whether commands follow the script.
  enum class Afterwards : std::uint8_t { nothing, more };

  // If a script was started that waits: until it has ended, because the robot is deaf till then.
  hal::Result<void> await_script(Afterwards afterwards) {
    if (!robot_.waits() || talk_.signal()) return {};
    const ScriptWaits waits = *robot_.waits();
    if (!waits.any) {
      robot_.script_ended();
      return {};
    }
    const rt::TimePoint begin = port_.now();
    say_what_it_waits_for(waits);
    const Progress progress{"waiting for the script"};
    rt::Duration longest = waits.duration ? *waits.duration + kScriptSpare : kForEver;
    if (options_.duration_s) longest = std::min(longest, seconds(*options_.duration_s));
    while (port_.now() - begin < longest && !output_error()) {
      const bool heard = ask_mode().has_value();
      awaited_ = port_.now() - begin;
      if (talk_.signal()) return {};
      if (talk_.hung_up()) return hung_up();
      if (!heard) continue;
      if (!talk_.listen(kLook)) return hung_up();  // answers to what it was asked before
      robot_.script_ended();
      return {};
    }
    if (options_.duration_s && afterwards == Afterwards::nothing) return {};
    return hal::Failure{
        "the robot has not answered since it began the script; is the script still "
        "waiting, or was the robot switched off?"};
  }

  void say_what_it_waits_for(const ScriptWaits& waits) const {
    if (waits.duration) {
      const std::chrono::duration<double> time{*waits.duration};
      return print_remark(fmt::format(
          "the script waits for {:.1f} s, and the robot is deaf meanwhile; waiting for it",
          time.count()));
    }
    print_remark(
        "the script waits, and the robot is deaf until that is over; waiting for it, Ctrl-C ends "
        "this");
  }

  // What is not a command of the manual: whatever comes back is the answer.
  hal::Result<void> send_raw(const std::vector<std::uint8_t>& bytes) {
    if (bytes == std::vector{oi::kSoftResetOpcode}) {
      if (!talk_.send(bytes)) return not_sent();
      print_remark("a robot that knows soft_reset restarts now, which takes 5 s");
      begin_stream(false);
      const Progress progress{"waiting for the robot to restart"};
      if (!talk_.listen(kRestart)) return hung_up();
      return {};
    }
    // A stream of packets that the manual does not have, or what may be one: it has to be paused.
    if (std::ranges::find(bytes, oi::Stream::kOpcode) != bytes.end()) {
      if (!talk_.send(bytes)) return not_sent();
      talk_.show_bytes();
      begin_stream(true);
      return {};
    }
    std::optional<Progress> progress{std::in_place, "waiting for what may come back"};
    const std::vector<std::uint8_t> answer = talk_.ask_anything(bytes);
    progress.reset();
    if (talk_.hung_up()) return hung_up();
    const bool asks_date = bytes == std::vector{oi::kFirmwareDateOpcode};
    const auto date = asks_date ? oi::parse_firmware_date(answer) : std::nullopt;
    if (date) {
      std::array<char, 32> text{};
      oi::TextWriter out{text};
      oi::write_date(out, *date);
      fmt::print("firmware of {}\n", out.text());
    } else if (!answer.empty()) {
      fmt::print("answer: {:02x}\n", fmt::join(answer, " "));
    } else if (asks_date && !talk_.signal()) {
      return hal::Failure{"the robot did not answer firmware_date; only some robots know it"};
    } else if (!talk_.signal()) {
      print_remark("nothing came back");
    }
    std::fflush(stdout);
    return {};
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
      duration = kForEver;
      if (!talk_.signal()) print_remark("the wheels may be turning; Ctrl-C stops them");
    } else if (holds) {
      duration = std::max(duration, seconds(*options_.duration_s) - awaited_);
    }
    std::optional<Progress> progress;
    if (!talk_.streaming() || !begun_stream_) progress.emplace("the wheels may be turning");
    const rt::TimePoint begin = port_.now();
    for (rt::Duration left = duration; left > rt::Duration::zero() && !output_error();
         left = begin + duration - port_.now()) {
      if (!talk_.listen(std::min<rt::Duration>(left, kLook)) || talk_.signal()) break;
    }
    if (begun_stream_ && talk_.streaming() && talk_.frames() == 0 &&
        port_.now() - begin > std::chrono::milliseconds{200}) {
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
    (void)port_.drain(std::chrono::milliseconds{100});
  }

  hal::ByteStream& port_;
  hal::Duty& duty_;
  const SendOptions& options_;
  Conversation talk_;
  std::uint32_t opened_at_ = port_.baud();
  Expectation robot_{oi::Mode::off, port_.baud()};
  rt::Duration awaited_{};  // the last script
  bool begun_stream_ = false;
};

}  // namespace

Sent send_commands(hal::ByteStream& port, hal::Duty& duty, StopSignals& signals,
                   const SendOptions& options, const std::vector<PlannedCommand>& commands) {
  Sending sending{port, duty, signals, options};
  if (const auto sent = sending.run(commands); !sent) return sent.failure();
  return sending.signal();
}

}  // namespace cargobay::cli
