#include "hal/cli/words/usage.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "oi/command_table.hpp"
#include "oi/extensions.hpp"
#include "oi/text/nearest_name.hpp"
#include "oi/text/word_advice.hpp"

namespace cargobay::cli {
namespace {

struct Meaning {
  std::string_view words;  // with blanks between
  std::string_view meaning;
};

// What people type in place of a subcommand.
constexpr Meaning kForSubcommands[]{
    {"stop halt brake", "this stops the wheels of a robot: cargobay send --port PORT stop"},
    {"record log save capture", "a drive is recorded with: cargobay drive --record FILE"},
    {"dock clean spot cover demo home",
     "the robot's own demos are started with: cargobay send (see cargobay send --help)"},
    {"on off power wake reset start connect init setup begin",
     "a robot is brought up, and switched on if its power toggle is wired, with: cargobay bringup"},
    {"list scan devices device tty usb serial", "the serial ports are listed with: cargobay ports"},
    {"gpio lines chips", "the GPIO lines are listed with: cargobay pins"},
    {"simulate simulator simulation virtual emulate serve fake",
     "a virtual Create is served with: cargobay sim"},
    {"status state read listen monitor watch battery info telemetry sense",
     "what the robot senses is shown with: cargobay sensors"},
    {"test check diagnose diagnostics selftest system",
     "this machine and its link are checked with: cargobay doctor"},
    {"latency benchmark bench timing cyclictest histogram measure",
     "timing is measured with: cargobay jitter"},
    {"compare diff", "results of jitter are compared with: cargobay jitter compare"},
    {"tune song play beep music rtttl", "tunes are sent with: cargobay send (see its --help)"},
    {"config configure configuration settings calibration",
     "the configuration file is described in: man cargobay.toml; calibrate writes to it"},
    {"draw graph chart picture svg", "a recording is drawn with: cargobay plot"},
    {"csv jsonl mcap foxglove convert dump numpy pandas matlab excel",
     "a recording is written for other programs with: cargobay export"},
    {"hex bytes disassemble parse", "bytes are explained with: cargobay decode"},
    {"run go move forward teleop", "a robot is driven with: cargobay drive --port PORT"},
    {"version", "write: cargobay --version"},
};

struct Synonym {
  std::string_view words;
  std::string_view option;
};

// What people type in place of an option.
constexpr Synonym kForOptions[]{
    {"p device dev tty serial serial_port", "port"},
    {"b baudrate baud_rate rate bps", "baud"},
    {"t d time seconds secs timeout runtime length", "duration"},
    {"c cfg conf configuration", "config"},
    {"s velocity", "speed"},
    {"o out outfile", "output"},
    {"svg png image picture graph chart", "plot"},
    {"log save capture", "record"},
    {"sim simulate simulated", "virtual"},
    {"rt realtime real_time", "require-rt"},
    {"prio", "priority"},
    {"core affinity", "cpu"},
    {"v", "version"},
    {"usage", "help"},
};

// Weaker stops and guards: suggested for their misspelling only.
constexpr std::string_view kNotGuessed[]{"leave-running", "no-guard", "drive-on", "full"};
// These drive a robot.
constexpr std::string_view kMoving[]{"drive", "calibrate", "send", "jitter"};

bool is_listed(std::string_view words, std::string_view wanted) {
  while (!words.empty()) {
    const std::size_t blank = std::min(words.find(' '), words.size());
    if (oi::is_spelt_alike(words.substr(0, blank), wanted)) return true;
    words.remove_prefix(std::min(blank + 1, words.size()));
  }
  return false;
}

bool looks_like_option(std::string_view word) {
  if (word.find(' ') != std::string_view::npos) return false;
  return word.starts_with("--") || (word.starts_with('-') && word.size() > 1 && word[1] >= 'A');
}

// Its name without dashes and value.
std::string_view bare(std::string_view option) {
  option.remove_prefix(std::min(option.find_first_not_of('-'), option.size()));
  return option.substr(0, option.find('='));
}

std::string full_name(const CLI::App& command) {
  const CLI::App* const parent = command.get_parent();
  return parent == nullptr ? command.get_name() : full_name(*parent) + " " + command.get_name();
}

// The subcommand that the words led to.
const CLI::App& innermost(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().back();
  return *command;
}

std::string help_of(const CLI::App& command) {
  return fmt::format("see: {} --help", full_name(command));
}

std::vector<std::string> subcommand_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

// By its spelling, or by its first letters if it is the only one that begins so. Empty if none was.
std::string meant_subcommand(const CLI::App& app, std::string_view word) {
  constexpr std::size_t kTelling = 3;  // letters
  oi::NearestName nearest{word};
  const std::vector<std::string> names = subcommand_names(app);
  std::vector<std::string> begun;
  for (const std::string& name : names) {
    if (std::ranges::find(kMoving, name) != std::end(kMoving)) {
      nearest.consider_misspelt(name);
    } else {
      nearest.consider(name);
      if (word.size() >= kTelling && name.starts_with(word)) begun.push_back(name);
    }
  }
  if (nearest.name().empty() && begun.size() == 1) return begun.front();
  return std::string{nearest.name()};
}

bool is_for_the_robot(std::string_view word) {
  const auto is_it = [word](const oi::CommandInfo& info) {
    return oi::is_spelt_alike(info.key, word);
  };
  return std::ranges::any_of(oi::kCommands, is_it) ||
         std::ranges::any_of(oi::kExtensionCommands, is_it, &oi::ExtensionCommand::info);
}

std::string unknown_subcommand(const CLI::App& app, std::string_view word) {
  const std::string begin = fmt::format("'{}' is not a command", word);
  const std::string meant = meant_subcommand(app, word);
  // Drive is drive, before it is a command of the robot.
  if (!oi::is_spelt_alike(meant, word)) {
    for (const Meaning& each : kForSubcommands) {
      if (is_listed(each.words, word)) return fmt::format("{}; {}", begin, each.meaning);
    }
    if (is_for_the_robot(word)) {
      return fmt::format("{} of this program but one of the robot's; see: cargobay send --help",
                         begin);
    }
  }
  if (meant.empty()) return fmt::format("{}; {}", begin, help_of(app));
  return fmt::format("{}; did you mean '{}'? see: cargobay {} --help", begin, meant, meant);
}

bool has_option(const CLI::App& command, std::string_view name) {
  return std::ranges::any_of(command.get_options(), [name](const CLI::Option* option) {
    return std::ranges::find(option->get_lnames(), name) != option->get_lnames().end();
  });
}

// The name of the option that was probably meant; empty if none was.
std::string meant_option(const CLI::App& command, std::string_view word) {
  for (const Synonym& each : kForOptions) {
    if (is_listed(each.words, bare(word)) && has_option(command, each.option))
      return std::string{each.option};
  }
  oi::NearestName nearest{bare(word)};
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      if (std::ranges::find(kNotGuessed, name) != std::end(kNotGuessed)) {
        nearest.consider_misspelt(name);
      } else {
        nearest.consider(name);
      }
    }
  }
  return std::string{nearest.name()};
}

std::string unknown_option(const CLI::App& command, std::string_view word) {
  const std::string_view shown = word.substr(0, word.find('='));
  const std::string begin = fmt::format("{} has no option {}", full_name(command), shown);
  const std::string meant = meant_option(command, word);
  if (meant.empty()) return fmt::format("{}; {}", begin, help_of(command));
  return fmt::format("{}; did you mean --{}? {}", begin, meant, help_of(command));
}

std::optional<std::string> unknown_option_in(const CLI::App& command) {
  for (const std::string& word : command.remaining()) {
    if (looks_like_option(word)) return unknown_option(command, word);
  }
  return std::nullopt;
}

std::string left_over(const CLI::App& app, const CLI::App& command) {
  std::vector<std::string> words = command.remaining();
  if (words.empty()) words = app.remaining();  // what follows `--`
  if (words.empty()) return help_of(command);
  const std::string begin = fmt::format("{} takes no '{}'", full_name(command), words.front());
  const std::string meant = meant_subcommand(command, words.front());
  if (meant.empty()) return fmt::format("{}; {}", begin, help_of(command));
  return fmt::format("{}; did you mean '{}'? {}", begin, meant, help_of(command));
}

}  // namespace

std::optional<std::string> wrong_first_word(const CLI::App& app,
                                            std::span<const char* const> words) {
  if (words.empty()) return fmt::format("which command? {}", help_of(app));
  const std::string_view word{words.front()};
  if (!word.starts_with('-')) {
    const std::vector<std::string> names = subcommand_names(app);
    if (std::ranges::find(names, word) != names.end()) return std::nullopt;
    return unknown_subcommand(app, word);
  }
  const bool known = std::ranges::any_of(app.get_options(), [word](const CLI::Option* option) {
    return option->check_name(std::string{word});
  });
  if (known) return std::nullopt;
  if (const std::string meant = meant_option(app, word); !meant.empty())
    return fmt::format("{} has no option {}; did you mean --{}?", app.get_name(), word, meant);
  return fmt::format("{} has no option {} of its own; options follow the command: {} COMMAND {}",
                     app.get_name(), word, app.get_name(), word);
}

std::optional<std::string> wrong_option(const CLI::App& app) {
  return unknown_option_in(innermost(app));
}

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = innermost(app);
  // An option that is unknown may be why another seems to be missing.
  if (const auto unknown = unknown_option_in(command)) return *unknown;
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) return left_over(app, command);
  return fmt::format("{}; {}", error.what(), help_of(command));
}

}  // namespace cargobay::cli
