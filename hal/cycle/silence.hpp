// What is due when a robot says nothing: a deadline for each tick, a stop of the wheels, the end.
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

// announce() from any thread, everything else on the control thread. No allocation.
class Silence {
 public:
  struct Limits {
    rt::Duration tick;
    rt::Duration stop_after;
    rt::Duration link_timeout;
  };
  enum class Due : std::uint8_t {
    nothing,
    stop,      // stop the wheels: now, once per silence
    link_lost  // the robot is not coming back
  };

  explicit Silence(const Limits& limits) : limits_{limits} {}

  // For `duration` from the next pass on, silence does not mean a lost link. The wheels get their
  // stop.
  void announce(rt::Duration duration) CARGOBAY_NONBLOCKING {
    // Relaxed: the word is all there is to know, and only the control thread looks at a clock.
    announced_.store(duration, std::memory_order_relaxed);
  }
  // Call in each pass.
  void take_up_announced(rt::TimePoint now) CARGOBAY_NONBLOCKING {
    if (announced_.load(std::memory_order_relaxed) == kNoneAnnounced) return;
    expected_until_ = now + announced_.exchange(kNoneAnnounced, std::memory_order_relaxed);
  }

  // Starts waiting; nothing has been heard yet.
  void begin(rt::TimePoint now) CARGOBAY_NONBLOCKING { deadline_ = now + limits_.stop_after; }
  rt::TimePoint deadline() const CARGOBAY_NONBLOCKING { return deadline_; }

  // A frame has arrived, and the next is due by `deadline`. Returns whether the wheels were stopped
  // meanwhile.
  bool end(rt::TimePoint deadline) CARGOBAY_NONBLOCKING {
    const bool stopped = stopped_;
    deadline_ = deadline;
    stopped_ = false;
    stop_owed_ = false;
    return stopped;
  }
  // The deadline has passed; the next is a tick later.
  Due deadline_passed(rt::TimePoint now, rt::TimePoint last_arrival) CARGOBAY_NONBLOCKING {
    deadline_ += limits_.tick;
    const rt::Duration silence = now - last_arrival;
    if (silence >= limits_.link_timeout && now >= expected_until_) return Due::link_lost;
    if (silence < limits_.stop_after || stopped_) return Due::nothing;
    stopped_ = true;
    return Due::stop;
  }

  // A stop that the port has not taken whole.
  bool owes_stop() const CARGOBAY_NONBLOCKING { return stop_owed_; }
  void owe_stop(bool owed) CARGOBAY_NONBLOCKING { stop_owed_ = owed; }

 private:
  static constexpr rt::Duration kNoneAnnounced = rt::Duration::min();

  Limits limits_;
  rt::TimePoint deadline_{};
  rt::TimePoint expected_until_{};  // the end of an announced silence
  bool stopped_ = false;
  bool stop_owed_ = false;
  std::atomic<rt::Duration> announced_{kNoneAnnounced};
};

}  // namespace cargobay::hal
