// The sixteen songs and the one that plays (OI p. 11, 12).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/sim/robot/melody.hpp"
#include "oi/commands.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class SongPlayer {
 public:
  // `notes` are number and duration by turns. A song of that number is overwritten; if it is the
  // one that plays, it plays on as it was. What a slot beyond 15, no note or more than sixteen
  // would mean the manual does not say: they are ignored, and the song that was there stays.
  void store(std::uint8_t slot, std::span<const std::uint8_t> notes);
  // Ignored while a song plays, and where none is stored.
  void play(std::uint8_t slot, rt::Duration now);
  void stop() { melody_.stop(); }
  // Ends the song that is over.
  void advance(rt::Duration now) { melody_.advance(now); }
  // Forgets all songs.
  void reset();

  bool playing() const { return melody_.playing(); }
  std::uint8_t selected() const { return selected_; }
  // The MIDI number that sounds; 0 for silence.
  std::uint8_t sounding(rt::Duration now) const { return melody_.sounding(now); }

 private:
  struct Song {
    std::array<oi::Note, oi::kMaxSongNotes> notes{};
    std::size_t length = 0;
  };

  std::array<Song, oi::kSongSlots> songs_{};
  std::uint8_t selected_ = 0;
  Melody melody_{};  // a copy of the song that plays
};

}  // namespace cargobay::hal::sim
