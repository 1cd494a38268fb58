#include "hal/recording_file.hpp"

#include <cerrno>
#include <span>
#include <utility>

#include "hal/recording.hpp"

namespace cargobay::hal {
namespace {

void write(std::ofstream& file, std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) file.put(static_cast<char>(byte));
}

Failure cannot_write(const std::string& path, int error) {
  const std::error_code code{error, std::generic_category()};
  return {"cannot write the recording " + path + ": " + code.message(), code};
}

}  // namespace

Result<RecordingFile> RecordingFile::create(const std::string& path,
                                            const RecordingHeader& header) {
  errno = 0;
  std::ofstream file{path, std::ios::binary | std::ios::trunc};
  write(file, encode(header));
  file.flush();
  if (!file) return cannot_write(path, errno);
  return RecordingFile{path, std::move(file)};
}

void RecordingFile::append(const FlightRecorder& recorder) {
  if (failure_.has_value()) return;
  errno = 0;
  FlightRecorder::Block block;
  while (recorder.next(cursor_, block)) write(file_, encode(block));
  file_.flush();
  if (!file_) failure_ = cannot_write(path_, errno);
}

}  // namespace cargobay::hal
