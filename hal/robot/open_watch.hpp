// Says when a file is opened, by any process. One thread waits; another may end its wait.
#pragma once

#include <string>

#include "rt/clock.hpp"

namespace cargobay::hal {

// By inotify. The program may close the descriptor, and open a file of its own under its number:
// then nothing is seen any more, and that file is left alone.
class OpenWatch {
 public:
  OpenWatch() = default;
  ~OpenWatch();
  OpenWatch(const OpenWatch&) = delete;
  OpenWatch& operator=(const OpenWatch&) = delete;

  // False if the kernel refuses: some allow 128 watchers a user. Call once.
  [[nodiscard]] bool begin(const std::string& path);
  enum class Woken { opened, timed_out, ended, blind };  // blind: at once, from now on
  // Blocks until the file was opened since the last call, or until `limit`.
  Woken wait(rt::TimePoint limit);
  // The present wait and each later one end. From any thread; returns at once.
  void end() const;

 private:
  bool is_ours() const;

  int descriptor_ = -1;
  int watch_ = -1;
};

}  // namespace cargobay::hal
