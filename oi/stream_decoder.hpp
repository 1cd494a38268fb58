// Bytes to stream frames, one byte at a time, on a line that loses, damages and invents bytes.
//
// A frame is accepted when its ids and lengths fill it exactly and its checksum is right. Bytes
// that are neither a frame nor part of an open candidate are skipped and counted; a bad byte is not
// an error. After any damage the second undamaged frame, at the latest, is delivered with its last
// byte:
// - a candidate that turns out wrong is read again from the byte after its header, so that a frame
//   inside it is not lost;
// - a candidate that is still open, say because its length byte was damaged, is dropped as soon as
//   two whole frames, one after the other, have gone by inside it.
// The checksum lets some damage through: of damaged bytes that have the structure of a frame, 1 in
// 256 is accepted, 2 in 256 while the form of the checksum is not known yet.
//
// Memory: about 1 KiB, in place. Time: a few instructions for most bytes. Rejected candidates are
// read again: at worst 258 bytes from each of the 85 false headers in them, some 30 us for one byte
// on a line made for that (tests/bench/oi_bench.cpp). No clock: a caller that finds the line quiet
// says so with abandon().
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "oi/checksum.hpp"
#include "oi/dialect.hpp"
#include "oi/frame.hpp"
#include "oi/limits.hpp"
#include "oi/text_tail.hpp"

namespace cargobay::oi {

class StreamDecoder {
 public:
  enum class Outcome : std::uint8_t {
    nothing,  // more bytes are needed
    frame,    // frame() is one
    corrupt,  // what looked like the beginning of a frame was not one
  };

  // bytes == framed + skipped + what an open candidate holds.
  struct Counters {
    std::uint64_t bytes = 0;          // pushed
    std::uint64_t frames = 0;         // delivered
    std::uint64_t framed = 0;         // bytes in them
    std::uint64_t skipped = 0;        // bytes in no frame, text included
    std::uint64_t text = 0;           // skipped bytes that are printable, CR or LF
    std::uint64_t bad_checksum = 0;   // candidates that are whole except for their checksum
    std::uint64_t bad_structure = 0;  // candidates that no list of packets produces
    std::uint64_t overtaken = 0;      // open candidates inside which two frames went by
    std::uint64_t abandoned = 0;      // open candidates when abandon() was called
    std::uint64_t resyncs = 0;        // delivered frames that did not directly follow another
    std::uint64_t locks = 0;          // times the form of the checksum was settled
  };

  // Automatic settles on a form, or on the other form later, after this many frames in a row have
  // it.
  static constexpr unsigned kFramesToLock = 4;

  constexpr explicit StreamDecoder(Checksum form = Checksum::automatic,
                                   const Dialect& dialect = kCreate)
      : sizes_{&dialect.item_sizes}, configured_{form}, form_{form} {}

  // Takes one byte. After `frame` or `corrupt` call next() until it says `nothing`: the bytes
  // already held may be more frames. If you do not, you get them with later bytes.
  constexpr Outcome push(std::uint8_t byte) noexcept {
    ++counters_.bytes;
    return only_stores(byte) ? Outcome::nothing : push_with_care(byte);
  }
  constexpr Outcome next() noexcept { return in_lane_ ? Outcome::nothing : advance(); }
  // The same for many bytes: calls `see(outcome)` for each `frame` and each `corrupt` among them.
  template <typename See>
  constexpr void push(std::span<const std::uint8_t> bytes, See see) {
    for (const std::uint8_t byte : bytes) {
      ++counters_.bytes;
      if (only_stores(byte)) continue;
      for (Outcome outcome = push_with_care(byte); outcome != Outcome::nothing; outcome = next()) {
        see(outcome);
      }
    }
  }

  // The line has been quiet too long for the rest of an open candidate to come: gives it up and
  // reads what is held again. Call until it says `nothing`; then nothing is held.
  constexpr Outcome abandon() noexcept {
    if (in_lane_) leave_lane();
    const Outcome outcome = advance();
    if (outcome != Outcome::nothing || begin_ == end_) return outcome;
    gate_ = 0;  // what is held is read again
    return reject(counters_.abandoned);
  }

  // Header to checksum of the frame of the last push() or next(); valid until the next of either.
  constexpr std::span<const std::uint8_t> frame() const {
    return std::span{held_}.subspan(frame_begin_, frame_length_);
  }
  constexpr const Counters& counters() const { return counters_; }
  // The form in use; nothing until automatic has settled.
  constexpr std::optional<Checksum> checksum() const {
    if (form_ == Checksum::automatic) return std::nullopt;
    return form_;
  }
  // Copies skipped text there; null to stop. `tail` must outlive the decoder or the next call.
  constexpr void collect_text(TextTail* tail) { text_ = tail; }

  // As new, with zero counters, except for collect_text().
  constexpr void reset() noexcept {
    TextTail* const text = text_;
    const ItemSizes* const sizes = sizes_;
    *this = StreamDecoder{configured_};
    sizes_ = sizes;
    text_ = text;
  }

 private:
  // held_ keeps [begin_, end_). Of these, [begin_, read_) have been read: they are the open
  // candidate. [read_, end_) are waiting to be read, or read again.
  //
  // Most bytes need not be read when they arrive. While nothing is waiting, bytes before the
  // gate_-th are only stored, and added to read_ later; a 19 beyond the spare ones is read at once.
  //
  // The lane goes further: right after a frame, another of a usual length is expected, so its bytes
  // are stored and read as a whole when the last has arrived. If it is not such a frame, its bytes
  // are read one by one, as if they had just arrived. So they are if its data have more than one
  // 19, which could be the two frames inside.

  constexpr bool only_stores(std::uint8_t byte) noexcept {
    if (end_ + 1 >= gate_ || (byte == kFrameHeader && spare_headers_-- <= 0)) return false;
    held_[end_++] = byte;
    return true;
  }

  constexpr Outcome push_with_care(std::uint8_t byte) noexcept {
    if (in_lane_) return push_in_lane(byte);
    catch_up();
    if (end_ == held_.size()) make_room();
    held_[end_++] = byte;
    return advance();
  }

  constexpr Outcome push_in_lane(std::uint8_t byte) noexcept {
    held_[end_++] = byte;
    if (end_ == 2 && held_[0] == kFrameHeader && is_usual(byte + kFrameOverhead)) {
      gate_ = length_ = byte + kFrameOverhead;
      if (byte == kFrameHeader) spare_headers_ = 0;  // a length of 19 may be a header as well
      return Outcome::nothing;
    }
    if (end_ == length_ && is_frame(0, end_, form_)) {
      run_ = 0;
      read_ = end_;
      return deliver();
    }
    leave_lane();
    return advance();
  }

  // Two lengths, because a stream read in windows alternates between two lists.
  constexpr bool is_usual(std::size_t length) const {
    return length == frame_length_ || length == other_length_;
  }
  // Nothing is held and a frame has just been delivered.
  constexpr void enter_lane() {
    in_lane_ = form_ != Checksum::automatic;
    gate_ = in_lane_ ? 2 : 0;
    spare_headers_ = 2;  // its own and one more
  }
  constexpr void leave_lane() {
    in_lane_ = false;
    gate_ = 0;
  }

  constexpr void catch_up() {
    if (gate_ != 0) read_ = end_;
    gate_ = 0;
  }

  constexpr Outcome advance() noexcept {
    catch_up();
    while (read_ < end_) {
      const Outcome outcome = read(held_[read_++]);
      if (outcome != Outcome::nothing) return outcome;
    }
    if (begin_ == end_) {
      begin_ = read_ = end_ = 0;
    } else if (begin_ > 0) {
      make_room();
    }
    if (begin_ < end_ && header_count_ < 2) gate_ = structure_at_;
    spare_headers_ = 0;
    return Outcome::nothing;
  }

  // Moves what is held to the front.
  constexpr void make_room() {
    std::copy(held_.begin() + static_cast<std::ptrdiff_t>(begin_),
              held_.begin() + static_cast<std::ptrdiff_t>(end_), held_.begin());
    read_ -= begin_;
    end_ -= begin_;
    begin_ = 0;
  }

  constexpr Outcome read(std::uint8_t byte) noexcept {
    if (read_ == begin_ + 1) return read_first(byte);
    if (byte == kFrameHeader || header_count_ >= 2) watch_for_frames_inside(byte);
    if (read_ - begin_ == structure_at_) {
      const Outcome outcome = read_structure(byte);
      if (outcome != Outcome::nothing) return outcome;
    }
    if (header_count_ >= 2 && a_frame_may_end_here() && two_frames_end_here()) {
      return reject(counters_.overtaken);
    }
    return Outcome::nothing;
  }

  constexpr Outcome read_first(std::uint8_t byte) noexcept {
    if (byte != kFrameHeader) {
      skip(byte);
      return Outcome::nothing;
    }
    header_count_ = 0;
    structure_at_ = 2;
    return Outcome::nothing;
  }

  // The byte is the length, an id or the checksum: what the structure asks for next.
  constexpr Outcome read_structure(std::uint8_t byte) noexcept {
    if (structure_at_ == 2) {
      length_ = byte + kFrameOverhead;
      if (length_ < kMinFrameBytes) return reject(counters_.bad_structure);
      structure_at_ = 3;
      return Outcome::nothing;
    }
    if (structure_at_ == length_) return read_whole();
    const std::size_t item = (*sizes_)[byte];
    structure_at_ += item;
    if (item == 0 || structure_at_ > length_) return reject(counters_.bad_structure);
    return Outcome::nothing;
  }

  // The candidate is complete; only its checksum is left to check.
  constexpr Outcome read_whole() noexcept {
    const auto candidate = std::span{held_}.subspan(begin_, length_);
    const std::uint8_t sum = byte_sum(candidate);
    if (sum != 0 && sum != kFrameHeader) return reject(counters_.bad_checksum);
    const Checksum form = sum == 0 ? Checksum::including_header : Checksum::excluding_header;
    if (!accepts(form)) return reject(counters_.bad_checksum);
    return deliver();
  }

  constexpr Outcome deliver() noexcept {
    frame_begin_ = begin_;
    if (length_ != frame_length_) other_length_ = frame_length_;
    frame_length_ = length_;
    if (!behind_frame_) ++counters_.resyncs;
    behind_frame_ = true;
    ++counters_.frames;
    counters_.framed += frame_length_;
    begin_ = read_;
    if (begin_ == end_) {
      begin_ = read_ = end_ = 0;
      enter_lane();
    }
    return Outcome::frame;
  }

  // Skips the header of the candidate and has the rest read again.
  constexpr Outcome reject(std::uint64_t& counter) noexcept {
    ++counter;
    skip(kFrameHeader);
    read_ = begin_;
    return Outcome::corrupt;
  }

  constexpr void skip(std::uint8_t byte) noexcept {
    ++begin_;
    ++counters_.skipped;
    behind_frame_ = false;
    if (!is_text(byte)) return;
    ++counters_.text;
    if (text_ != nullptr) text_->push(byte);
  }

  // Notes the 19s in the candidate after its header, and where the frames would end that begin with
  // any but the first of them: looking for two frames at each byte would take long.
  constexpr void watch_for_frames_inside(std::uint8_t byte) {
    const auto offset = static_cast<std::uint16_t>(read_ - 1 - begin_);
    if (header_count_ >= 2 && headers_[header_count_ - 1] + 1U == offset) {
      const std::size_t end = offset - 1U + byte + kFrameOverhead;
      if (end <= kMaxFrameBytes) expected_ends_[end / 64] |= std::uint64_t{1} << (end % 64);
    }
    if (byte != kFrameHeader) return;
    if (header_count_ == 1) expected_ends_ = {};
    headers_[header_count_++] = offset;
  }
  constexpr bool a_frame_may_end_here() const {
    const std::size_t end = read_ - begin_;
    return (expected_ends_[end / 64] >> (end % 64) & 1U) != 0;
  }

  // Whether two whole frames with checksums of one form are one right after the other inside the
  // open candidate, up to the byte just read.
  constexpr bool two_frames_end_here() const {
    for (std::size_t i = 1; i < header_count_; ++i) {
      const std::size_t second = begin_ + headers_[i];
      if (is_frame(second, read_, configured_) && a_frame_ends_at(second)) return true;
    }
    return false;
  }
  constexpr bool a_frame_ends_at(std::size_t second) const {
    for (std::size_t i = 0; begin_ + headers_[i] < second; ++i) {
      const std::size_t first = begin_ + headers_[i];
      if (is_frame(first, second, configured_) && of_one_form(first, second)) return true;
    }
    return false;
  }
  constexpr bool is_frame(std::size_t begin, std::size_t end, Checksum form) const {
    if (begin + 1 >= end || begin + held_[begin + 1] + kFrameOverhead != end) return false;
    const auto bytes = std::span{held_}.subspan(begin, end - begin);
    return is_well_formed(bytes, *sizes_) && checksum_matches(bytes, form);
  }
  constexpr bool of_one_form(std::size_t first, std::size_t second) const {
    return byte_sum(std::span{held_}.subspan(first, second - first)) ==
           byte_sum(std::span{held_}.subspan(second, read_ - second));
  }

  // Whether to accept a complete candidate with a checksum of that form.
  constexpr bool accepts(Checksum form) noexcept {
    if (configured_ != Checksum::automatic) return form == configured_;
    if (form == form_) {
      run_ = 0;
      return true;
    }
    // Not settled, or settled on the other form. Only frames in an unbroken row count towards a
    // form, so that damage, whatever it looks like, does not talk the decoder out of the right one.
    const std::uint64_t begins = counters_.framed + counters_.skipped;
    const bool in_row = run_ > 0 && form == run_form_ && begins == run_end_;
    run_ = in_row ? run_ + 1 : 1;
    run_form_ = form;
    run_end_ = begins + length_;
    if (run_ == kFramesToLock) {
      form_ = form;
      run_ = 0;
      ++counters_.locks;
      return true;
    }
    return form_ == Checksum::automatic;
  }

  std::size_t gate_ = 0;
  std::size_t end_ = 0;
  int spare_headers_ = 0;
  bool in_lane_ = false;
  bool behind_frame_ = false;
  const ItemSizes* sizes_;
  Checksum configured_;
  Checksum form_;
  std::size_t begin_ = 0;
  std::size_t read_ = 0;
  std::size_t structure_at_ = 0;  // offset of the byte that the candidate needs next
  std::size_t length_ = 0;        // and its length, once known
  std::size_t header_count_ = 0;  // 19s in the candidate after its first
  std::size_t frame_begin_ = 0;
  std::size_t frame_length_ = 0;
  std::size_t other_length_ = 0;  // the most recent frame length that differs
  Counters counters_{};
  std::uint64_t run_end_ = 0;  // where in the stream the next frame of the run begins
  unsigned run_ = 0;
  Checksum run_form_ = Checksum::automatic;
  TextTail* text_ = nullptr;
  std::array<std::uint8_t, kMaxFrameBytes> held_{};
  std::array<std::uint16_t, kMaxFrameBytes> headers_{};                 // their offsets from begin_
  std::array<std::uint64_t, kMaxFrameBytes / 64 + 1> expected_ends_{};  // one bit per offset
};

}  // namespace cargobay::oi
