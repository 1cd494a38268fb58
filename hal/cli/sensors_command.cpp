// `cargobay sensors`: the robot's sensor values, named and with units.

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/bring_up/other_end.hpp"
#include "hal/bring_up/sensor_stream.hpp"
#include "hal/cli/attached/feed_frames.hpp"
#include "hal/cli/commands.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/packet_list.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/sensor_format.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/cli/view/screen.hpp"
#include "hal/cli/view/sensor_view.hpp"
#include "hal/guard/duty.hpp"
#include "oi/dialect.hpp"

namespace cargobay::cli {
namespace {

constexpr int kSensorsPriority = 0;  // none

struct SensorsOptions {
  PortOptions connection{};
  std::string packets = "6";
  bool as_json = false;
  bool once = false;
};

constexpr rt::Duration kFirstFramePatience = std::chrono::seconds{3};
constexpr rt::Duration kRefresh = std::chrono::milliseconds{200};

// Without those that another one contains: the second distance of a frame is that since the first.
std::vector<oi::PacketId> each_once(const std::vector<oi::PacketId>& packets) {
  const auto bits = [](oi::PacketId packet) { return oi::packet_bits(oi::kCreate.packet(packet)); };
  std::vector<oi::PacketId> kept;
  std::uint64_t covered = 0;
  for (const oi::PacketId packet : packets) {
    if ((bits(packet) & ~covered) == 0) continue;
    std::erase_if(kept, [&](oi::PacketId one) { return (bits(one) & ~bits(packet)) == 0; });
    kept.push_back(packet);
    covered |= bits(packet);
  }
  return kept;
}

// Prints readings: JSON, or a table.
class Printer {
 public:
  // Both outlive it.
  Printer(const SensorsOptions& options, const std::vector<oi::PacketId>& packets)
      : options_{options}, packets_{packets}, json_{packets} {}

  bool as_json() const { return options_.as_json; }
  void print(const hal::SensorFrame& frame, double time_s) const {
    if (as_json()) {
      const std::chrono::nanoseconds now = std::chrono::system_clock::now().time_since_epoch();
      const std::string line = json_.of({.stamp = {.unix_ns = now.count(), .time_s = time_s},
                                         .values = frame.values,
                                         .distance_sum_mm = frame.distance_mm,
                                         .angle_sum_deg = frame.angle_deg}) +
                               "\n";
      (void)std::fwrite(line.data(), 1, line.size(), stdout);
    } else {
      fmt::print("{}", lines(packets_, frame.values));
    }
    (void)std::fflush(stdout);
  }

 private:
  const SensorsOptions& options_;
  const std::vector<oi::PacketId>& packets_;
  JsonLine json_;
};

// The next frame; nothing if none came within a time in which signals may wait.
using NextFrame = std::function<hal::Result<std::optional<hal::SensorFrame>>()>;

// Shows one frame after the other, as a line of JSON each or, at a rate that eyes can follow, on
// the whole screen.
class Watch {
 public:
  // All of them outlive it; without a screen, frames are printed.
  Watch(const Printer& printer, const std::vector<oi::PacketId>& packets, std::string where,
        NextFrame next, Screen* screen)
      : printer_{printer},
        packets_{packets},
        next_{std::move(next)},
        screen_{screen},
        picture_{.where = std::move(where)} {}

  // Until a signal, or until nothing reads what is printed.
  hal::Result<void> run(StopSignals& signals) {
    while (!signals.wait(rt::Duration::zero()).has_value() && !output_error()) {
      const auto frame = next_();
      if (!frame) return frame.failure();
      if (!*frame) continue;
      take(**frame);
      if (screen_ != nullptr) {
        draw();
      } else {
        print();
      }
      // A table that cannot be replaced is printed once.
      if (screen_ == nullptr && !printer_.as_json()) break;
    }
    return {};
  }

  // Prints the first one.
  hal::Result<void> show_one(StopSignals& signals) {
    while (!signals.wait(rt::Duration::zero()).has_value()) {
      const auto frame = next_();
      if (!frame) return frame.failure();
      if (!*frame) continue;
      take(**frame);
      print();
      break;
    }
    return {};
  }

 private:
  void take(const hal::SensorFrame& frame) {
    if (picture_.frames++ == 0) first_ = frame.arrival;
    picture_.frame = frame;
    picture_.time_s = rt::seconds(frame.arrival - first_);
  }
  void print() const { printer_.print(picture_.frame, picture_.time_s); }
  void draw() {
    const bool due = picture_.frame.arrival >= next_draw_;
    if (!screen_->attend() && !due) return;
    next_draw_ = picture_.frame.arrival + kRefresh;
    screen_->draw(sensor_view(picture_, packets_, screen_->size()));
  }

  const Printer& printer_;
  const std::vector<oi::PacketId>& packets_;
  NextFrame next_;
  Screen* screen_;
  SensorPicture picture_;
  rt::TimePoint first_{};
  rt::TimePoint next_draw_{};
};

// The stream is paused in the end.
hal::Result<void> watch(const Printer& printer, const std::vector<oi::PacketId>& packets,
                        hal::ByteStream& port, const std::string& name, StopSignals& signals) {
  std::optional<Progress> progress{std::in_place, "waiting for the robot to stream"};
  auto stream = hal::SensorStream::open(port, packets);
  progress.reset();
  if (!stream) return stream.failure();
  if (const std::string& why = (*stream)->why_asked(); !why.empty())
    print_remark(why + "; asking for one reading after the other");
  std::unique_ptr<Screen> screen;
  if (!printer.as_json()) screen = Screen::open(ControlZ::suspends);
  const NextFrame next = [&stream]() -> hal::Result<std::optional<hal::SensorFrame>> {
    const auto frame = (*stream)->next();
    if (!frame) return frame.failure();
    return std::optional{*frame};
  };
  Watch frames{printer, packets, fmt::format("{} at {} baud", name, port.baud()), next,
               screen.get()};
  return frames.run(signals);
}

hal::Result<void> read_once(const Printer& printer, const std::vector<oi::PacketId>& packets,
                            hal::ByteStream& port) {
  std::optional<Progress> progress{std::in_place, "waiting for the robot's answer"};
  const auto values = hal::query_sensors(port, packets);
  progress.reset();
  if (!values) return values.failure();
  printer.print({.values = *values,
                 .distance_mm = values->raw(oi::PacketId::distance),
                 .angle_deg = values->raw(oi::PacketId::angle)},
                0.0);
  return {};
}

// The robot of a port that another process drives, as its feed tells.
hal::Result<void> watch_feed(const Printer& printer, const std::vector<oi::PacketId>& packets,
                             FeedFrames& feed, bool once, StopSignals& signals) {
  const hal::heard::Hello& hello = feed.news().hello;
  const std::string where = fmt::format("{}{} at {} baud, by {}",
                                        hello.robot == "virtual Create" ? "virtual Create on " : "",
                                        hello.port, hello.baud, hello.program);
  std::optional<Progress> progress{std::in_place, "waiting for a frame of the drive"};
  const rt::TimePoint limit = rt::Clock::now() + kFirstFramePatience;
  bool waited = false;
  const NextFrame next = [&]() -> hal::Result<std::optional<hal::SensorFrame>> {
    auto frame = feed.next(packets);
    if (frame && !*frame && !waited && rt::Clock::now() > limit) {
      return hal::Failure{
          "no frame with these packets came within 3 s: the drive does not read "
          "them, or its robot is lost; its feed says: " +
          feed.news().text};
    }
    if (frame && *frame) waited = true;
    if (waited) progress.reset();
    return frame;
  };
  std::unique_ptr<Screen> screen;
  if (!once && !printer.as_json()) screen = Screen::open(ControlZ::suspends);
  Watch frames{printer, packets, where, next, screen.get()};
  const auto watched = once ? frames.show_one(signals) : frames.run(signals);
  progress.reset();
  screen.reset();
  if (feed.missed() > 0) {
    print_remark(
        fmt::format("{} frames did not get here; the sums have them all the same", feed.missed()));
  }
  return watched;
}

int sensors(const SensorsOptions& options) {
  StopSignals signals;
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  const auto packets = read_packet_list(options.packets);
  if (!packets) return fail(packets.failure());
  const auto config = configuration(options.connection);
  if (!config) return fail(config.failure());
  // A live table needs a terminal that can show one; elsewhere one reading makes more sense.
  const bool live = options.as_json || (stdout_is_terminal() && terminal_moves_cursor());
  const std::vector<oi::PacketId> asked = each_once(*packets);
  const Printer printer{options, *packets};
  if (auto feed = config->port.empty() ? std::nullopt : FeedFrames::attach(config->port)) {
    print_remark(
        fmt::format("{}: {}; this is what its feed tells", config->port, publisher(feed->news())));
    const auto shown = watch_feed(printer, asked, *feed, options.once || !live, signals);
    return shown ? kSuccess : fail(shown.failure());
  }
  const auto chosen = find_plain_robot(*config);  // outlives the port
  if (!chosen) return fail(chosen.failure());
  auto port = open_plain(*chosen, *config->baud);
  if (!port) return fail(port.failure());
  const std::string name = (chosen->create ? "virtual Create on " : "") + chosen->port;
  // If this program is killed, the stream is still stopped and the port restored.
  constexpr auto kMoves = hal::GuardOptions::Moves::nothing;
  auto duty = hal::Duty::begin(**port, {.moves = kMoves}, kSensorsPriority);
  if (!duty) return fail(duty.failure());
  const hal::Result<void> shown = options.once || !live
                                      ? read_once(printer, asked, **port)
                                      : watch(printer, asked, **port, name, signals);
  (*duty)->waive();  // nothing was told to move
  if (shown) return kSuccess;
  std::optional<Progress> progress{std::in_place, "looking at what is there"};
  const hal::Failure why = hal::name_other_end(**port, shown.failure(), StopSignals::came);
  progress.reset();
  return fail(why);
}

}  // namespace

void add_sensors(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<SensorsOptions>();
  CLI::App* command = app.add_subcommand(
      "sensors",
      "Show the robot's sensors, named and with units: a live table on a terminal, otherwise one "
      "reading.\n"
      "A robot that is off is started, and stays in Passive; one that runs keeps its mode. Of a\n"
      "robot that another process drives, its feed tells: only what that process reads, without\n"
      "touching the port. Without --port, the sensors of a virtual Create of its own.");
  add_port_options(*command, options->connection);
  command
      ->add_option("--packets", options->packets,
                   "Packets by number or name, separated by commas; 6 is all")
      ->capture_default_str();
  command->add_flag("--json", options->as_json,
                    "One JSON object per frame, every 15 ms or as often as the line carries it, "
                    "with its time and the sums of distance and angle");
  command->add_flag("--once", options->once, "Take one reading, then exit");
  command->footer(
      "Examples:\n"
      "  cargobay sensors --port /dev/ttyUSB0\n"
      "  cargobay sensors --port /tmp/create --packets distance,angle,oi_mode --json");
  command->callback([options, &chosen] { chosen = [options] { return sensors(*options); }; });
}

}  // namespace cargobay::cli
