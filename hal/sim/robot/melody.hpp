// Notes that sound one after the other: a song, or a tune of the robot itself.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/commands.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class Melody {
 public:
  // At most sixteen notes, from now on. They are copied: their source may change.
  void start(std::span<const oi::Note> notes, rt::Duration now) {
    length_ = std::min(notes.size(), notes_.size());
    std::copy_n(notes.begin(), length_, notes_.begin());
    playing_ = true;
    started_at_ = now;
    ends_at_ = now;
    for (std::size_t i = 0; i < length_; ++i) ends_at_ += duration(notes_[i]);
  }
  void stop() { playing_ = false; }
  // Ends it when it is over.
  void advance(rt::Duration now) {
    if (now >= ends_at_) playing_ = false;
  }

  bool playing() const { return playing_; }
  // The MIDI number of the note that sounds; 0: silence.
  std::uint8_t sounding(rt::Duration now) const {
    if (!playing_) return 0;
    rt::Duration note_ends = started_at_;
    for (std::size_t i = 0; i < length_; ++i) {
      note_ends += duration(notes_[i]);
      if (now >= note_ends) continue;
      const std::uint8_t number = notes_[i].number;
      return number >= kLowest && number <= kHighest ? number : std::uint8_t{0};
    }
    return 0;
  }

 private:
  // Lower numbers are rests (OI p. 11).
  static constexpr std::uint8_t kLowest = 31;
  static constexpr std::uint8_t kHighest = 127;

  static rt::Duration duration(const oi::Note& note) {
    return rt::Duration{std::int64_t{note.duration.value} * 1'000'000'000 / 64};
  }

  std::array<oi::Note, oi::kMaxSongNotes> notes_{};
  std::size_t length_ = 0;
  bool playing_ = false;
  rt::Duration started_at_{0};
  rt::Duration ends_at_{0};
};

}  // namespace cargobay::hal::sim
