#include "hal/sim/song_player.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr std::uint8_t kLowestNote = 31;
constexpr std::uint8_t kHighestNote = 127;

}  // namespace

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
  if (playing_ || slot >= songs_.size() || songs_[slot].length == 0) return;
  selected_ = slot;
  playing_ = true;
  started_at_ = now;
  ends_at_ = now;
  const Song& song = songs_[slot];
  for (std::size_t i = 0; i < song.length; ++i) ends_at_ += duration(song.notes[i]);
}

void SongPlayer::advance(rt::Duration now) {
  if (playing_ && now >= ends_at_) playing_ = false;
}

void SongPlayer::reset() { *this = SongPlayer{}; }

std::uint8_t SongPlayer::sounding(rt::Duration now) const {
  if (!playing_) return 0;
  const Song& song = songs_[selected_];
  rt::Duration note_ends = started_at_;
  for (std::size_t i = 0; i < song.length; ++i) {
    note_ends += duration(song.notes[i]);
    if (now >= note_ends) continue;
    const std::uint8_t number = song.notes[i].number;
    return number >= kLowestNote && number <= kHighestNote ? number : std::uint8_t{0};
  }
  return 0;
}

rt::Duration SongPlayer::duration(const oi::Note& note) {
  return rt::Duration{std::int64_t{note.duration.value} * 1'000'000'000 / 64};
}

}  // namespace cargobay::hal::sim
