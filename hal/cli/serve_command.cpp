// `cargobay serve`: owns a robot for as long as it runs, for clients that watch and steer it.

#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/connect/sim_options.hpp"
#include "hal/cli/drive/drive_options.hpp"
#include "hal/cli/serve/web_side.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/machine/oom_score.hpp"
#include "hal/service/journal.hpp"
#include "hal/service/service.hpp"
#include "hal/service/service_manager.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/world/world.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr std::chrono::hours kPatience{24};  // for a port that is lost
constexpr int kOomScore = -900;              // where a service puts itself that is put at -1000

using Told = std::function<void(const std::string&)>;
using Log = std::function<void(const hal::ServiceNews&)>;

struct ServeOptions {
  DriveOptions drive{};  // those that say how the robot is wired and driven
  std::string world;
  WebOptions web{};
  bool no_http = false;
  bool wait = false;
};

// The virtual Create's world; it outlives the robot.
hal::Result<void> put_into_world(const ServeOptions& options, hal::sim::Server* server,
                                 std::optional<hal::sim::World>& world) {
  if (options.world.empty()) return {};
  if (server == nullptr)
    return hal::Failure{.message = "--world is for a virtual Create; leave --port out"};
  auto loaded = hal::sim::World::load(options.world);
  if (!loaded) return loaded.failure();
  world = std::move(*loaded);
  server->with_device([&](hal::sim::Device& device) { hal::sim::inhabit(device, *world); });
  return {};
}

// Says where it serves, once the loop runs and the web side is there.
class Announcement {
 public:
  Announcement(const ServeOptions& options, const hal::Service& service,
               hal::ServiceManager& manager)
      : options_{options}, socket_{service.socket()}, manager_{manager} {}

  hal::Result<void> begin_web() {
    if (options_.no_http) return {};
    if (!WebSide::is_installed()) {
      if (!options_.web.http.empty()) return hal::Failure{.message = WebSide::kMissing};
      print_remark(WebSide::kMissing);
      return {};
    }
    WebOptions web = options_.web;
    web.socket = socket_;
    auto side = WebSide::start(web, [](const std::string& what) { print_remark(what); });
    if (!side) return side.failure();
    web_ = std::move(*side);
    return {};
  }
  void ready() {
    const std::string line = web_ ? web_->ready_line() : "serving " + socket_;
    manager_.ready();
    manager_.status(line);
    if (std::exchange(said_, true)) return;
    fmt::print("{}\n", line);
    (void)std::fflush(stdout);
  }

 private:
  const ServeOptions& options_;
  std::string socket_;
  hal::ServiceManager& manager_;  // outlives this
  std::unique_ptr<WebSide> web_{};
  bool said_ = false;
};

// With the fields that it can be searched by. What the journal does not take is printed.
void log_to(const hal::Journal& journal, const std::string& port, const hal::ServiceNews& news) {
  std::vector<hal::Journal::Field> fields{{"CARGOBAY_PORT", port}, {"CARGOBAY_EVENT", news.event}};
  if (news.frames) {
    fields.push_back({"CARGOBAY_FRAMES", std::to_string(news.frames->good)});
    fields.push_back(
        {"CARGOBAY_FRAMES_LOST", std::to_string(news.frames->lost + news.frames->bad)});
  }
  const auto priority =
      news.event == "lost" ? hal::Journal::Priority::warning : hal::Journal::Priority::info;
  if (!journal.tell(priority, news.text, fields)) print_remark(news.text);
}

int serve(const ServeOptions& options) {
  hal::raise_oom_score(kOomScore);
  StopSignals signals;
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  if (const auto done = check(options.drive); !done) return fail(done.failure());
  auto config = configuration(options.drive.connection, options.drive.pins);
  if (!config) return fail(config.failure());
  hal::RobotOptions robot = robot_options(options.drive, *config);
  leave_cpu_to_loop(robot);
  const auto chosen = choose_robot(*config, options.drive.pins, parameters(options.drive.sim),
                                   hal::below_loop(robot.realtime.priority));
  if (!chosen) return fail(chosen.failure());
  std::optional<hal::sim::World> world;
  if (const auto put = put_into_world(options, chosen->server(), world); !put)
    return fail(put.failure());
  if (chosen->server() != nullptr) schedule(options.drive.sim, *chosen->server());
  robot.pins = chosen->pins();
  robot.learnt = learnt_place(options.drive.learnt, *config);
  hal::ServiceManager manager;
  std::optional<int> signal;
  robot.cancelled = [&] {  // asked wherever the service waits
    manager.alive(rt::Clock::now());
    if (signal) return true;
    signal = signals.wait(rt::Duration::zero());
    if (signal) manager.stopping();
    return signal.has_value();
  };
  const hal::Journal journal;
  const auto log = [&](const hal::ServiceNews& news) { log_to(journal, chosen->port, news); };
  const auto tell = [&](const std::string& what) {
    if (!journal.is_there()) print_remark(what);
    manager.status(what);
  };
  // For who waits for this service it has started: it is there for what comes.
  const auto missing = [&](const std::string& why) {
    tell(why);
    manager.ready();
  };
  auto service = hal::Service::open({.program = "cargobay serve",
                                     .chosen = &*chosen,
                                     .baud = *config->baud,
                                     .robot = robot,
                                     .world = world ? &*world : nullptr,
                                     .patience = kPatience,
                                     .missing = options.wait ? missing : Told{},
                                     .tell = tell,
                                     .log = journal.is_there() ? log : Log{}});
  if (!service) return fail(service.failure());
  Announcement announcement{options, **service, manager};
  if (const auto begun = announcement.begin_web(); !begun) return fail(begun.failure());
  const auto served = (*service)->run([&] { announcement.ready(); });
  const bool ended_so = served || served.failure().code == std::errc::operation_canceled;
  if (signal && ended_so) return kSignalled + *signal;
  return served ? kSuccess : fail(served.failure());
}

}  // namespace

void add_serve(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<ServeOptions>();
  CLI::App* command = app.add_subcommand(
      "serve",
      "Own a robot for as long as this runs: bring it up, close the loop, guard it, reconnect; "
      "and\n"
      "let others watch and steer it: `cargobay teleop` and `top`, programs, and a page in the "
      "browser.\n"
      "Prints `serving URL` when it is ready. Without --port, a virtual Create of its own.");
  add_robot_options(*command, options->drive);
  command->add_option("--world", options->world,
                      "The world that the virtual Create lives in: a file, see cargobay sim");
  command->add_option("--http", options->web.http,
                      "Where the page is served: [ADDRESS:]PORT. Beyond this machine's own "
                      "127.0.0.1 everybody needs the token  [127.0.0.1:8080]");
  command->add_option("--token", options->web.token,
                      "What the page's visitors must know, on this machine too; made if left out "
                      "and --http goes beyond it");
  command
      ->add_option("--token-file", options->web.token_file,
                   "The token is in this file, for whoever may read it; made there if it is "
                   "missing, for the file's group")
      ->excludes("--token");
  command->add_option("--cert", options->web.certificate,
                      "PEM file with certificate and key: the page by HTTPS");
  command
      ->add_option("--name", options->web.names,
                   "A name under which the page is reached, beside this machine's addresses and "
                   "its own name; repeatable")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command
      ->add_option("--origin", options->web.origins,
                   "A page of another server that may connect, as https://app.foxglove.dev; "
                   "repeatable")
      ->type_name("ORIGIN")
      ->allow_extra_args(false);
  command->add_flag("--no-http", options->no_http, "No page: only the feed's socket");
  command->add_flag("--wait", options->wait,
                    "Wait for a port or a robot that is not there yet, instead of failing");
  command->footer(
      "Examples:\n"
      "  cargobay serve                             and open http://127.0.0.1:8080/\n"
      "  cargobay serve --port /dev/ttyUSB0 --http 0.0.0.0:8080\n"
      "  cargobay serve --world room.world --plant sluggish");
  command->callback([options, &chosen] { chosen = [options] { return serve(*options); }; });
}

}  // namespace cargobay::cli
