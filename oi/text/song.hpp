// Notes by name, and tunes longer than one song spread over several slots.
//
// The robot counts durations in 1/64 s and pitches as MIDI does: 60 is middle C, here c4, and 69 is
// a4, 440 Hz. It sounds 31 (g1) to 127 (g9); any other number is a rest (OI p. 11).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "oi/commands.hpp"
#include "oi/fixed_list.hpp"
#include "oi/limits.hpp"
#include "oi/units.hpp"

namespace cargobay::oi {

inline constexpr std::uint8_t kLowestNote = 31;
inline constexpr std::uint8_t kHighestNote = 127;
inline constexpr std::uint8_t kRest = 0;
inline constexpr std::string_view kRestName = "rest";
inline constexpr std::int32_t kMaxNoteDuration = 255;  // 1/64 s

constexpr bool is_rest(std::uint8_t number) {
  return number < kLowestNote || number > kHighestNote;
}

// The number of `c4`, `c#4`, `db4`: letter, sharp or flat, octave, in either case; and of `rest`.
// Nothing for any other text, or for a note that the robot would not sound.
std::optional<std::uint8_t> find_note(std::string_view name);

// A note's name: lower case, sharps only, `rest` for every number that the robot rests on.
struct NoteName {
  std::array<char, 4> characters{};
  std::uint8_t size = 0;
  constexpr std::string_view view() const { return {characters.data(), size}; }
};
NoteName note_name(std::uint8_t number);

// As many notes as all slots together hold.
inline constexpr std::size_t kMaxTuneNotes = kSongSlots * kMaxSongNotes;
using Tune = FixedList<Note, kMaxTuneNotes>;

// How long the notes take, one after another.
constexpr SixtyFourths duration(std::span<const Note> notes) {
  std::int32_t sum = 0;
  for (const Note& note : notes) sum += note.duration.value;
  return SixtyFourths{sum};
}

using Songs = FixedList<Song, kSongSlots>;

// The notes as songs of sixteen, only the last of them shorter, in first_slot and the slots after
// it. Nothing if they do not fit into these; no notes are no songs. The robot ignores Play while it
// plays (OI p. 13): start each song when the one before has ended.
std::optional<Songs> split(std::span<const Note> notes, std::uint8_t first_slot = 0);

}  // namespace cargobay::oi
