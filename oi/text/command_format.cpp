// Bytes to text: format_command().
#include <array>

#include "oi/commands.hpp"
#include "oi/parse.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/command_text.hpp"

namespace cargobay::oi {
namespace {

using Bytes = std::span<const std::uint8_t>;

std::int32_t take_number(Bytes& bytes, const ArgumentInfo& argument) {
  const std::int32_t value = number_at(bytes, argument);
  bytes = bytes.subspan(argument.size);
  return value;
}

void write_raw(TextWriter& out, Bytes bytes) {
  out.put(kRawBytesKey);
  for (const std::uint8_t byte : bytes) {
    out.put(" ");
    out.put_number(byte);
  }
}

// A whole command with values in range that is not a script.
void write_plain(TextWriter& out, const CommandInfo& info, Bytes bytes) {
  out.put(info.key);
  bytes = bytes.subspan(1);
  std::array<std::int32_t, 4> values{};
  for (std::size_t i = 0; i < info.argument_count; ++i)
    values[i] = take_number(bytes, info.argument_slots[i]);
  const std::size_t count = info.argument_count - (info.tail == Tail::none ? 0U : 1U);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = wire_place(info, i);
    out.put(" ");
    write_value(out, info.argument_slots[place], values[place]);
  }
  if (info.tail == Tail::packet_ids && bytes.empty()) {
    out.put(" ");
    out.put(kNone);
  }
  while (!bytes.empty()) {
    std::string_view before = " ";
    for (const ArgumentInfo& argument : element_arguments(info.tail)) {
      out.put(before);
      write_value(out, argument, take_number(bytes, argument));
      before = ":";
    }
  }
}

// The commands in it, divided as the robot divides them; whatever is not a command, or is a script,
// as bytes.
void write_script(TextWriter& out, const CommandInfo& info, Bytes body) {
  out.put(info.key);
  out.put(" {");
  std::string_view before = " ";
  while (!body.empty()) {
    const ParseResult parsed = parse_command(body);
    const std::size_t length = parsed.length != 0 ? parsed.length : body.size();
    const Bytes command = body.first(length);
    out.put(before);
    if (parsed.outcome == ParseResult::Outcome::command &&
        parsed.info->tail != Tail::script_bytes) {
      write_plain(out, *parsed.info, command);
    } else {
      write_raw(out, command);
    }
    before = "; ";
    body = body.subspan(length);
  }
  out.put(" }");
}

}  // namespace

std::size_t format_command(std::span<const std::uint8_t> command, std::span<char> out) {
  const ParseResult parsed = parse_command(command);
  if (parsed.outcome != ParseResult::Outcome::command || parsed.length != command.size()) return 0;
  TextWriter writer{out};
  if (parsed.info->tail == Tail::script_bytes) {
    write_script(writer, *parsed.info, command.subspan(2));
  } else {
    write_plain(writer, *parsed.info, command);
  }
  return writer.fits() ? writer.size() : 0;
}

}  // namespace cargobay::oi
