// `cargobay encode`: translates commands from text to the bytes that a robot understands.

#include <cstdio>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/operands.hpp"
#include "hal/cli/terminal/print.hpp"

namespace cargobay::cli {
namespace {

int encode(const CLI::App& command, bool binary) {
  const auto text = joined_operands(command);
  if (!text) {
    print_error(text.failure().message);
    return kFailure;
  }
  const auto bytes = encode_or_explain(*text, oi::Beyond::manual);
  if (!bytes) return kFailure;
  if (!binary) {
    fmt::print("{:02x}\n", fmt::join(*bytes, " "));
    return kSuccess;
  }
  if (stdout_is_terminal()) {
    print_error("raw bytes would upset this terminal; send them to a file or a program");
    return kFailure;
  }
  const bool written = std::fwrite(bytes->data(), 1, bytes->size(), stdout) == bytes->size();
  if (written && std::fflush(stdout) == 0) return kSuccess;
  print_error("cannot write to standard output");
  return kFailure;
}

}  // namespace

void add_encode(CLI::App& app, Action& chosen) {
  auto binary = std::make_shared<bool>(false);
  CLI::App* command =
      app.add_subcommand("encode", "Print the bytes of Open Interface commands, in hexadecimal.");
  take_operands(*command, "TEXT...",
                "the manual's command names in lower case with underscores, arguments left before "
                "right,\ncommands separated by ';'. `stop` is drive_direct 0 0, `tune SLOT RTTTL` "
                "makes songs "
                "of a ring tone\n(docs/protocol.md), `bytes` takes any bytes. Without TEXT, or "
                "with '-': standard "
                "input.");
  command->add_flag("--binary", *binary, "Write the raw bytes instead");
  command->footer(
      "Examples:\n"
      "  cargobay encode drive -200 500\n"
      "  cargobay encode 'safe; drive_direct 100 100; leds play,advance 0 255'\n"
      "  cargobay encode stream distance angle oi_mode\n"
      "  cargobay encode 'song 0 c4:32 rest:16 64:32'\n"
      "  cargobay encode 'tune 0 name:d=4,o=5,b=120:8c,8e_,g.'\n"
      "  cargobay encode 'bytes 142 100'\n"
      "  cargobay encode 'script { drive 300 straight; wait_distance 400; drive 0 0 }'");
  command->callback([binary, command, &chosen] {
    chosen = [binary, command] { return encode(*command, *binary); };
  });
}

}  // namespace cargobay::cli
