// The sixteen songs, and the one that is playing (OI p. 11, 12).
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
  // `notes` alternates number and duration. Overwrites the song with that number; if it is playing,
  // it plays on unchanged. The manual does not say what a slot beyond 15, no note or more than
  // sixteen mean: they are ignored, and the old song stays.
  void store(std::uint8_t slot, std::span<const std::uint8_t> notes);
  // Ignored while a song plays, and if none is stored.
  void play(std::uint8_t slot, rt::Duration now);
  void stop() { melody_.stop(); }
  // Ends a song that is over.
  void advance(rt::Duration now) { melody_.advance(now); }
  // Forgets all songs.
  void reset();

  bool playing() const { return melody_.playing(); }
  std::uint8_t selected() const { return selected_; }
  // The MIDI number of the note that sounds; 0: silence.
  std::uint8_t sounding(rt::Duration now) const { return melody_.sounding(now); }

 private:
  struct Song {
    std::array<oi::Note, oi::kMaxSongNotes> notes{};
    std::size_t length = 0;
  };

  std::array<Song, oi::kSongSlots> songs_{};
  std::uint8_t selected_ = 0;
  Melody melody_{};  // a copy of the song that is playing
};

}  // namespace cargobay::hal::sim
