// The sixteen songs and the one that plays (OI p. 11, 12).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/commands.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class SongPlayer {
 public:
  // `notes` are number and duration by turns. A song of that number is overwritten; what a slot
  // beyond 15, no note or more than sixteen would mean the manual does not say: they are ignored.
  void store(std::uint8_t slot, std::span<const std::uint8_t> notes);
  // Ignored while a song plays, and where none is stored.
  void play(std::uint8_t slot, rt::Duration now);
  void stop() { playing_ = false; }
  // Ends the song that is over.
  void advance(rt::Duration now);
  // Forgets all songs.
  void reset();

  bool playing() const { return playing_; }
  std::uint8_t selected() const { return selected_; }
  // The MIDI number that sounds; 0 for silence.
  std::uint8_t sounding(rt::Duration now) const;

 private:
  struct Song {
    std::array<oi::Note, oi::kMaxSongNotes> notes{};
    std::size_t length = 0;
  };
  static rt::Duration duration(const oi::Note& note);

  std::array<Song, oi::kSongSlots> songs_{};
  std::uint8_t selected_ = 0;
  bool playing_ = false;
  rt::Duration started_at_{0};
  rt::Duration ends_at_{0};
};

}  // namespace cargobay::hal::sim
