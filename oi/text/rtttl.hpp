// Ring tones in RTTTL (`name:d=4,o=5,b=100:8e6,8d6,f#,g#.`) to notes of the robot.
//
// Read as phones read them: white space and case do not matter, defaults left out are d=4, o=6,
// b=63, a dot comes before or after the octave, `h` is `b`, a4 is concert pitch. `s=` (style) and
// `l=` (repetitions) are accepted and have no effect.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "oi/text/song.hpp"

namespace cargobay::oi {

struct RtttlError {
  enum class What : std::uint8_t {
    no_name,            // not two colons
    bad_default,        // not d=, o= or b= and a number
    bad_default_value,  // a number that this default cannot have
    bad_duration,       // not 1, 2, 4, 8, 16, 32 or 64
    bad_note,           // not a to h or p
    second_dot,
    out_of_range,  // the robot has no such note
    unexpected,    // anything but a comma after the note
    no_notes,
    too_many_notes,  // more than all slots together hold
  };
  What what = What::no_name;
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
