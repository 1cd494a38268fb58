// Ring tones in RTTTL (`name:d=4,o=5,b=100:8e6,8d6,f#,g#.`) to notes of the robot.
//
// Read as phones read them: white space and case do not matter, defaults left out are d=4, o=6,
// b=63, a4 is concert pitch. Public collections differ from the specification, so these are read
// too (docs/protocol.md has them one by one):
//   8c.6 8.c6 8c6.         a dot after the duration, the letter or the octave
//   c_ #c c#5 c5#          a sharp is # or _, on either side of the letter or after the octave
//   eb h r                 a flat; h is b, r is p
//   b=140bpm tempo=140     a unit, and names in full
//   c,o=6,d=8,b=90,ss,e    controls among the notes, and styles
//   v=80, l=2, s=c         controls without effect, and unknown ones
//   d=4 o=5 d4             controls without the comma, or without the =
//   d=4,b=90:c   name:c    no name, or no controls; a name may have colons
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "oi/text/song.hpp"

namespace cargobay::oi {

struct RtttlError {
  enum class What : std::uint8_t {
    no_colon,           // nothing divides name, defaults and notes
    bad_default,        // not `letter=value`
    bad_default_value,  // a number that this default cannot have
    bad_duration,       // not 1, 2, 4, 8, 16, 32 or 64
    bad_note,           // not a to h, p or r
    second_dot,
    out_of_range,  // the robot has no such note
    unexpected,    // anything but a comma after the note
    no_notes,
    too_many_notes,  // more than all slots together hold
  };
  What what = What::no_colon;
  std::size_t column = 1;  // of the character, in bytes from the beginning of the text, from 1
};

// What is wrong, in words: no column, no full stop.
std::string_view message(RtttlError::What what);

struct RingTone {
  std::string_view name{};  // a part of the text, and valid as long as that
  Tune notes{};             // each lasts 1 to kMaxNoteDuration
};

// Fills `tone`, or leaves it alone and returns what is wrong. Tempo does not drift: each note
// begins and ends at its exact time rounded to 1/64 s. A note longer than the robot can hold
// becomes several; one so short that it begins and ends in the same 1/64 s is left out.
std::optional<RtttlError> read_rtttl(std::string_view text, RingTone& tone);

}  // namespace cargobay::oi
