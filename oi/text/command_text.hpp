// Commands as text and back, by the command table.
//
//   drive -200 500            the manual's name in snake case, then the arguments in its units
//   drive_direct 100 -100     left before right, and drivers 0, 1, 2: not the order of the wire
//   stream distance angle     as many packets as there are; `none` for none; numbers will do too
//   song 0 60:32 c#5:16       note:duration; a note is a number, `c4` (60), `f#5`, `bb3` or `rest`
//   leds play,advance 0 128   bits by name with commas between, `none`, or their sum
//   baud 57600                the rate; a number below 12 is a code
//   script { drive 300 straight; wait_distance 400; drive 0 0 }
//   stop                      drive_direct 0 0: the one command that is not of the manual
//   tune 0 name:d=4,o=5,b=120:8c,8e_,g.   a ring tone (oi/text/rtttl.hpp), as songs from slot 0 on
//
// Commands are separated by `;` or the end of a line; `#` begins a comment. Numbers are decimal or
// hexadecimal (0x1f); in hexadecimal a negative one is its two's complement, as the manual writes
// it. In a script, `bytes 137 1` gives bytes that are not a whole command.
//
// Beyond::manual allows `bytes` outside scripts too, and what some robots know although it is not
// in the manual (oi/extensions.hpp): `soft_reset`, `firmware_date`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "oi/command_table.hpp"
#include "oi/limits.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::oi {

// What is wrong with a text, and where.
struct TextError {
  enum class Code : std::uint8_t {
    unknown_command,
    missing_argument,
    extra_argument,
    bad_value,     // neither a number nor a name that the argument knows
    out_of_range,  // a number outside the manual's range
    bad_note,      // not number:duration
    too_many,      // packets or notes: `limit` is the most
    no_script,     // `script` without `{`
    open_script,   // `{` without `}`
    stray_brace,
    nested_script,
    script_too_long,  // more than `limit` bytes
    bytes_outside,    // `bytes` outside a script
    extension,        // not in the manual
    no_tune,          // `tune` without a ring tone
    bad_tune,         // `hint` says what is wrong in it
    tune_too_long,    // more than the `limit` notes that the slots from this one on hold
    output_full,      // more than the `limit` bytes of the buffer
  };
  Code code = Code::unknown_command;
  std::size_t position = 0;                // of the word, in bytes from the beginning of the text
  std::size_t length = 0;                  // of the word; 0 if something is missing
  const CommandInfo* command = nullptr;    // whose argument it is
  const ArgumentInfo* argument = nullptr;  // with its range and unit
  std::string_view hint{};                 // a name that was probably meant; for bad_tune see there
  std::string_view advice{};               // or what to do here instead of what the word asks for
  std::size_t limit = 0;
};

struct TextResult {
  std::size_t bytes = 0;  // written to `out`; 0 after an error
  std::optional<TextError> error{};
};

// Whether a text may go beyond the commands of the manual.
enum class Beyond : std::uint8_t { nothing, manual };

// Text to bytes. A text without any command gives none, and no error. After an error the contents
// of `out` are useless.
TextResult encode_text(std::string_view text, std::span<std::uint8_t> out,
                       Beyond beyond = Beyond::nothing);

// No text makes more bytes than this.
std::size_t most_bytes(std::string_view text);

// Room for the text of any command: 255 packets with the longest name.
inline constexpr std::size_t kMaxCommandText = [] {
  std::size_t longest = 0;
  for (const PacketInfo& packet : kPackets)
    longest = longest < packet.key.size() ? packet.key.size() : longest;
  return std::string_view{"query_list"}.size() + kMaxQueryPackets * (longest + 1);
}();

// One whole command as text that encode_text() turns into the same bytes: one spelling for each,
// names rather than numbers. Returns the characters written; 0 if the bytes are not one command of
// the manual with values in range, or `out` is too small.
std::size_t format_command(std::span<const std::uint8_t> command, std::span<char> out);

// One line for a user: where, what is wrong, and what would be right. `text` is the one that the
// error is about. Cut off at the end of `out`; 400 characters are enough.
std::size_t format_error(const TextError& error, std::string_view text, std::span<char> out);

// The word for a ring tone.
inline constexpr std::string_view kTuneKey = "tune";

// The word in a script for bytes that are not a whole command, or one with values out of range.
inline constexpr std::string_view kRawBytesKey = "bytes";

// The argument at this place in the text, as an index into the arguments on the wire: in these two
// commands the wire has right before left and driver 2 before driver 0.
constexpr std::size_t wire_place(const CommandInfo& info, std::size_t text_place) {
  const bool reversed = info.opcode == 144 || info.opcode == 145;
  return reversed ? info.argument_count - 1U - text_place : text_place;
}

}  // namespace cargobay::oi
