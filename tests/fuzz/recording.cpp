// Any bytes as a recording, both unchanged and with corrected checksums; whatever can be read is
// replayed.
#include "hal/recording/recording.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "hal/recording/estimate_again.hpp"
#include "hal/recording/exchange.hpp"
#include "hal/recording/replay.hpp"

namespace {

using namespace cargobay::hal;  // NOLINT(google-build-using-namespace): the subject of this program
using Bytes = std::vector<std::uint8_t>;

void require(bool condition) {
  if (!condition) std::abort();
}

void use(const Bytes& file) {
  const auto recording = Recording::read(file);
  if (!recording) {
    require(!recording.failure().message.empty());
    return;
  }
  require(recording->unbroken() <= recording->blocks().size());
  require(recording->cut_off_bytes() < file.size());
  require(encode(recording->header()).size() < file.size() + 1);
  require(exchanges(recording->blocks()).size() <= file.size());
  (void)estimate_again(*recording, recording->header().parameters.loop.estimator);
  const auto result = replay(*recording);
  require(static_cast<bool>(result) == (recording->unbroken() > 0));
  // A replay gives the same result each time, whatever is in the recording.
  if (result) {
    const auto again = replay(*recording);
    require(again->frames == result->frames && again->commands == result->commands);
    require(again->difference.has_value() == result->difference.has_value());
  }
}

// A recording of these entries, in blocks as a recorder would make them.
Bytes sealed(std::span<const std::uint8_t> entries) {
  Bytes file = encode(RecordingHeader{.baud = 57600});
  FlightRecorder::Block block;
  for (std::uint32_t number = 0; !entries.empty(); ++number) {
    const auto some = entries.first(std::min(entries.size(), kMostBlockBytes));
    entries = entries.subspan(some.size());
    block.number = number;
    block.entries.assign(some.begin(), some.end());
    const Bytes more = encode(block);
    file.insert(file.end(), more.begin(), more.end());
  }
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span<const std::uint8_t> input{data, size};
  use(Bytes{input.begin(), input.end()});
  use(sealed(input));
  return 0;
}
