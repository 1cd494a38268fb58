#include "oi/text/song.hpp"

#include <algorithm>

#include "oi/text/lower.hpp"

namespace cargobay::oi {
namespace {

constexpr int kSemitones = 12;
constexpr std::array<std::string_view, kSemitones> kNames{"c",  "c#", "d",  "d#", "e",  "f",
                                                          "f#", "g",  "g#", "a",  "a#", "b"};

constexpr bool is_rest_name(std::string_view name) {
  return std::ranges::equal(name, kRestName, {}, lower);
}

}  // namespace

std::optional<std::uint8_t> find_note(std::string_view name) {
  if (is_rest_name(name)) return kRest;
  if (name.size() < 2 || name.size() > 3) return std::nullopt;
  const char letter = lower(name.front());
  const auto* const natural = std::ranges::find(kNames, std::string_view{&letter, 1});
  const char octave = name.back();
  if (natural == kNames.end() || octave < '0' || octave > '9') return std::nullopt;
  // c0 is 12.
  int number = kSemitones * (octave - '0' + 1) + static_cast<int>(natural - kNames.begin());
  if (name.size() == 3) {
    if (name[1] != '#' && lower(name[1]) != 'b') return std::nullopt;
    number += name[1] == '#' ? 1 : -1;
  }
  if (number < kLowestNote || number > kHighestNote) return std::nullopt;
  return static_cast<std::uint8_t>(number);
}

NoteName note_name(std::uint8_t number) {
  NoteName name;
  const auto add = [&name](std::string_view text) {
    for (const char character : text) name.characters[name.size++] = character;
  };
  if (is_rest(number)) {
    add(kRestName);
    return name;
  }
  const auto octave = static_cast<char>('0' + number / kSemitones - 1);
  add(kNames[number % kSemitones]);
  add({&octave, 1});
  return name;
}

std::optional<Songs> split(std::span<const Note> notes, std::uint8_t first_slot) {
  Songs songs;
  for (std::size_t slot = first_slot; !notes.empty(); ++slot) {
    if (slot >= kSongSlots) return std::nullopt;
    Song song{.slot = static_cast<std::uint8_t>(slot), .notes = {}};
    const std::size_t count = std::min(notes.size(), kMaxSongNotes);
    if (!song.notes.append(notes.first(count)) || !songs.push_back(song)) return std::nullopt;
    notes = notes.subspan(count);
  }
  return songs;
}

}  // namespace cargobay::oi
