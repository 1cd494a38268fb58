// While a robot is driven: finds out who else has its port open as soon as frames go missing, since
// whoever reads there takes bytes of them.
#pragma once

#include <pthread.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "hal/sensing/events.hpp"

namespace cargobay::hal {

class PortWatch {
 public:
  // What the loop has got so far. Called on the watch's thread, five times a second.
  struct Progress {
    std::uint64_t missed = 0;  // frames, damaged or never come
    std::int64_t tick = 0;
  };
  using LookUp = std::function<Progress()>;

  PortWatch() = default;
  // Stops.
  ~PortWatch() { stop(); }
  PortWatch(const PortWatch&) = delete;
  PortWatch& operator=(const PortWatch&) = delete;

  // Starts an ordinary thread, which takes no signals. When `look_up`, which outlives it, tells of
  // more missed frames it looks at every process's files, at most once in kPause. Once; allocates.
  // Returns an error where there is no thread: then nobody looks.
  [[nodiscard]] std::error_code start(std::string port, LookUp look_up);
  // Waits for the thread, and for its look: some ms, or some hundred. Idempotent.
  void stop();

  // Takes an EventKind::port_shared of a process that was not told of before; false where there is
  // none. From any thread; locks.
  bool next(Event& event);

  static constexpr std::chrono::milliseconds kPeriod{200};
  static constexpr std::chrono::seconds kPause{2};

 private:
  static void* enter(void* watch);
  void run();
  void look(std::int64_t tick);

  std::string port_;
  LookUp look_up_;
  std::vector<pid_t> told_;  // the thread's own
  std::mutex mutex_;
  std::condition_variable ending_changed_;
  bool ending_ = false;
  std::deque<Event> events_;
  std::optional<pthread_t> thread_;
};

}  // namespace cargobay::hal
