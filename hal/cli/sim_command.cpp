// `cargobay sim`: virtual Creates on pseudo-terminals, for any Open Interface client.

#include <strings.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/connect/sim_faults.hpp"
#include "hal/cli/connect/sim_options.hpp"
#include "hal/cli/drawing/picture.hpp"
#include "hal/cli/serve/sim_view.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/remote/control.hpp"
#include "hal/sim/remote/control_socket.hpp"
#include "hal/sim/world/bodies.hpp"
#include "hal/sim/world/path_recorder.hpp"
#include "hal/sim/world/world.hpp"
#include "hal/sim/world/world_drawing.hpp"
#include "oi/dialect.hpp"
#include "rt/refusal.hpp"

namespace cargobay::cli {
namespace {

constexpr std::size_t kMostRobots = 100;

struct SimulatorOptions {
  SimOptions sim{};
  std::string link;
  std::string control;
  std::string world;
  std::string trace;
  std::vector<std::string> faults;
  std::size_t count = 1;
  bool together = false;
  std::uint32_t boot_baud = oi::kCreate.default_baud;
  std::size_t batch_bytes = hal::sim::ServerOptions{}.batch_bytes;
  int priority = 0;
  bool view = false;
  std::string http;  // where the page is served; empty: as cargobay-web does by itself
};

// One robot and everything requested for it. The server is destroyed first: it uses the path.
struct Served {
  std::unique_ptr<hal::sim::PathRecorder> path{};  // with --trace
  std::unique_ptr<hal::sim::Server> server{};
  std::unique_ptr<hal::sim::ControlSocket> control{};
  std::optional<SimView> view{};  // with --view
  std::string announced;          // what a client opens
};

int fail(const std::string& message) {
  print_error(message);
  return kFailure;
}

// The path of the robot with that index, if there are several: PATH.0, and FILE.0.svg.
std::string numbered(const std::string& path, std::size_t index, std::size_t count) {
  if (path.empty() || count == 1) return path;
  constexpr std::size_t kEnding = 4;  // .svg or .png, in any case
  const std::size_t dot = path.size() - std::min(path.size(), kEnding);
  const char* const ending = path.c_str() + dot;
  const bool drawing = strcasecmp(ending, ".svg") == 0 || strcasecmp(ending, ".png") == 0;
  const std::size_t stem = drawing ? dot : path.size();
  return fmt::format("{}.{}{}", path.substr(0, stem), index, path.substr(stem));
}

std::string trace_key(std::size_t index) { return fmt::format("--trace of robot {}", index); }

// The earliest first; those of the same moment in the order given.
std::vector<PlannedFault> planned_faults(const SimulatorOptions& options) {
  std::vector<PlannedFault> faults;
  for (const std::string& text : options.faults) {
    PlannedFault fault = *parse_fault(text);  // already checked: it parses
    const auto later =
        std::find_if(faults.begin(), faults.end(),
                     [&fault](const PlannedFault& other) { return other.after > fault.after; });
    faults.insert(later, std::move(fault));
  }
  return faults;
}

// No trace may overwrite the robots' other files.
void protect_places(const SimulatorOptions& options, Outputs& outputs) {
  outputs.protect("the world", options.world);
  for (std::size_t i = 0; i < options.count; ++i) {
    outputs.protect("the place of --link", numbered(options.link, i, options.count));
    outputs.protect("the place of --control", numbered(options.control, i, options.count));
  }
}

// What the robots live in; outlives them.
struct Surroundings {
  hal::sim::World world{};
  hal::sim::Bodies bodies{};
};

void put_into(Surroundings& surroundings, const SimulatorOptions& options,
              hal::sim::Device& device) {
  if (options.together) {
    hal::sim::inhabit(device, surroundings.world, surroundings.bodies, surroundings.bodies.enter());
  } else if (!options.world.empty()) {
    hal::sim::inhabit(device, surroundings.world);
  }
}

// Opens the robot's port and control socket; nothing runs yet.
hal::Result<void> open(const SimulatorOptions& options, std::size_t index,
                       Surroundings& surroundings, Outputs& outputs, Served& robot) {
  hal::sim::ServerOptions server_options{.link = numbered(options.link, index, options.count),
                                         .priority = options.priority,
                                         .batch_bytes = options.batch_bytes};
  if (!options.trace.empty()) {
    const std::string trace = numbered(options.trace, index, options.count);
    if (auto done = outputs.open(trace_key(index), trace); !done) return done;
    robot.path = std::make_unique<hal::sim::PathRecorder>();
    server_options.on_tick = [path = robot.path.get()](const hal::sim::Device& device) {
      path->add(device.truth().pose, device.seen().bump_left || device.seen().bump_right);
    };
  }
  hal::sim::Parameters parameters = cli::parameters(options.sim);
  parameters.boot_baud = options.boot_baud;
  parameters.seed += index;
  auto server = hal::sim::Server::open(parameters, server_options);
  if (!server) return server.failure();
  robot.server = std::move(*server);
  schedule(options.sim, *robot.server);
  robot.announced = robot.server->path();
  robot.server->with_device(
      [&](hal::sim::Device& device) { put_into(surroundings, options, device); });
  if (options.control.empty()) return {};
  auto control =
      hal::sim::ControlSocket::open(numbered(options.control, index, options.count), *robot.server);
  if (!control) return control.failure();
  robot.control = std::move(*control);
  return {};
}

// The pages, once the robots run: the first where it is wanted, the others at any free port.
hal::Result<void> view(const SimulatorOptions& options, const hal::sim::World& world,
                       std::vector<Served>& robots) {
  for (Served& robot : robots) {
    const bool first = &robot == &robots.front();
    auto opened = SimView::open(*robot.server, options.world.empty() ? nullptr : &world,
                                robot.announced, first ? options.http : "127.0.0.1:0");
    if (!opened) return opened.failure();
    robot.view.emplace(std::move(*opened));
  }
  return {};
}

void inflict(const PlannedFault& fault, std::vector<Served>& robots) {
  for (Served& robot : robots) {
    const std::string answer = hal::sim::control("fault " + fault.command, *robot.server);
    if (answer != "ok") print_remark(fmt::format("fault {}: {}", fault.command, answer));
  }
}

std::error_code start(std::vector<Served>& robots) {
  for (Served& robot : robots) {
    if (const std::error_code error = robot.server->start()) return error;
    if (!robot.control) continue;
    if (const std::error_code error = robot.control->start()) return error;
  }
  return {};
}

// Serves until a signal comes.
void serve_until_signal(StopSignals& signals, std::vector<PlannedFault> faults,
                        std::vector<Served>& robots) {
  const rt::TimePoint begin = rt::Clock::now();
  std::reverse(faults.begin(), faults.end());  // so that the next is the last
  for (;;) {
    while (!faults.empty() && begin + faults.back().after <= rt::Clock::now()) {
      inflict(faults.back(), robots);
      faults.pop_back();
    }
    const rt::Duration wait = faults.empty() ? rt::Duration{std::chrono::hours{1}}
                                             : begin + faults.back().after - rt::Clock::now();
    if (signals.wait(std::max(wait, rt::Duration{0}))) return;
  }
}

int write_traces(const hal::sim::World& world, const std::vector<Served>& robots,
                 const std::string& file, Outputs& outputs) {
  int result = kSuccess;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (!robots[i].path) continue;
    const auto drawing = picture(hal::sim::draw(world, robots[i].path->path()), file);
    if (!drawing) {
      result = fail(drawing.failure().message);
    } else if (const auto done = outputs.write(trace_key(i), *drawing); !done) {
      result = fail(done.failure().message);
    }
  }
  return result;
}

int simulate(const SimulatorOptions& options) {
  StopSignals signals;
  if (!oi::kCreate.baud_code(options.boot_baud).has_value()) {
    return fail(fmt::format("the robot does not support {} baud; choose 57600 or 19200",
                            options.boot_baud));
  }
  Surroundings surroundings;
  if (!options.world.empty()) {
    auto loaded = hal::sim::World::load(options.world);
    if (!loaded) return fail(loaded.failure().message);
    surroundings.world = std::move(*loaded);
  }
  std::vector<PlannedFault> faults = planned_faults(options);
  std::vector<Served> robots(options.count);
  if (const auto good = check_picture_name("--trace", options.trace); !good)
    return fail(good.failure().message);
  Outputs outputs;
  protect_places(options, outputs);
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (const auto done = open(options, i, surroundings, outputs, robots[i]); !done)
      return fail(done.failure().message);
  }
  const auto later = std::find_if(faults.begin(), faults.end(), [](const PlannedFault& fault) {
    return fault.after > rt::Duration{0};
  });
  for (auto fault = faults.begin(); fault != later; ++fault) inflict(*fault, robots);
  faults.erase(faults.begin(), later);
  if (const std::error_code error = start(robots)) {
    return fail("cannot start the virtual Create: " + error.message());
  }
  const auto refused = std::find_if(robots.begin(), robots.end(), [](const Served& robot) {
    return robot.server->priority_error() != 0;
  });
  if (refused != robots.end()) {
    print_remark(rt::explain({.right = rt::Refusal::Right::fifo,
                              .error = refused->server->priority_error(),
                              .wanted = options.priority}) +
                 "; serving without it");
  }
  if (options.view) {
    if (const auto viewed = view(options, surroundings.world, robots); !viewed)
      return fail(viewed.failure().message);
  }
  for (const Served& robot : robots) {
    fmt::print("listening on {}\n", robot.announced);
    if (robot.view) fmt::print("{}\n", robot.view->ready_line());
  }
  std::fflush(stdout);
  serve_until_signal(signals, std::move(faults), robots);
  for (Served& robot : robots) {
    robot.view.reset();
    robot.control.reset();
    robot.server->stop();
  }
  return write_traces(surroundings.world, robots, options.trace, outputs);
}

std::string footer() {
  std::string text =
      "Faults, P for each byte from 0 to 1, DIRECTION to-host (the default), to-robot or both:\n" +
      list_faults() + "\nCommands of the control socket, one per line, each answered by a line:\n";
  for (const hal::sim::ControlInfo& command : hal::sim::controls()) {
    const std::string usage = fmt::format("{} {}", command.name, command.arguments);
    text += fmt::format("  {:<52}  {}\n", usage, command.meaning);
  }
  text += "\nPlants, for --plant and the command plant:\n";
  for (const hal::sim::Plant& plant : hal::sim::plants())
    text += fmt::format("  {:<11}  {}\n", plant.name, plant.meaning);
  return text;
}

// A path that can be printed in one line, so that it can be read from there.
CLI::Validator printable_path() {
  return CLI::Validator{[](const std::string& text) {
                          const bool printable = std::none_of(text.begin(), text.end(), [](char c) {
                            return static_cast<unsigned char>(c) < ' ' || c == '\x7f';
                          });
                          if (text.empty()) return "name a path; this one is empty";
                          return printable ? "" : "name a path without control characters";
                        },
                        ""};
}

void add_places(CLI::App& command, SimulatorOptions& options) {
  command
      .add_option("--link", options.link,
                  "Make this symbolic link to the pseudo-terminal, and print it instead; a link "
                  "that a virtual Create left there is replaced, anything else is refused")
      ->check(printable_path());
  command
      .add_option("--control", options.control,
                  "Listen for commands on this Unix socket, for example: press play")
      ->check(printable_path());
  command.add_option("--world", options.world,
                     "Put it in the world that this text file describes; examples/worlds has some");
  command.add_option(
      "--trace", options.trace,
      "Draw its path through its world to this file at the end: SVG, or PNG if it ends "
      "in .png");
  command
      .add_option("--count", options.count,
                  "Serve this many robots, each alone in its world; --link, --control and --trace "
                  "get the suffix .0 for the first (.0.svg), .1 for the next, and each seed is one "
                  "more than the last")
      ->check(CLI::Range(std::size_t{1}, kMostRobots))
      ->capture_default_str();
  command.add_flag("--together", options.together,
                   "Put all of --count into one world, where they are in each other's way: each at "
                   "its own start or, without one, half a metre to the left of the one before");
  command
      .add_option("--fault", options.faults,
                  "Inject this fault from the beginning, or after 'at SECONDS', as in --fault "
                  "'lost 0.01 both' --fault 'at 5 unplugged'; may be repeated")
      ->type_size(1)
      ->allow_extra_args(false)
      ->check(CLI::Validator{[](const std::string& text) {
                               const auto fault = parse_fault(text);
                               return fault ? std::string{} : fault.failure().message;
                             },
                             "'[at SECONDS] NAME [ARGUMENTS]'"});
}

}  // namespace

void add_sim(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<SimulatorOptions>();
  CLI::App* command =
      app.add_subcommand("sim",
                         "Serve a virtual Create on a pseudo-terminal until Ctrl-C.\n"
                         "Prints `listening on PATH`; open PATH with any Open Interface client as "
                         "if it were a serial port.");
  add_places(*command, *options);
  command
      ->add_option("--boot-baud", options->boot_baud,
                   "Baud rate at power-on: 57600, or 19200 as with Play held down")
      ->capture_default_str();
  command
      ->add_option("--batch", options->batch_bytes,
                   "Hand bytes over to the client in batches of at most this many, as a UART's "
                   "FIFO does; 1: each by itself")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  command->add_flag("--view", options->view,
                    "Show it in the browser, and say where: `serving URL`");
  command->add_option("--http", options->http,
                      "Where --view serves: [ADDRESS:]PORT  [127.0.0.1:8080]");
  command->add_option("--priority", options->priority, "Ask for this SCHED_FIFO priority; 0: none")
      ->check(CLI::Range(0, 98))
      ->capture_default_str();
  add_sim_options(*command, options->sim);
  command->footer(footer);
  command->callback([options, &chosen] { chosen = [options] { return simulate(*options); }; });
}

}  // namespace cargobay::cli
