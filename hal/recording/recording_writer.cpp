#include "hal/recording/recording_writer.hpp"

#include <chrono>
#include <utility>

#include "hal/machine/masked_thread.hpp"

namespace cargobay::hal {

Result<std::unique_ptr<RecordingWriter>> RecordingWriter::create(OutputFile output,
                                                                 const RecordingHeader& header,
                                                                 const FlightRecorder& recorder) {
  auto file = RecordingFile::begin(std::move(output), header);
  if (!file) return file.failure();
  return std::unique_ptr<RecordingWriter>{new RecordingWriter{std::move(*file), recorder}};
}

std::error_code RecordingWriter::start() {
  return start_masked(thread_, [this] { run(); });
}

void RecordingWriter::run() {
  constexpr std::chrono::milliseconds kPause{100};
  std::unique_lock lock{mutex_};
  while (!ending_.wait_for(lock, kPause, [this] { return ends_; })) append();
}

const Result<void>& RecordingWriter::finish() {
  if (thread_.joinable()) {
    {
      const std::lock_guard lock{mutex_};
      ends_ = true;
    }
    ending_.notify_one();
    thread_.join();
  }
  append();
  return file_.written();
}

}  // namespace cargobay::hal
