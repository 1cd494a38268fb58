// The file that a recording goes to while the robot drives.
#pragma once

#include <string>
#include <utility>

#include "hal/file/output_file.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_header.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

// All these functions block for the disk; for a pipe whose reader does not keep up, 1 s.
class RecordingFile {
 public:
  // Begins the file with the header.
  static Result<RecordingFile> begin(OutputFile file, const RecordingHeader& header);

  // Gives the file its name, once there is a drive to record: until then, what was there before is
  // kept. From here on, appended data can be read, whatever becomes of this program.
  void publish();
  // Appends what the recorder has got since the last call and hands it to the kernel. Call at least
  // once a minute, or blocks go missing; ten times a second is cheap, and a crash then costs no
  // more than that.
  void append(const FlightRecorder& recorder);
  // What went wrong with the file since its creation: nothing is written after it.
  const Result<void>& written() const { return written_; }
  const std::string& path() const { return file_.path(); }

 private:
  explicit RecordingFile(OutputFile file) : file_{std::move(file)} {}

  OutputFile file_;
  FlightRecorder::Cursor cursor_{};
  Result<void> written_{};
};

}  // namespace cargobay::hal
