#include "hal/cli/terminal/load_recording.hpp"

#include <utility>

#include <fmt/core.h>

#include "hal/cli/terminal/operands.hpp"
#include "hal/cli/terminal/print.hpp"
#include "hal/recording/recording_format.hpp"

namespace cargobay::cli {
namespace {

void remark_on(const hal::Recording& recording, const std::string& path) {
  if (recording.cut_off_bytes() > 0) {
    print_remark(fmt::format(
        "{} was not finished: read up to its last whole block, without the {} bytes after it", path,
        recording.cut_off_bytes()));
  }
  if (recording.missing_blocks() > 0) {
    print_remark(
        fmt::format("{} has gaps: {} of its blocks were overwritten before they could be "
                    "written to the disk",
                    path, recording.missing_blocks()));
  }
}

}  // namespace

hal::Result<LoadedRecording> load_recording(const std::string& path) {
  const auto text =
      read_all(path, {.most_bytes = hal::kMostRecordingBytes,
                      .begins_with = {hal::kRecordingMagic.begin(), hal::kRecordingMagic.end()}});
  if (!text) return text.failure();
  std::vector<std::uint8_t> file{text->begin(), text->end()};
  auto recording = hal::Recording::read(file);
  if (!recording) return hal::Failure{path + " " + recording.failure().message};
  remark_on(*recording, path);
  return LoadedRecording{std::move(file), std::move(*recording)};
}

}  // namespace cargobay::cli
