// Any bytes through the stream decoder. The first byte chooses form and packets, the rest is the
// line.
#include "oi/stream_decoder.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "oi/dialect.hpp"
#include "oi/frame.hpp"
#include "oi/sensors.hpp"

namespace {

using namespace cargobay::oi;  // NOLINT(google-build-using-namespace): the subject of this program
using Outcome = StreamDecoder::Outcome;

void require(bool condition) {
  if (!condition) std::abort();
}

struct Span {
  std::size_t begin = 0;
  std::size_t end = 0;
  friend bool operator==(const Span&, const Span&) = default;
};

class Line {
 public:
  Line(std::span<const std::uint8_t> bytes, Checksum form, const Dialect& dialect)
      : bytes_{bytes}, form_{form}, dialect_{dialect}, decoder_{form, dialect} {}

  void run() {
    for (std::size_t i = 0; i < bytes_.size(); ++i) {
      take(decoder_.push(bytes_[i]));
      if (form_ != Checksum::automatic) second_frame_is_in_time(i + 1);
    }
    for (Outcome outcome{}; (outcome = decoder_.abandon()) != Outcome::nothing;) take_one(outcome);
    const StreamDecoder::Counters& counters = decoder_.counters();
    require(counters.bytes == bytes_.size());
    require(counters.bytes == counters.framed + counters.skipped);
    require(counters.text <= counters.skipped);
    require(counters.frames == published_.size());
    require(counters.resyncs <= counters.frames);
  }

 private:
  void take(Outcome outcome) {
    for (; outcome != Outcome::nothing; outcome = decoder_.next()) take_one(outcome);
  }

  // A published frame is in the line at the place the counters give, and is a frame.
  void take_one(Outcome outcome) {
    if (outcome != Outcome::frame) return;
    const std::span<const std::uint8_t> frame = decoder_.frame();
    const std::size_t end = decoder_.counters().framed + decoder_.counters().skipped;
    require(frame.size() >= kMinFrameBytes && frame.size() <= kMaxFrameBytes &&
            end <= bytes_.size());
    require(std::ranges::equal(frame, bytes_.subspan(end - frame.size(), frame.size())));
    require(is_well_formed(frame, dialect_.item_sizes));
    require(checksum_matches(frame, form_));
    require(published_.empty() || published_.back().end <= end - frame.size());
    SensorValues values;
    require(decode_frame(frame, values, dialect_));
    published_.push_back({end - frame.size(), end});
  }

  bool is_frame(std::size_t begin, std::size_t end) const {
    const auto bytes = bytes_.subspan(begin, end - begin);
    return is_well_formed(bytes, dialect_.item_sizes) && checksum_matches(bytes, form_);
  }
  // The beginnings of frames that end there.
  std::vector<std::size_t> frames_that_end(std::size_t end) const {
    std::vector<std::size_t> begins;
    for (std::size_t begin = end > kMaxFrameBytes ? end - kMaxFrameBytes : 0; begin < end;
         ++begin) {
      if (is_frame(begin, end)) begins.push_back(begin);
    }
    return begins;
  }

  // The decoder's promise: of two whole frames in a row, the second is published with its last
  // byte, unless another frame that was believed contains some of their bytes.
  void second_frame_is_in_time(std::size_t end) const {
    for (const std::size_t second : frames_that_end(end)) {
      for (const std::size_t first : frames_that_end(second)) {
        require(std::ranges::any_of(published_, [&](const Span& one) {
          if (one == Span{first, second}) return false;
          return one == Span{second, end} || (one.end > first && one.begin < end);
        }));
      }
    }
  }

  std::span<const std::uint8_t> bytes_;
  Checksum form_;
  const Dialect& dialect_;
  StreamDecoder decoder_;
  std::vector<Span> published_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto form = static_cast<Checksum>(data[0] % 3);
  const Dialect& dialect = (data[0] & 4U) == 0 ? kCreate : kCreateWithExtensions;
  Line{{data + 1, size - 1}, form, dialect}.run();
  return 0;
}
