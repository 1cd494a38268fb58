#include "hal/sim/robot/song_player.hpp"

namespace cargobay::hal::sim {

void SongPlayer::store(std::uint8_t slot, std::span<const std::uint8_t> notes) {
  const std::size_t length = notes.size() / 2;
  if (slot >= songs_.size() || length == 0 || length > oi::kMaxSongNotes) return;
  Song& song = songs_[slot];
  song.length = length;
  for (std::size_t i = 0; i < length; ++i) {
    song.notes[i] = oi::Note{notes[2 * i], oi::SixtyFourths{notes[2 * i + 1]}};
  }
}

void SongPlayer::play(std::uint8_t slot, rt::Duration now) {
  if (playing() || slot >= songs_.size() || songs_[slot].length == 0) return;
  selected_ = slot;
  const Song& song = songs_[slot];
  melody_.start(std::span{song.notes}.first(song.length), now);
}

void SongPlayer::reset() { *this = SongPlayer{}; }

}  // namespace cargobay::hal::sim
