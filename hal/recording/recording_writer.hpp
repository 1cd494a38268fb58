// Writes a recording while its robot drives: from its own thread, or, in virtual time, with which
// no thread would keep up, whenever append() is called.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <system_error>
#include <thread>

#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_file.hpp"
#include "hal/recording/recording_header.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

class RecordingWriter {
 public:
  // Begins the file. `recorder` must outlive the writer. Blocks as RecordingFile does.
  static Result<std::unique_ptr<RecordingWriter>> create(OutputFile output,
                                                         const RecordingHeader& header,
                                                         const FlightRecorder& recorder);
  // Finishes.
  ~RecordingWriter() { (void)finish(); }
  RecordingWriter(const RecordingWriter&) = delete;
  RecordingWriter& operator=(const RecordingWriter&) = delete;

  // As RecordingFile::publish(); call before start().
  void publish() { file_.publish(); }
  // From now on a thread appends ten times a second.
  [[nodiscard]] std::error_code start();
  // Without the thread: call at least once for each minute of the robot's time.
  void append() { file_.append(recorder_); }
  // Ends the thread and appends the rest. Fails with what went wrong with the file first.
  const Result<void>& finish();

 private:
  RecordingWriter(RecordingFile file, const FlightRecorder& recorder)
      : file_{std::move(file)}, recorder_{recorder} {}
  void run();

  RecordingFile file_;
  const FlightRecorder& recorder_;
  std::mutex mutex_;
  std::condition_variable ending_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace cargobay::hal
