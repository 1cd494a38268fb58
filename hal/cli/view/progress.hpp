// What the command is waiting for, on standard error, if that takes longer than people like to wait
// without a word.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace cargobay::cli {

// Shows a line with the time so far after half a second, as show_line() does; a terminal that
// cannot move its cursor gets each text once, as a remark, after a second. Without a terminal:
// nothing. Starts a thread, which its end joins; if there can be none, nothing is shown.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();  // the line is gone
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  // Any thread.
  void say(std::string what);

 private:
  void run();

  std::mutex mutex_{};
  std::condition_variable news_{};
  std::string what_;
  bool over_ = false;
  std::thread thread_{};
};

}  // namespace cargobay::cli
