// Any input as a ring tone: the notes of an accepted one can be sent, an error has a position.
#include "oi/text/rtttl.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "oi/encode.hpp"
#include "oi/text/song.hpp"

namespace {

using namespace cargobay::oi;  // NOLINT(google-build-using-namespace): a file about nothing else

void require(bool holds) {
  if (!holds) std::abort();
}

void check_notes(const Tune& notes) {
  require(!notes.empty());
  for (const Note& note : notes) {
    require(note.number == kRest || !is_rest(note.number));
    require(note.duration.value >= 1 && note.duration.value <= kMaxNoteDuration);
    require(find_note(note_name(note.number).view()) == note.number);
  }
  const auto songs = split(notes);
  require(songs.has_value());
  SixtyFourths sum{};
  for (const Song& song : *songs) {
    require(encode(song).has_value());
    sum = SixtyFourths{sum.value + duration(song.notes).value};
  }
  require(sum == duration(notes));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as characters
  const std::string_view text{reinterpret_cast<const char*>(data), size};
  (void)find_note(text);  // must end and stay in the text, whatever it finds
  RingTone tone;
  if (const auto error = read_rtttl(text, tone)) {
    require(tone.notes.empty());
    require(error->column >= 1 && error->column <= size + 1);
    require(!message(error->what).empty());
  } else {
    check_notes(tone.notes);
  }
  return 0;
}
