// Reads a recording for the commands that use one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/recording/recording.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

struct LoadedRecording {
  std::vector<std::uint8_t> file{};  // the bytes that `recording` refers to
  hal::Recording recording;
};

// `-` is standard input. Prints a remark about anything missing in the file that is not fatal.
hal::Result<LoadedRecording> load_recording(const std::string& path);

}  // namespace cargobay::cli
