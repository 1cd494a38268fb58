// `cargobay drive`: the main job. Brings the robot up, closes the velocity loop for a while, and
// reports.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/connect/bring_up_report.hpp"
#include "hal/cli/connect/findings.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/connect/published.hpp"
#include "hal/cli/connect/sim_options.hpp"
#include "hal/cli/drawing/picture.hpp"
#include "hal/cli/drive/drive_display.hpp"
#include "hal/cli/drive/drive_links.hpp"
#include "hal/cli/drive/drive_log.hpp"
#include "hal/cli/drive/drive_options.hpp"
#include "hal/cli/drive/drive_recording.hpp"
#include "hal/cli/drive/drive_report.hpp"
#include "hal/cli/drive/last_frames.hpp"
#include "hal/cli/drive/profile.hpp"
#include "hal/cli/drive/velocity_plot.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/machine/kworker_boost.hpp"
#include "hal/port/port_identity.hpp"
#include "hal/robot/reconnect.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sim/line/server.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr rt::Duration kStatusPeriod = std::chrono::milliseconds{100};

// The control function: follows the profile, and asks the cycle to end when the time is over.
struct Driver {
  const Profile* profile = nullptr;
  double duration_s = 0.0;
  hal::ControlCycle* cycle = nullptr;
  double before_s = 0.0;  // robot time of the links before this one

  static hal::ControlAnswer control(void* context, const hal::CycleState& /*state*/, double seconds)
      CARGOBAY_NONBLOCKING {
    auto& self = *static_cast<Driver*>(context);
    const double driven_s = self.before_s + seconds;
    if (driven_s >= self.duration_s) self.cycle->request_stop();
    return self.profile->at(std::min(driven_s, self.duration_s - 1e-6));  // not yet the next round
  }
};

std::string plot_title(const DriveReport& report, const DriveOptions& options) {
  return fmt::format(
      "{} at {:g} mm/s, {} loop, remainder {}: steady error {:.1f} / {:.1f} mm/s, tracking rms "
      "{:.1f} / {:.1f} mm/s (left / right)",
      options.profile, options.speed_mm_s, options.open_loop ? "open" : "closed",
      name(report.remainder), report.figures.left.steady_error_mm_s,
      report.figures.right.steady_error_mm_s, report.figures.left.tracking_rmse_mm_s,
      report.figures.right.tracking_rmse_mm_s);
}

// Writes every file that can be written. Returns the first failure.
hal::Result<void> save(const DriveReport& report, const DriveOptions& options,
                       const std::vector<DriveSample>& samples, Outputs& outputs) {
  hal::Result<void> saved;
  if (!options.json_file.empty()) saved = outputs.write("--json", json(report));
  if (options.plot_file.empty()) return saved;
  const auto drawing =
      picture(velocity_plot(samples, plot_title(report, options)), options.plot_file);
  auto drawn = drawing ? outputs.write("--plot", *drawing) : drawing.failure();
  return saved ? drawn : saved;
}

// How the last link of a drive ended.
struct Ending {
  hal::Robot::Farewell farewell{};
  std::optional<int> signal{};
  std::string why{};  // the robot did not come back; empty if nothing waited for it
  std::vector<std::string> recordings{};  // in words: what to do with each
  hal::Result<void> recorded{};
  std::string not_kept{};  // why what was learnt is not; empty if it is, or need not
};

// What went wrong, the worst first; empty if nothing did.
std::string complaint(const Ending& ending, const hal::Result<void>& saved) {
  if (!ending.why.empty()) return ending.why;
  if (std::string wrong = hal::explain(ending.farewell); !wrong.empty()) return wrong;
  return saved ? "" : saved.failure().message;
}

// Writes the files, the table, and the last word. Returns the exit code.
int conclude(const DriveReport& report, const DriveOptions& options,
             const std::vector<DriveSample>& samples, const Ending& ending, Outputs& outputs) {
  hal::Result<void> saved = save(report, options, samples, outputs);
  if (saved) saved = ending.recorded;
  if (options.json_file != "-") {
    constexpr std::size_t kIndent = 11;
    fmt::print("{}", wrapped(table(report), terminal_columns(STDOUT_FILENO), kIndent));
    for (const std::string& words : ending.recordings) fmt::print("Recording  {}\n", words);
    fmt::print("{}", last_frames_table(ending.farewell.last));
  }
  const std::string wrong = complaint(ending, saved);
  if (!wrong.empty()) {
    print_error(wrong);
    return kFailure;
  }
  return ending.signal.has_value() ? kSignalled + *ending.signal : kSuccess;
}

// Drives over one link after another, until the time is over or no further link is available.
class Drive {
 public:
  Drive(const DriveOptions& options, const Profile& profile, hal::sim::Server* server,
        const Published& published, StopSignals& signals, Outputs& outputs)
      : published_{published},
        signals_{signals},
        links_{server},
        display_{fmt::format("{}, {} loop", options.profile, options.open_loop ? "open" : "closed"),
                 options.duration_s, links_,
                 options.json_file == "-" ? DriveDisplay::Events::keep_quiet
                                          : DriveDisplay::Events::print},
        driver_{.profile = &profile, .duration_s = options.duration_s},
        recording_{
            drive_recording(options.record_file,
                            fmt::format("{} at {:g} mm/s, {} loop", options.profile,
                                        options.speed_mm_s, options.open_loop ? "open" : "closed"),
                            outputs)} {}

  // Fails if the first link cannot be driven. `request` finds the further links; if it names no
  // port there are none.
  hal::Result<Ending> run(hal::Robot::Owned robot, const hal::ReconnectRequest& request) {
    auto ending = follow_links(std::move(robot), request);
    if (!ending || !recording_) return ending;
    recording_->finish();
    ending->recorded = recording_->written();
    for (const std::string& file : recording_->files())
      ending->recordings.push_back(file + "; " + recording_->advice(file));
    return ending;
  }
  const DriveLinks& links() const { return links_; }
  const rt::RealtimeGrant& grant() const { return grant_; }
  // By the last link; nothing if the wheels were never told anything.
  const std::optional<rt::LearntPlant>& learnt() const { return learnt_; }
  bool began_from_earlier() const { return began_from_earlier_; }

 private:
  hal::Result<Ending> follow_links(hal::Robot::Owned robot, const hal::ReconnectRequest& request) {
    Ending ending;
    hal::ReconnectRequest again = request;
    if (const std::string& remark = robot->learnt_remark(); !remark.empty()) print_remark(remark);
    for (bool first = true;; first = false) {
      const auto grant = begin_link(*robot);
      if (!grant && first) return grant.failure();
      if (!grant) {
        ending.why = grant.failure().message;
        return ending;
      }
      grant_ = *grant;
      ending.signal = follow(*robot);
      ending.farewell = robot->stop();
      published_.leave("the drive has ended, or waits for its robot");
      links_.end_link();
      display_.print_events();
      if (recording_) recording_->end_link(*robot, links_);
      began_from_earlier_ = began_from_earlier_ || robot->began_from().has_value();
      if (auto learnt = robot->cycle().learnt()) learnt_ = learnt;
      if (auto next = robot->learnt()) again.robot.cycle.loop.estimator.prior = next;
      ending.not_kept = robot->learnt_remark();
      robot.reset();  // closes the port
      const bool goes_on = !request.port.path.empty() && !ending.signal.has_value() &&
                           hal::may_reconnect(ending.farewell.end);
      if (!goes_on) return ending;
      auto back = wait_for_robot(again, ending.farewell.end);
      if (!back) {
        ending.why = back.failure().message;
        return ending;
      }
      robot = std::move(back->robot);
    }
  }
  hal::Result<rt::RealtimeGrant> begin_link(hal::Robot& robot) {
    driver_.cycle = &robot.cycle();
    driver_.before_s = static_cast<double>(links_.ticks()) * rt::seconds(oi::kTick);
    if (recording_) {
      if (const auto begun = recording_->begin_link(robot); !begun) return begun.failure();
    }
    auto grant = robot.start({.function = &Driver::control, .context = &driver_});
    if (!grant) return grant;
    if (recording_) recording_->publish();
    links_.begin_link(robot);
    published_.follow(robot);
    if (links_.reconnects() > 0)
      print_remark(fmt::format("back after {:.1f} s", rt::seconds(links_.latest_without())));
    return grant;
  }
  // Returns the signal that ended the drive before its time.
  std::optional<int> follow(hal::Robot& robot) {
    std::optional<int> signal;
    // At once, even while this thread is held up by what it prints or records.
    const AtFirstSignal stop{[&robot] { robot.cycle().request_stop(); }};
    display_.begin();
    while (!robot.ended() && !signal.has_value()) {
      signal = signals_.wait(kStatusPeriod);
      links_.collect();
      if (recording_) recording_->append(robot, links_);
      display_.show(robot.cycle().counters().frames);
    }
    display_.end();
    return signal.has_value() ? signal : signals_.wait(rt::Duration::zero());
  }
  static hal::Result<hal::Reconnection> wait_for_robot(const hal::ReconnectRequest& request,
                                                       hal::CycleEnd end) {
    print_remark(end == hal::CycleEnd::hung_up
                     ? "the port hung up; waiting for it to come back"
                     : "the robot fell silent; waiting for it to come back");
    std::optional<Progress> progress{std::in_place, "waiting for it; Ctrl-C gives up"};
    auto back = hal::reconnect(request);
    progress.reset();
    if (back && !back->remark.empty()) print_remark(back->remark);
    return back;
  }

  const Published& published_;
  StopSignals& signals_;
  DriveLinks links_;
  DriveDisplay display_;
  Driver driver_;
  std::unique_ptr<DriveRecording> recording_;  // null if there is none
  std::optional<rt::LearntPlant> learnt_{};
  bool began_from_earlier_ = false;
  rt::RealtimeGrant grant_{};  // of the last link
};

// The drive's own part of the report; the drive outlives it.
DriveReport report_of(const DriveOptions& options, const Drive& drive,
                      const std::vector<DriveSample>& samples) {
  const DriveLinks& links = drive.links();
  const hal::CycleState last = links.states().empty() ? hal::CycleState{} : links.states().back();
  return {.open_loop = options.open_loop,
          .remainder = last.remainder,
          .grant = drive.grant(),
          .ticks = links.ticks(),
          .frames = links.frames(),
          .overruns = links.overruns(),
          .refused_controls = links.refused_controls(),
          .events = links.events(),
          .events_dropped = links.events_dropped(),
          .states = &links.states(),
          .figures = figures(samples),
          .period_ns = &links.period_ns(),
          .frame_to_command_ns = &links.frame_to_command_ns(),
          .reconnects = links.reconnects(),
          .without_link = links.without(),
          .learnt = drive.learnt(),
          .began_from_earlier = drive.began_from_earlier()};
}

// How to find a lost port again. Without an identity the port is not sought: it was not asked for,
// or the robot is a virtual Create of our own, which stays.
hal::Result<hal::ReconnectRequest> reconnect_request(const DriveOptions& options,
                                                     const hal::ChosenRobot& chosen,
                                                     std::uint32_t baud,
                                                     const hal::RobotOptions& robot) {
  hal::ReconnectRequest request{.baud = baud, .robot = robot};
  if (options.reconnect.empty() || chosen.create) return request;
  auto identity = hal::identify(chosen.port, hal::serial_ports());
  if (!identity) return identity.failure();
  request.port = std::move(*identity);
  request.tell = [](const std::string& what) { print_remark(what); };
  request.patience =
      std::chrono::duration_cast<rt::Duration>(std::chrono::duration<double>{reconnect_s(options)});
  return request;
}

// As far as the kernel allows; if rights are required, what it refuses is a failure.
hal::Result<void> boost_kworkers(hal::KworkerBoost& boost, const hal::RobotOptions& robot) {
  const std::error_code error = boost.start();
  if (!error) return {};
  if (robot.require_realtime) return hal::Failure{hal::explain_kworker_boost(error)};
  print_remark(hal::explain_kworker_boost(error));
  return {};
}

// Shows meanwhile where the bring-up is: it is not asked for progress later.
hal::Result<hal::Robot::Owned> bring_up(std::unique_ptr<hal::ByteStream> stream,
                                        hal::RobotOptions wanted) {
  Progress progress{"bring-up"};
  wanted.progress = [&](const hal::BringUpEvent& event) { progress.say(in_words(event)); };
  return hal::Robot::open(std::move(stream), wanted);
}

int drive(const DriveOptions& options) {
  StopSignals signals{SIGTSTP};  // suspended by Ctrl-Z, it would leave the robot rolling
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  if (const auto done = check(options); !done) return fail(done.failure());
  Outputs outputs;
  if (const auto done = open_outputs(options, outputs); !done) return fail(done.failure());
  const auto profile = Profile::load(options.profile, options.speed_mm_s);
  if (!profile) return fail(profile.failure());

  auto config = configuration(options.connection, options.pins);
  if (!config) return fail(config.failure());
  if (options.builtin) config->port.clear();
  hal::RobotOptions wanted = robot_options(options, *config);
  leave_cpu_to_loop(wanted);
  const auto chosen =
      choose_robot(*config, options.pins, parameters(options.sim),
                   hal::below_loop(wanted.realtime.priority));  // outlives the robot
  if (!chosen) return fail(chosen.failure());
  wanted.pins = chosen->pins();
  wanted.learnt = learnt_place(options.learnt, *config);
  hal::sim::Server* const server = chosen->server();
  if (server != nullptr) schedule(options.sim, *server);
  std::optional<int> early_signal;
  wanted.cancelled = [&] {
    if (!early_signal) early_signal = signals.wait(rt::Duration::zero());
    return early_signal.has_value();
  };
  auto stream = open_for_use(chosen->port, *config->baud);
  if (!stream) return fail(stream.failure());
  const Published published =
      options.no_feed ? Published{} : Published{"cargobay drive", *chosen, *config->baud, wanted};
  published.attach_to(wanted);
  const auto again = reconnect_request(options, *chosen, *config->baud, wanted);
  if (!again) return fail(again.failure());
  if (server != nullptr && options.json_file != "-")
    fmt::print("Driving a virtual Create on {}\n", chosen->port);
  const std::vector<hal::Finding> findings = examine(chosen->port, wanted.realtime);
  hal::KworkerBoost boost{hal::kworker_priority(wanted.realtime.priority)};  // to the very end
  if (options.boost_kworkers) {
    if (const auto done = boost_kworkers(boost, wanted); !done) return fail(done.failure());
  }

  auto opened = bring_up(std::move(*stream), wanted);
  if (early_signal) return kSignalled + *early_signal;  // the robot stands still, or was told to
  if (!opened) return fail(opened.failure());
  Drive driving{options, *profile, server, published, signals, outputs};
  const auto ending = driving.run(std::move(*opened), *again);
  if (!ending) return fail(ending.failure());
  if (!ending->not_kept.empty()) print_remark(ending->not_kept);
  const std::vector<DriveSample> samples = driving.links().samples();
  DriveReport report = report_of(options, driving, samples);
  report.port = chosen->port;
  report.robot = server != nullptr ? "virtual Create" : "robot";
  report.baud = *config->baud;
  report.findings = findings;
  report.learnt_file = wanted.learnt.file;
  return conclude(report, options, samples, *ending, outputs);
}

}  // namespace

void add_drive(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<DriveOptions>();
  CLI::App* command = app.add_subcommand(
      "drive",
      "Close the wheel-velocity loop on a robot and report how well it held.\n"
      "Without --port, drives a virtual Create of its own over a pseudo-terminal.");
  add_drive_options(*command, *options);
  command->callback([options, &chosen] { chosen = [options] { return drive(*options); }; });
}

}  // namespace cargobay::cli
