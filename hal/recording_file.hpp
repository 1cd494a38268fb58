// The file that a recording goes to while the robot drives.
#pragma once

#include <fstream>
#include <optional>
#include <string>

#include "hal/flight_recorder.hpp"
#include "hal/recording_header.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

class RecordingFile {
 public:
  // Begins the file with the header, in the place of what it held. Blocks for as long as the disk
  // does, as all of these functions.
  static Result<RecordingFile> create(const std::string& path, const RecordingHeader& header);

  // Appends what the recorder has got since the last time and hands it to the kernel. At least
  // once a minute, or blocks go missing; ten times a second is cheap, and what a crash costs is
  // then no more than that.
  void append(const FlightRecorder& recorder);
  // What went wrong with the file since its creation: nothing is written behind it.
  const std::optional<Failure>& failure() const { return failure_; }

 private:
  RecordingFile(const std::string& path, std::ofstream file)
      : path_{path}, file_{std::move(file)} {}

  std::string path_;
  std::ofstream file_;
  FlightRecorder::Cursor cursor_{};
  std::optional<Failure> failure_{};
};

}  // namespace cargobay::hal
