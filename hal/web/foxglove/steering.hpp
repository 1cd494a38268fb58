// Steers by the velocities that a Foxglove client publishes: takes the lease for the first one. Who
// was refused, or has lost the lease to a stop or to somebody else, has to let go first: a client
// that goes on publishing does not undo the stop.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hal/feed/message/reading.hpp"
#include "hal/web/foxglove/client_message.hpp"
#include "rt/clock.hpp"

namespace cargobay::web {

// One thread.
class Steering {
 public:
  // What its requests are for. Each gets a number, by which its answer is known.
  using Done = std::function<void(const hal::heard::Answer&)>;

  // `request` sends a line to the feed, `now` is the time.
  Steering(std::function<void(std::string)> request, std::function<rt::TimePoint()> now)
      : request_{std::move(request)}, now_{std::move(now)} {}

  // Publishing has paused for so long: it was let go.
  static constexpr rt::Duration kLetGo = std::chrono::seconds{2};

  // Under which name the lease is taken, and whether from somebody else too. Then the next velocity
  // is tried, also without letting go.
  void set_name(std::string name) {
    name_ = std::move(name);
    must_let_go_ = false;
  }
  void set_take(bool take) {
    takes_ = take;
    must_let_go_ = false;
  }
  const std::string& name() const { return name_; }
  bool takes() const { return takes_; }

  // `refused` is called with the reason if it is not carried out, once until it is let go. False if
  // too many requests have no answer yet: the feed does not read.
  bool drive(const Velocity& velocity, std::function<void(const std::string&)> refused);
  // A request of that kind; `done` is called with its answer.
  bool ask(std::string_view what, Done done);
  void release();

  void answered(const hal::heard::Answer& answer);
  // Who steers has changed.
  void held_by(const hal::heard::Holder& holder);

 private:
  static constexpr std::size_t kMostUnanswered = 32;

  bool send(std::string members, Done done);
  void send_velocity();
  void refuse(const std::string& why);

  std::function<void(std::string)> request_;
  std::function<rt::TimePoint()> now_;
  std::string name_ = "Foxglove";
  bool takes_ = false;
  bool holds_ = false;
  std::uint64_t lease_ = 0;  // the number of ours
  bool asks_for_lease_ = false;
  bool must_let_go_ = false;
  std::optional<rt::TimePoint> heard_{};  // when the newest velocity came
  std::optional<Velocity> wanted_{};      // until the lease is there
  std::function<void(const std::string&)> refused_{};
  std::map<std::uint64_t, Done> unanswered_{};
  std::uint64_t next_id_ = 1;
};

}  // namespace cargobay::web
