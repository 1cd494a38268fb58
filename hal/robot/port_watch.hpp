// While a robot is driven: finds out which other processes have its port open as soon as frames go
// missing, since any reader there takes bytes from them.
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
  // What the loop has received so far. Called on the watch's thread, five times a second.
  struct Progress {
    std::uint64_t missed = 0;  // frames that were damaged or never came
    std::int64_t tick = 0;
  };
  using LookUp = std::function<Progress()>;
  using Tell = std::function<void(const Event&)>;

  PortWatch() = default;
  // Stops.
  ~PortWatch() { stop(); }
  PortWatch(const PortWatch&) = delete;
  PortWatch& operator=(const PortWatch&) = delete;

  // Starts an ordinary thread, which takes no signals. When `look_up`, which must outlive it,
  // reports more missed frames, it looks at every process's files, at most once per kPause. Call
  // once; allocates. Returns an error if no thread could be started: then nothing looks.
  // `tell`, if there is one, is called on the watch's thread with each event.
  [[nodiscard]] std::error_code start(std::string port, LookUp look_up, Tell tell = {});
  // Waits for the thread, and for a look in progress: some ms, or a few hundred. Idempotent.
  void stop();

  // Takes an EventKind::port_shared about a process not reported before; false if there is none.
  // From any thread; locks.
  bool next(Event& event);

  static constexpr std::chrono::milliseconds kPeriod{200};
  static constexpr std::chrono::seconds kPause{2};

 private:
  static void* enter(void* watch);
  void run();
  void look(std::int64_t tick);

  std::string port_;
  LookUp look_up_;
  Tell tell_;
  std::vector<pid_t> told_;  // used by the thread only
  std::mutex mutex_;
  std::condition_variable ending_changed_;
  bool ending_ = false;
  std::deque<Event> events_;
  std::optional<pthread_t> thread_;
};

}  // namespace cargobay::hal
