// `cargobay decode`: what each byte means, of those the host sends and those the robot sends.

#include <algorithm>
#include <cstdio>
#include <memory>
#include <span>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/commands.hpp"
#include "hal/cli/pasted/pasted_bytes.hpp"
#include "hal/cli/terminal/exit_codes.hpp"
#include "hal/cli/terminal/operands.hpp"
#include "hal/cli/terminal/packet_list.hpp"
#include "hal/cli/terminal/print.hpp"
#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "oi/extensions.hpp"
#include "oi/limits.hpp"
#include "oi/text/create_2.hpp"
#include "oi/text/describe.hpp"

namespace cargobay::cli {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct DecodeOptions {
  std::string from = "guess";
  std::string packets;
  std::string binary;
  std::string line;
  std::uint32_t baud = oi::kCreate.default_baud;
  bool decimal = false;
  bool text_only = false;
  bool extensions = false;

  const oi::Dialect& dialect() const {
    return extensions ? oi::kCreateWithExtensions : oi::kCreate;
  }
};

enum class Side : std::uint8_t { host, robot };

// Whether anything in the bytes is as a robot sends it: a frame, or the beginning of one, or text.
bool has_frame_or_text(const Bytes& bytes, const oi::Dialect& dialect) {
  bool found = false;
  const auto look = [&found](const oi::Annotation& annotation) {
    using Kind = oi::Annotation::Kind;
    found = found || annotation.kind == Kind::header || annotation.kind == Kind::printed ||
            annotation.kind == Kind::value;
  };
  (void)oi::describe_stream(bytes, look, dialect);
  return found;
}

// Of any robot.
bool is_opcode(std::uint8_t byte) {
  return oi::kCreate.find_command(byte) != nullptr || oi::find_extension(byte) != nullptr ||
         !oi::create_2::opcode_name(byte).empty();
}

Side guess(const Bytes& bytes, const oi::Dialect& dialect) {
  const bool command =
      oi::kCreate.find_command(bytes[0]) != nullptr ||
      (dialect.has_undocumented_opcodes && oi::find_extension(bytes[0]) != nullptr);
  return !command && has_frame_or_text(bytes, dialect) ? Side::robot : Side::host;
}

hal::Result<Pasted> bytes_of(const CLI::App& command, const DecodeOptions& options) {
  if (!options.binary.empty()) {
    if (!command.remaining().empty())
      return hal::Failure{"write the bytes, or name a file with --binary; not both"};
    const auto raw = read_all(options.binary);
    if (!raw) return raw.failure();
    return Pasted{{}, {PastedLine{{}, Bytes(raw->begin(), raw->end())}}};
  }
  const auto text = joined_operands(command);
  if (!text) return text.failure();
  return read_pasted(*text, options.decimal ? Base::decimal : Base::hexadecimal, options.baud);
}

// `  12  89 ff           what they mean`, over several lines if there are many bytes.
void print_line(const oi::Annotation& annotation) {
  constexpr std::size_t kOnLine = 6;
  std::span<const std::uint8_t> bytes = annotation.bytes;
  std::size_t offset = annotation.offset;
  const std::string_view indent = annotation.in_script ? "  " : "";
  const std::string_view mark = annotation.sound ? "" : "! ";
  bool first = true;
  do {
    const auto shown = bytes.first(std::min(bytes.size(), kOnLine));
    const std::string hex = fmt::format("{:02x}", fmt::join(shown, " "));
    if (first) {
      fmt::print("{:>5}  {:<18} {}{}{}\n", offset, hex, indent, mark, annotation.text);
    } else {
      fmt::print("{:>5}  {}\n", offset, hex);
    }
    first = false;
    offset += shown.size();
    bytes = bytes.subspan(shown.size());
  } while (!bytes.empty());
}

int describe(const DecodeOptions& options, const Bytes& bytes, Side side) {
  const auto tell = [&options](const oi::Annotation& annotation) {
    if (annotation.kind == oi::Annotation::Kind::command) {
      fmt::print("{:>{}}{}\n", options.text_only ? "" : "= ", options.text_only ? 0 : 28,
                 annotation.text);
    } else if (!options.text_only) {
      print_line(annotation);
    } else if (!annotation.sound) {
      print_remark(fmt::format("at byte {}: {}", annotation.offset, annotation.text));
    }
  };
  oi::Described described;
  if (!options.packets.empty()) {
    const auto packets = read_packet_list(options.packets, options.dialect());
    if (!packets) {
      print_error(packets.failure().message);
      return kFailure;
    }
    described = oi::describe_reply(*packets, bytes, tell, options.dialect());
  } else {
    described = side == Side::host ? oi::describe_commands(bytes, tell, options.dialect())
                                   : oi::describe_stream(bytes, tell, options.dialect());
  }
  std::fflush(stdout);
  if (described.unsound == 0) return kSuccess;
  print_error(described.needed != 0
                  ? fmt::format("the bytes end too early: {} more byte{} needed", described.needed,
                                described.needed == 1 ? "" : "s")
                  : "some of the bytes are not what the manual allows; they are marked with !");
  return kFailure;
}

int decode_line(const Bytes& bytes, const DecodeOptions& options) {
  if (bytes.empty()) {
    print_error("there are no bytes to decode; write for example: cargobay decode 89 ff 38 01 f4");
    return kFailure;
  }
  Side side = options.from == "robot" || options.from == "stream" ? Side::robot : Side::host;
  if (options.from == "guess" && options.packets.empty()) {
    side = guess(bytes, options.dialect());
    print_remark(side == Side::robot ? "read as bytes from the robot (--from robot)"
                                     : "read as commands to the robot (--from host)");
    if (side == Side::host && !is_opcode(bytes[0]))
      print_remark("if they are the reply to Sensors or Query List, name its packets: --packets");
  }
  return describe(options, bytes, side);
}

int decode(const CLI::App& command, const DecodeOptions& options) {
  auto pasted = bytes_of(command, options);
  if (!pasted) {
    print_error(pasted.failure().message);
    return kFailure;
  }
  if (!pasted->form.empty()) print_remark(fmt::format("form: {}", pasted->form));
  if (!options.line.empty()) {
    std::erase_if(pasted->lines, [&](const PastedLine& line) {
      return line.name.find(options.line) == std::string::npos;
    });
  }
  if (pasted->lines.empty()) return decode_line({}, options);
  int code = kSuccess;
  for (const PastedLine& line : pasted->lines) {
    if (pasted->lines.size() > 1) {
      std::fflush(stdout);
      print_remark(fmt::format("line {}:", line.name));
    }
    code = std::max(code, decode_line(line.bytes, options));
  }
  return code;
}

}  // namespace

void add_decode(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<DecodeOptions>();
  CLI::App* command = app.add_subcommand(
      "decode",
      "Say what each byte means: in commands to the robot, in the robot's stream, or in a "
      "reply.\nExit status 1 if bytes are missing, wrong or unknown.");
  take_operands(
      *command, "[HEX...]",
      "bytes in any usual spelling, as pasted: 89 ff, 0x89, 89FF38; dumps of xxd, hexdump, od and\n"
      "  Wireshark; b'\\x89\\xff' and bytes([137, 255]) of Python, arrays of C; CSV of Saleae "
      "Logic,\n"
      "  samples and annotations of sigrok and PulseView. Without HEX, or with '-': standard "
      "input.");
  command
      ->add_option("--from", options->from,
                   "Who sends the bytes: host (or: command) or robot (or: stream); by default "
                   "robot if they have frames or text and do not begin with a command")
      ->check(CLI::IsMember({"host", "command", "robot", "stream"}));
  command->add_option("--packets", options->packets,
                      "The bytes are the reply to Sensors or Query List for these packets");
  command->add_flag("--decimal", options->decimal, "The bytes are written in decimal, 137 255");
  command->add_option("--binary", options->binary,
                      "Read the raw bytes from this file; - for standard input");
  command->add_option(
      "--line", options->line,
      "Only the line or analyser of a logic analyser with this in its name, such as "
      "TX");
  command->add_option("--baud", options->baud, "Baud rate of the samples of a logic analyser")
      ->check(CLI::Range(1U, 10'000'000U))
      ->capture_default_str();
  command->add_flag(
      "--extensions", options->extensions,
      "Of a robot with what the manual does not have: opcodes 7 and 8, packets 43 and "
      "44");
  command->add_flag("--text", options->text_only,
                    "Print only the text of the commands, for encode");
  command->footer(
      "Examples:\n"
      "  cargobay decode 89 ff 38 01 f4\n"
      "  cargobay decode --decimal 19 5 29 2 25 13 0 182\n"
      "  cargobay decode --packets distance,angle 00 10 ff fe\n"
      "  cargobay decode --from robot --binary log.bin\n"
      "  xxd log.bin | cargobay decode --from robot\n"
      "  cargobay decode \"b'\\x89\\xff8\\x01\\xf4'\"\n"
      "  cargobay decode --line TX < uart.csv");
  command->callback([options, command, &chosen] {
    chosen = [options, command] { return decode(*command, *options); };
  });
}

}  // namespace cargobay::cli
