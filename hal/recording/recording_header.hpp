// The front of a recording: all that a control cycle is set up with, and where the recording comes
// from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/cycle/cycle_parameters.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

struct RecordingHeader {
  std::uint32_t baud = 0;
  std::int64_t started_ns = 0;  // since 1970 UTC
  std::string software{};       // that recorded it, with its version; up to 1000 bytes, like `note`
  std::string note{};           // what was driven, for people
  CycleParameters parameters{};
};

// As in hal/recording/recording_format.hpp. Longer texts are cut; control characters become
// question marks.
std::vector<std::uint8_t> encode(const RecordingHeader& header);

struct DecodedHeader {
  RecordingHeader header{};
  std::size_t bytes = 0;  // of the file, up to the first block
};
// Fails if it is not a recording, is of another version, or is damaged or cut off.
Result<DecodedHeader> decode_header(std::span<const std::uint8_t> file);

}  // namespace cargobay::hal
