// The host's side: describe_commands(). The robot's is oi/text/describe_stream.cpp.
#include "oi/text/describe.hpp"

#include <algorithm>
#include <array>

#include "oi/commands.hpp"
#include "oi/extensions.hpp"
#include "oi/parse.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/command_text.hpp"
#include "oi/text/create_2.hpp"
#include "oi/text/song.hpp"

namespace cargobay::oi {
namespace {

using Kind = Annotation::Kind;
using Bytes = std::span<const std::uint8_t>;

void write_seconds(TextWriter& out, std::int32_t count, std::int32_t per_second) {
  const std::int32_t milliseconds = count * 1000 / per_second;
  out.put(" (");
  out.put_number(milliseconds / 1000);
  out.put(".");
  out.put_number(milliseconds / 100 % 10);
  if (milliseconds % 100 != 0) out.put_number(milliseconds / 10 % 10);
  if (milliseconds % 10 != 0) out.put_number(milliseconds % 10);
  out.put(" s)");
}

// `radius straight`, `velocity -200 mm/s`, `packet 19 distance`.
void write_meaning(TextWriter& out, const ArgumentInfo& argument, std::int32_t value) {
  out.put(argument.name);
  out.put(" ");
  const std::string_view name = value_name(argument, value);
  const bool bits = is_bit_set(argument) && argument.accepts(value);
  out.put_number(value);
  if (bits) {
    out.put(" ");
    write_value(out, argument, value);
  } else if (!name.empty()) {
    out.put(argument.name == "code" ? ": " : " ");
    out.put(name);
    if (argument.name == "code") out.put(" baud");
  } else if (argument.name == "note" && is_rest(static_cast<std::uint8_t>(value))) {
    out.put(" ");
    out.put(kRestName);
  }
  if (name.empty() && argument.unit != Unit::none) {
    out.put(" ");
    out.put(symbol(argument.unit));
  }
  if (argument.unit == Unit::tenth_of_second) write_seconds(out, value, 10);
  if (argument.unit == Unit::sixty_fourth_of_second) write_seconds(out, value, 64);
}

class CommandDescriber {
 public:
  CommandDescriber(Bytes bytes, const AnnotationSink& sink, const Dialect& dialect)
      : bytes_{bytes}, dialect_{dialect}, tell_{bytes, sink} {}

  Described run() {
    commands(bytes_.size());
    return tell_.described();
  }

 private:
  // From at_ to `end`: the end of the bytes, or of the script in them.
  void commands(std::size_t end) {
    while (at_ < end) {
      const std::size_t begin = at_;
      const Bytes rest = bytes_.subspan(begin, end - begin);
      const ParseResult parsed = parse_command(rest);
      if (parsed.info == nullptr) {
        unknown(rest[0]);
        continue;
      }
      command(*parsed.info, end);
      if (parsed.outcome == ParseResult::Outcome::incomplete) {
        at_ = end;
        if (!in_script_) return tell_.tell_missing(parsed.needed);
        tell_.words().put("the script ends inside this command");
        tell_.tell(Kind::missing, end, 0, false);
      } else if (parsed.outcome == ParseResult::Outcome::command && !in_script_) {
        const std::size_t size = format_command(rest.first(parsed.length), text_);
        tell_.tell_text(Kind::command, begin, parsed.length, {text_.data(), size});
      }
    }
  }

  void unknown(std::uint8_t opcode) {
    TextWriter& out = tell_.words();
    const ExtensionCommand* const extension = find_extension(opcode);
    const std::string_view other = create_2::opcode_name(opcode);
    if (extension != nullptr && dialect_.has_undocumented_opcodes) {
      out.put(extension->info.name);
      out.put(", not in the manual: ");
      out.put(extension->meaning);
      return tell_.tell(Kind::opcode, at_++, 1);
    }
    out.put_number(opcode);
    if (extension != nullptr) {
      out.put(" is not a command of the manual, only of some robots: ");
      out.put(extension->meaning);
    } else if (!other.empty()) {
      out.put(
          " is not a command of this robot, which ignores it; the Create 2 and Roombas have it: ");
      out.put(other);
    } else {
      out.put(" is not a command; the robot ignores it");
    }
    tell_.tell(Kind::unknown_opcode, at_++, 1, false);
  }

  // The opcode and as much after it as is there.
  void command(const CommandInfo& info, std::size_t end) {
    TextWriter& out = tell_.words();
    out.put(info.name);
    out.put(" (OI p. ");
    out.put_number(info.page);
    out.put(")");
    const bool nested = in_script_ && info.tail == Tail::script_bytes;
    if (nested) out.put(": a script cannot hold a script");
    tell_.tell(Kind::opcode, at_++, 1, !nested);
    std::int32_t value = 0;
    for (const ArgumentInfo& argument : info.arguments()) {
      if (!number(Kind::argument, argument, end, value)) return;
    }
    if (info.tail == Tail::script_bytes) return script(static_cast<std::size_t>(value), end);
    for (std::int32_t i = 0; info.tail != Tail::none && i < value; ++i) {
      std::int32_t ignored = 0;
      for (const ArgumentInfo& argument : element_arguments(info.tail)) {
        if (!number(Kind::element, argument, end, ignored)) return;
      }
    }
  }

  // False if the bytes end before the number does.
  bool number(Kind kind, const ArgumentInfo& argument, std::size_t end, std::int32_t& value) {
    if (end - at_ < argument.size) {
      // Half a number is shown on its own.
      if (at_ < end) {
        tell_.words().put(argument.name);
        tell_.tell(kind, at_, end - at_);
      }
      at_ = end;
      return false;
    }
    value = number_at(bytes_.subspan(at_), argument);
    TextWriter& out = tell_.words();
    write_meaning(out, argument, value);
    const bool packet = argument.name == "packet" && !argument.accepts(value);
    const PacketInfo* const extended =
        packet ? dialect_.find_packet(static_cast<std::uint8_t>(value)) : nullptr;
    const bool sound = argument.accepts(value) || extended != nullptr;
    if (extended != nullptr) {
      out.put(" ");
      out.put(extended->key);
    }
    if (!sound) {
      out.put(": out of range; ");
      write_choice(out, argument);
      if (packet) write_foreign(out, static_cast<std::uint8_t>(value));
    }
    tell_.tell(kind, at_, argument.size, sound);
    at_ += argument.size;
    return true;
  }

  static void write_foreign(TextWriter& out, std::uint8_t id) {
    const create_2::Packet* const other = create_2::find_packet(id);
    if (other == nullptr) return;
    out.put(". The Create 2 has it: ");
    out.put(other->name);
  }

  void script(std::size_t length, std::size_t end) {
    const std::size_t script_end = at_ + std::min(length, end - at_);
    if (in_script_) {
      tell_.words().put("of the script inside");
      if (script_end > at_) tell_.tell(Kind::element, at_, script_end - at_);
      at_ = script_end;
      return;
    }
    in_script_ = true;
    tell_.enter_script();
    const bool whole = script_end - at_ == length;
    // A script cut short is not a shorter script: what is there is described, and the end is
    // missing.
    if (whole) {
      commands(script_end);
    } else {
      commands_of_part(script_end);
    }
    tell_.leave_script();
    in_script_ = false;
  }

  // The last of these may be cut short by the end of all bytes; the caller reports how many are
  // missing.
  void commands_of_part(std::size_t end) {
    while (at_ < end) {
      const ParseResult parsed = parse_command(bytes_.subspan(at_, end - at_));
      if (parsed.info == nullptr) {
        unknown(bytes_[at_]);
      } else {
        command(*parsed.info, end);
      }
    }
  }

  Bytes bytes_;
  const Dialect& dialect_;
  Annotator tell_;
  std::size_t at_ = 0;
  bool in_script_ = false;
  std::array<char, kMaxCommandText> text_{};
};

}  // namespace

Described describe_commands(std::span<const std::uint8_t> bytes, AnnotationSink sink,
                            const Dialect& dialect) {
  return CommandDescriber{bytes, sink, dialect}.run();
}

}  // namespace cargobay::oi
