// Steers by the velocities that a Foxglove client publishes: takes the lease for the first one, and
// again when it was lost.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "hal/web/feed_message.hpp"
#include "hal/web/foxglove/client_message.hpp"

namespace cargobay::web {

// One thread.
class Steering {
 public:
  // What its requests are for. Each gets a number, by which its answer is known.
  using Done = std::function<void(const FeedAnswer&)>;

  // `request` sends a line to the feed.
  explicit Steering(std::function<void(std::string)> request) : request_{std::move(request)} {}

  // Under which name the lease is taken, and whether from somebody else too.
  void set_name(std::string name) { name_ = std::move(name); }
  void set_take(bool take) { takes_ = take; }
  const std::string& name() const { return name_; }
  bool takes() const { return takes_; }

  // `refused` is called with the reason if it is not carried out. False if too many requests have
  // no answer yet: the feed does not read.
  bool drive(const Velocity& velocity, std::function<void(const std::string&)> refused);
  // A request of that kind; `done` is called with its answer.
  bool ask(std::string_view what, Done done);
  void release();

  void answered(const FeedAnswer& answer);
  // Who steers has changed.
  void held_by(const std::optional<std::string>& name);

 private:
  static constexpr std::size_t kMostUnanswered = 32;

  bool send(std::string members, Done done);
  void send_velocity();

  std::function<void(std::string)> request_;
  std::string name_ = "Foxglove";
  bool takes_ = false;
  bool holds_ = false;
  bool asks_for_lease_ = false;
  std::optional<Velocity> wanted_{};  // until the lease is there
  std::function<void(const std::string&)> refused_{};
  std::map<std::uint64_t, Done> unanswered_{};
  std::uint64_t next_id_ = 1;
};

}  // namespace cargobay::web
