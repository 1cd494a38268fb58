#include "hal/recording/recording_file.hpp"

#include <chrono>
#include <cstdint>
#include <span>

#include "hal/recording/recording.hpp"

namespace cargobay::hal {
namespace {

// The recorder's ring holds more than a minute.
constexpr std::chrono::seconds kPatience{1};

std::string_view text_of(std::span<const std::uint8_t> bytes) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as characters
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

Result<RecordingFile> RecordingFile::begin(OutputFile file, const RecordingHeader& header) {
  if (const auto done = file.write(text_of(encode(header)), kPatience); !done)
    return done.failure();
  return RecordingFile{std::move(file)};
}

void RecordingFile::publish() {
  if (written_) written_ = file_.publish();
}

void RecordingFile::append(const FlightRecorder& recorder) {
  if (!written_) return;
  std::vector<std::uint8_t> bytes;
  FlightRecorder::Block block;
  while (recorder.next(cursor_, block)) {
    const std::vector<std::uint8_t> more = encode(block);
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  written_ = file_.write(text_of(bytes), kPatience);
}

}  // namespace cargobay::hal
