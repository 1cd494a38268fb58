// The command `cargobay`.

#include <algorithm>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/cli/words/completion.hpp"
#include "hal/cli/words/usage.hpp"

namespace {

namespace cli = cargobay::cli;

// Output to a file or a pipe may only now turn out to be unwritable.
int after_output(int code) {
  (void)std::fflush(stdout);  // never fails; output_error() reports the result
  const std::error_code error = cli::output_error();
  const bool ended_by_it = code == cli::kSignalled + SIGPIPE;
  // After a signal, what nothing read is given up without a word.
  if (!error || (code != cli::kSuccess && code != cli::kFailure && !ended_by_it)) return code;
  cli::print_error("cannot write to standard output: " + error.message());
  return cli::kFailure;
}

void add_commands(CLI::App& app, cli::Action& chosen) {
  app.set_version_flag("--version", "cargobay " CARGOBAY_VERSION);
  app.require_subcommand(1);
  app.footer(
      "`cargobay COMMAND --help` explains each command. Without a robot, start with: cargobay "
      "drive");
  cli::add_drive(app, chosen);
  cli::add_replay(app, chosen);
  cli::add_plot(app, chosen);
  cli::add_export(app, chosen);
  cli::add_calibrate(app, chosen);
  cli::add_bringup(app, chosen);
  cli::add_ports(app, chosen);
  cli::add_pins(app, chosen);
  cli::add_doctor(app, chosen);
  cli::add_jitter(app, chosen);
  cli::add_sim(app, chosen);
  cli::add_serve(app, chosen);
  cli::add_top(app, chosen);
  cli::add_teleop(app, chosen);
  cli::add_sensors(app, chosen);
  cli::add_budget(app, chosen);
  cli::add_send(app, chosen);
  cli::add_encode(app, chosen);
  cli::add_decode(app, chosen);
}

// What stands before operands that look like options, in `encode -- -200`. Commands that take
// operands need none, and CLI11 would leave what follows it to the program itself.
void drop_double_dash(const CLI::App& app, std::vector<const char*>& words) {
  const auto takes_operands = [&words](const CLI::App* command) {
    return command->get_name() == words.front() && command->get_allow_extras();
  };
  if (words.empty() || app.get_subcommands(takes_operands).empty()) return;
  const auto dash = std::ranges::find(words, std::string_view{"--"});
  if (dash != words.end()) words.erase(dash);
}

int usage_error(const std::string& message) {
  cli::print_error(message);
  return cli::kUsageError;
}

// A token in the arguments can be read by each user of the machine for as long as it is there.
void hide_token(std::span<char* const> arguments) {
  constexpr std::string_view kOption = "--token";
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    char* secret = nullptr;
    if (arguments[i] == kOption && i + 1 < arguments.size()) secret = arguments[i + 1];
    if (std::string_view{arguments[i]}.starts_with("--token="))
      secret = arguments[i] + kOption.size() + 1;
    if (secret != nullptr) std::memset(secret, 'x', std::strlen(secret));
  }
}

// `words` are those after the program's name.
int run(std::vector<const char*> words) {
  CLI::App app{
      "Cargobay: real-time control of the iRobot Create, and a virtual Create to try it on.",
      "cargobay"};
  cli::Action chosen;
  add_commands(app, chosen);
  if (!words.empty() && std::string_view{words.front()} == cli::kCompleteWord) {
    fmt::print("{}", cli::completions(app, std::span{words}.subspan(1)));
    return after_output(cli::kSuccess);
  }
  if (!words.empty() && std::string_view{words.front()} == cli::kHelpWord) {
    words.erase(words.begin());
    words.push_back("--help");
  }
  if (const auto wrong = cli::wrong_first_word(app, words)) return usage_error(*wrong);
  drop_double_dash(app, words);
  words.insert(words.begin(), "cargobay");
  try {
    app.parse(static_cast<int>(words.size()), words.data());
  } catch (const CLI::Success& wish) {  // --help, --version
    std::ostringstream text;
    const int code = app.exit(wish, text, text);
    fmt::print("{}", text.str());
    return after_output(code);
  } catch (const CLI::ParseError& error) {
    return usage_error(cli::explain(app, error));
  }
  if (const auto wrong = cli::wrong_option(app)) return usage_error(*wrong);
  return after_output(chosen());
}

}  // namespace

int main(int argc, char** argv) {
  if (!cargobay::cli::open_standard_descriptors()) return cargobay::cli::kFailure;
  cargobay::cli::rely_on_standard_streams();
  try {
    const std::span<char* const> arguments{argv + std::min(argc, 1), argv + argc};
    const std::vector<std::string> copies{arguments.begin(), arguments.end()};
    hide_token(arguments);
    std::vector<const char*> words;
    words.reserve(copies.size());
    for (const std::string& copy : copies) words.push_back(copy.c_str());
    return run(std::move(words));
  } catch (const std::exception& error) {
    cargobay::cli::print_error(error.what());
    return cargobay::cli::kFailure;
  }
}
