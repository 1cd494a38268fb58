// While a robot is driven: finds out which other processes have its port open as soon as frames go
// missing, since any reader there takes bytes from them. One that opens it for a moment is looked
// for at that moment.
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

#include "hal/port/port_users.hpp"
#include "hal/robot/open_watch.hpp"
#include "hal/sensing/events.hpp"
#include "rt/clock.hpp"

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
  // reports more missed frames, it looks at every process's files, at most once per kPause, and
  // reports who has the port open, or had it open in the last kRecent. Whenever the port is opened
  // it looks who that is, at most ten times a second. Call once; allocates. Returns an error if no
  // thread could be started: then nothing looks.
  // `tell`, if there is one, is called on the watch's thread with each event.
  [[nodiscard]] std::error_code start(std::string port, LookUp look_up, Tell tell = {});
  // Waits for the thread, and for a look in progress: some ms, or a few hundred. Idempotent.
  void stop();

  // Takes an EventKind::port_shared about a process not reported before, nor another of the same
  // name that has ended: what opens the port by turns is a new process each time. Or once about
  // opens that were too brief to be seen, with process 0: of serial ports only, since whoever has
  // the other side of a pseudo-terminal opens it too. False if there is none.
  // From any thread; locks.
  bool next(Event& event);

  static constexpr std::chrono::milliseconds kPeriod{200};
  static constexpr std::chrono::seconds kPause{2};
  static constexpr std::chrono::seconds kRecent{10};

 private:
  static void* enter(void* watch);
  void run();
  // Waits until the port was opened, or `limit`. False if it is to end.
  bool wait(rt::TimePoint limit);
  void look();
  void report(std::int64_t tick);
  void put(std::int64_t tick, const PortUser& user);

  struct Seen {
    PortUser user{};
    rt::TimePoint last{};
    bool present = true;  // at the last look
    bool told = false;
  };
  // Another one by this name was reported, and has ended.
  bool was_told_of(const std::string& name) const;

  std::string port_;
  LookUp look_up_;
  Tell tell_;
  OpenWatch opens_;
  // Used by the thread only.
  bool blind_ = false;  // opens_ sees nothing
  std::vector<Seen> seen_;
  rt::TimePoint next_look_ = rt::TimePoint::min();
  bool was_opened_ = false;                         // since the last look
  rt::TimePoint unseen_at_ = rt::TimePoint::min();  // when a look after an open found nobody
  bool unseen_told_ = false;

  std::mutex mutex_;
  std::condition_variable ending_changed_;
  bool ending_ = false;
  std::deque<Event> events_;
  std::optional<pthread_t> thread_;
};

}  // namespace cargobay::hal
