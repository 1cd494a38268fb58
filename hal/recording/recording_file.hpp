// The file that a recording goes to while the robot drives.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "hal/file/output_file.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_header.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

// All of these functions block as the disk does; for a pipe whose reader does not keep up, 1 s.
class RecordingFile {
 public:
  // Begins the file with the header.
  static Result<RecordingFile> begin(OutputFile file, const RecordingHeader& header);

  // Gives the file its name, once there is a drive to be recorded: until then what was there
  // before is kept. From here on what was appended can be read, whatever becomes of this program.
  void publish();
  // Appends what the recorder has got since the last time and hands it to the kernel. At least
  // once a minute, or blocks go missing; ten times a second is cheap, and what a crash costs is
  // then no more than that.
  void append(const FlightRecorder& recorder);
  // What went wrong with the file since its creation: nothing is written behind it.
  const std::optional<Failure>& failure() const { return failure_; }
  const std::string& path() const { return file_.path(); }

 private:
  explicit RecordingFile(OutputFile file) : file_{std::move(file)} {}

  OutputFile file_;
  FlightRecorder::Cursor cursor_{};
  std::optional<Failure> failure_{};
};

}  // namespace cargobay::hal
