// `cargobay jitter`: how late this kernel, board and link are, compared with the best possible.

#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <memory>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/connect/bring_up_report.hpp"
#include "hal/cli/connect/connection.hpp"
#include "hal/cli/connect/open_for_use.hpp"
#include "hal/cli/drawing/picture.hpp"
#include "hal/cli/jitter/jitter_formats.hpp"
#include "hal/cli/jitter/jitter_plot.hpp"
#include "hal/cli/jitter/jitter_summary.hpp"
#include "hal/cli/jitter/jitter_table.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/in_range.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/view/progress.hpp"
#include "hal/jitter/run.hpp"
#include "oi/dialect.hpp"

namespace cargobay::cli {
namespace {

namespace jitter = hal::jitter;

struct JitterOptions {
  PortOptions connection{};
  std::vector<std::string> channels{jitter::kChannelNames.begin(), jitter::kChannelNames.end()};
  double duration_s = 20.0;
  std::size_t frames = 0;
  double period_ms = 1.0;
  int priority = 80;
  std::optional<int> cpu{};
  std::size_t warm_up = 50;
  std::size_t hold_every = 0;
  double hold_ms = 20.0;
  bool load = false;
  std::string json_file;
  std::string hgrm_prefix;
  std::string cyclictest_file;
  std::string plot_file;
};

constexpr double kSliceSeconds = 0.5;

// Runs stress-ng on all processors until it is destroyed.
class Load {
 public:
  Load() = default;
  Load(const Load&) = delete;
  Load& operator=(const Load&) = delete;
  ~Load() {
    if (child_ <= 0) return;
    end();
    waitpid(child_, nullptr, 0);
  }
  void end() const {
    if (child_ > 0) kill(child_, SIGTERM);
  }
  hal::Result<void> start() {
    std::string name = "stress-ng";
    std::string all = "0";
    std::string cpu = "--cpu";
    std::string quiet = "--quiet";
    std::array<char*, 5> arguments{name.data(), cpu.data(), all.data(), quiet.data(), nullptr};
    // Our signals are blocked; stress-ng must receive its own.
    sigset_t none{};
    sigset_t all_defaults{};
    sigemptyset(&none);
    sigfillset(&all_defaults);
    posix_spawnattr_t attributes{};
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all_defaults);
    const int error =
        posix_spawnp(&child_, name.c_str(), nullptr, &attributes, arguments.data(), environ);
    posix_spawnattr_destroy(&attributes);
    if (error == 0) return {};
    child_ = -1;
    return hal::Failure{
        "--load needs stress-ng, which is not installed; install it: apt-get install stress-ng"};
  }

 private:
  pid_t child_ = -1;
};

bool wants(const JitterOptions& options, std::string_view channel) {
  return std::ranges::find(options.channels, channel) != options.channels.end();
}

jitter::Settings settings(const JitterOptions& options) {
  const double frames = kSliceSeconds * 1e3 / options.period_ms;
  jitter::Settings settings{
      .period = rt::Duration{std::llround(options.period_ms * 1e6)},
      .priority = options.priority,
      .cpu = options.cpu,
      .warm_up = options.warm_up,
      .slice_frames = std::max<std::size_t>(static_cast<std::size_t>(frames), 10)};
  choose_processors(settings);
  return settings;
}

std::size_t rounds(const JitterOptions& options, const jitter::Settings& of) {
  if (options.frames > 0) return (options.frames + of.slice_frames - 1) / of.slice_frames;
  const double slice_s =
      static_cast<double>(of.slice_frames + of.warm_up) * options.period_ms / 1e3;
  const double all = options.duration_s / slice_s / static_cast<double>(options.channels.size());
  return std::max<std::size_t>(static_cast<std::size_t>(std::lround(all)), 1);
}

std::string hgrm_key(std::string_view channel) { return fmt::format("--hgrm of {}", channel); }

hal::Result<void> open_outputs(const JitterOptions& options, Outputs& outputs) {
  if (auto good = check_picture_name("--plot", options.plot_file); !good) return good;
  protect_config(options.connection, outputs);
  if (auto done = outputs.open("--json", options.json_file); !done) return done;
  if (auto done = outputs.open("--cyclictest", options.cyclictest_file); !done) return done;
  if (auto done = outputs.open("--plot", options.plot_file); !done) return done;
  if (options.hgrm_prefix.empty()) return {};
  for (const std::string& channel : options.channels) {
    const std::string file = options.hgrm_prefix + "-" + channel + ".hgrm";
    if (auto done = outputs.open(hgrm_key(channel), file); !done) return done;
  }
  return {};
}

// Writes every file that can be written. Returns the first failure.
hal::Result<void> save(const jitter::Run& run, const JitterSummary& summary,
                       const JitterOptions& options, Outputs& outputs) {
  hal::Result<void> saved;
  const auto write = [&](const std::string& key, const std::string& text) {
    auto done = outputs.write(key, text);
    if (saved) saved = std::move(done);
  };
  if (!options.json_file.empty()) write("--json", json(summary));
  if (!options.cyclictest_file.empty()) {
    std::vector<const jitter::Measured*> channels;
    for (const auto& channel : run.channels()) channels.push_back(&channel->measured());
    write("--cyclictest", cyclictest(channels));
  }
  if (!options.plot_file.empty()) {
    const std::string held = held_back(summary.settings.value_or(JitterSettings{}));
    const std::string title =
        fmt::format("Timing jitter, {:.0f} s at {:g} ms{}{}", summary.seconds, options.period_ms,
                    options.load ? ", loaded" : "", held.empty() ? "" : ", " + held);
    const auto drawing = picture(jitter_plot({summary}, title), options.plot_file);
    if (drawing) write("--plot", *drawing);
    if (!drawing && saved) saved = drawing.failure();
  }
  if (options.hgrm_prefix.empty()) return saved;
  for (const ChannelSummary& channel : summary.channels)
    write(hgrm_key(channel.name), hgrm(channel));
  return saved;
}

// Measures on a separate thread, so that this one can watch for signals and print the progress.
hal::Result<void> measure(jitter::Run& run, StopSignals& signals, std::optional<int>& signal) {
  std::atomic<bool> stop{false};
  std::atomic<bool> done{false};
  std::atomic<double> share{0.0};
  hal::Result<void> measured;
  std::thread measuring{[&] {
    measured = run.measure(stop, [&](double so_far) { share.store(so_far); });
    done.store(true);
  }};
  while (!done.load()) {
    const auto caught = signals.wait(std::chrono::milliseconds{100});
    if (caught && !signal) signal = caught;
    if (signal) stop.store(true);
    show_line(fmt::format("measuring, {:3.0f} % done; Ctrl-C ends it and keeps what was measured",
                          100.0 * share.load()));
  }
  clear_line();
  measuring.join();
  return measured;
}

struct Robot {
  hal::ChosenRobot chosen{};
  std::string link{};
};

hal::Result<Robot> find_robot(const JitterOptions& options, jitter::RunRequest& request) {
  Robot robot;
  if (!wants(options, "robot")) return robot;
  auto config = configuration(options.connection);
  if (!config) return config.failure();
  if (config->port.empty()) config->baud = oi::kCreate.default_baud;
  // Above the loop's: what the virtual Create does late would be taken for the loop's lateness.
  auto chosen = hal::choose_robot(*config, {}, options.priority + 5);
  if (!chosen) return chosen.failure();
  robot.chosen = std::move(*chosen);
  request.server = robot.chosen.server();
  request.bring_up.pins = robot.chosen.pins();
  // A virtual Create has another terminal each time, which makes no difference.
  robot.link = fmt::format("{} at {} baud{}", request.server ? "virtual Create" : robot.chosen.port,
                           *config->baud, request.server ? ", frames every 15 ms" : "");
  auto stream = open_for_use(robot.chosen.port, *config->baud);
  if (!stream) return stream.failure();
  request.robot = std::move(*stream);
  return robot;
}

// Brings the robot up, if one is wanted. `signal` is set if one ended that.
hal::Result<std::unique_ptr<jitter::Run>> prepare(jitter::RunRequest request, StopSignals& signals,
                                                  std::optional<int>& signal) {
  Progress progress{"preparing"};
  request.bring_up.progress = [&](const hal::BringUpEvent& event) {
    progress.say(in_words(event));
  };
  request.bring_up.cancelled = [&] {
    if (!signal) signal = signals.wait(rt::Duration::zero());
    return signal.has_value();
  };
  return jitter::Run::prepare(std::move(request));
}

int run_jitter(const JitterOptions& options) {
  StopSignals signals{SIGTSTP};
  const auto fail = [](const hal::Failure& failure) {
    print_error(failure.message);
    return kFailure;
  };
  if (options.cpu && !jitter::may_run_on(*options.cpu)) {
    return fail(
        {fmt::format("--cpu {}: this process may not run there; see which CPUs it may use: "
                     "taskset -cp $$",
                     *options.cpu)});
  }
  Outputs outputs;
  if (const auto done = open_outputs(options, outputs); !done) return fail(done.failure());
  jitter::RunRequest request{.channels = options.channels, .settings = settings(options)};
  request.rounds = rounds(options, request.settings);
  const JitterSettings measured_with{.cpu = request.settings.cpu,
                                     .source_cpu = request.settings.source_cpu,
                                     .warm_up = options.warm_up,
                                     .hold_every = options.hold_every,
                                     .hold_ms = options.hold_ms};
  request.held = {.every = options.hold_every,
                  .by = rt::Duration{std::llround(options.hold_ms * 1e6)}};
  Load load;
  if (options.load) {
    if (const auto done = load.start(); !done) return fail(done.failure());
  }
  const AtFirstSignal unload{[&load] { load.end(); }};
  auto robot = find_robot(options, request);  // outlives the run
  if (!robot) return fail(robot.failure());
  std::optional<int> signal;
  auto run = prepare(std::move(request), signals, signal);
  if (signal) return kSignalled + *signal;
  if (!run) return fail(run.failure());

  const jitter::Usage before = jitter::look_at_usage();
  const rt::TimePoint begin = rt::Clock::now();
  const auto measured = measure(**run, signals, signal);
  const double seconds = rt::seconds(rt::Clock::now() - begin);
  const jitter::Usage used = jitter::look_at_usage() - before;

  JitterSummary summary = summarise(**run, signal ? Care::hurried : Care::full);
  summary.link = robot->link;
  summary.seconds = seconds;
  summary.settings = measured_with;
  summary.load = options.load ? "stress-ng --cpu 0" : "";
  summary.conditions = jitter::look_at_conditions();
  summary.usage = used;
  if (options.json_file != "-") fmt::print("{}", table(summary, bars_of_locale()));
  const auto saved = save(**run, summary, options, outputs);
  if (!measured) return fail(measured.failure());
  if (!saved) return fail(saved.failure());
  return signal ? kSignalled + *signal : kSuccess;
}

void add_outputs(CLI::App& command, JitterOptions& options) {
  command.add_option("--json", options.json_file,
                     "Write everything to this file; - for standard output");
  command.add_option("--hgrm", options.hgrm_prefix,
                     "Write HdrHistogram percentiles to PREFIX-<channel>.hgrm, microseconds");
  command.add_option("--cyclictest", options.cyclictest_file,
                     "Write a histogram as cyclictest -h --histfile does; its threads are the "
                     "channels, in the order of the table");
  command.add_option("--plot", options.plot_file,
                     "Draw percentile curves and histograms: SVG, or PNG if the name ends in .png");
}

}  // namespace

void add_jitter(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<JitterOptions>();
  CLI::App* command = app.add_subcommand(
      "jitter",
      "Measure the timing of the loop on this machine, next to the best that the same kernel can "
      "do.\nChannels, measured in turn, a slice at a time, so that disturbances reach all of them "
      "alike:\n"
      "  robot  the loop on a robot: --port, or a virtual Create at its 15 ms\n"
      "  loop   the same loop on frames that come every --period, over a pseudo-terminal\n"
      "  echo   a bare poll, read and write in its place: the least that any program has to do\n"
      "  again  echo once more; the difference between the two is the noise\n"
      "  pipe   echo through pipes: what the terminal layer costs\n"
      "  sleep  a sleep until an absolute time, as cyclictest measures it\n"
      "Percentiles count what a late frame kept waiting (corrected for coordinated omission).");
  command->require_subcommand(0, 1);
  add_port_options(*command, options->connection);
  command->add_option("--channels", options->channels, "Which of them, separated by commas")
      ->delimiter(',')
      ->check(CLI::IsMember(
          std::vector<std::string>{jitter::kChannelNames.begin(), jitter::kChannelNames.end()}));
  command
      ->add_option("--duration", options->duration_s,
                   "Seconds for all channels together; ratios need about 140 for intervals")
      ->check(in_range(1.0, 86400.0))
      ->capture_default_str();
  command
      ->add_option("--frames", options->frames,
                   "Instead of a time: this many frames for each channel except robot")
      ->check(CLI::Range(std::size_t{1}, std::size_t{100'000'000}));
  command->add_option("--period", options->period_ms, "Milliseconds from frame to frame")
      ->check(in_range(1.0, 15.0))
      ->capture_default_str();
  command->add_option("--priority", options->priority, "SCHED_FIFO priority of what is measured")
      ->check(CLI::Range(2, 93))
      ->capture_default_str();
  command->add_option("--cpu", options->cpu, "Run what is measured on this CPU only");
  command->add_option("--warm-up", options->warm_up, "Frames of each slice that are not counted")
      ->check(CLI::Range(std::size_t{0}, std::size_t{10'000}))
      ->capture_default_str();
  command->add_flag("--load", options->load, "Load all CPUs with stress-ng while measuring");
  command->add_option(
      "--hold-every", options->hold_every,
      "Hold back every Nth frame of loop, echo and a virtual Create, to see it reported");
  command
      ->add_option("--hold", options->hold_ms, "Milliseconds for which such a frame is held back")
      ->check(in_range(0.1, 1000.0))
      ->capture_default_str();
  add_outputs(*command, *options);
  add_jitter_compare(*command, chosen);
  command->callback([options, command, &chosen] {
    if (command->get_subcommands().empty()) chosen = [options] { return run_jitter(*options); };
  });
}

}  // namespace cargobay::cli
