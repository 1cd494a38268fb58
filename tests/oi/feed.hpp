// Bytes in, frames out: what every test of the stream decoder does.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

#include "oi/stream_decoder.hpp"

namespace cargobay::oi {

using Bytes = std::vector<std::uint8_t>;

inline Bytes text(std::string_view characters) { return {characters.begin(), characters.end()}; }

inline Bytes operator+(Bytes left, const Bytes& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

// The frames among them.
inline std::vector<Bytes> feed(StreamDecoder& decoder, const Bytes& bytes) {
  std::vector<Bytes> frames;
  decoder.push(bytes, [&](StreamDecoder::Outcome outcome) {
    if (outcome == StreamDecoder::Outcome::frame)
      frames.emplace_back(decoder.frame().begin(), decoder.frame().end());
  });
  return frames;
}

// A frame around ids and data, with either checksum.
inline Bytes frame_around(const Bytes& items, Checksum form = Checksum::including_header) {
  Bytes frame{kFrameHeader, static_cast<std::uint8_t>(items.size())};
  frame = frame + items;
  frame.push_back(checksum_of(frame, form));
  return frame;
}

}  // namespace cargobay::oi
