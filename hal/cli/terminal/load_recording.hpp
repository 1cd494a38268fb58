// Reads the file of a recording for the commands that use one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/recording/recording.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

struct LoadedRecording {
  std::vector<std::uint8_t> file{};  // what `recording` points into
  hal::Recording recording;
};

// `-` is standard input. What is missing in the file, but stops nothing, is remarked on.
hal::Result<LoadedRecording> load_recording(const std::string& path);

}  // namespace cargobay::cli
