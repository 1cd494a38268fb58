// Answers what the readers of a feed ask: who steers, and what the holder of the lease may do.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "hal/feed/feed_connection.hpp"
#include "hal/feed/feed_request.hpp"
#include "hal/feed/lease.hpp"
#include "hal/feed/message/messages.hpp"
#include "hal/result.hpp"

namespace cargobay::hal {

// What a feed can do with its robot: all of it is called on the feed's thread, which waits for it.
// Without `drive` the feed is not steerable; without `control` there is no virtual Create.
struct FeedSteering {
  std::function<Result<void>(const rt::WheelSpeeds&)> drive{};
  std::function<void()> stop{};
  std::function<Result<void>()> rearm{};
  std::function<Result<void>(const rt::OdometryPose&)> reset_odometry{};
  std::function<Result<void>(std::string_view command)> send{};
  // Whether some reader gets the sensors: then the robot is asked for those too that the loop does
  // not need. Called when that changes, and again as long as it returns false.
  std::function<bool(bool watched)> watch{};
  // As the control socket answers: `ok`, `error: ...` or JSON.
  std::function<std::string(std::string_view line)> control{};
};

class FeedDesk {
 public:
  static constexpr rt::Duration kLease = std::chrono::seconds{3};

  FeedDesk(FeedSteering steering, double wheel_base_mm)
      : steering_{std::move(steering)}, wheel_base_mm_{wheel_base_mm} {}

  // Does what the line asks, and returns the answer; nothing if none is wanted.
  std::optional<std::string> hear(FeedConnection& client, std::string_view line, rt::TimePoint now);
  // The client is gone.
  void leave(Lease::Client client);
  // Nobody has the lease any longer.
  void revoke();
  // Call it at the time of lease().until().
  void expire(rt::TimePoint now);

  const Lease& lease() const { return lease_; }

 private:
  // What the answer says beside `ok`, as members of it.
  Result<std::string> act(FeedConnection& client, const FeedRequest::What& what, rt::TimePoint now);
  Result<std::string> hold(const FeedConnection& client, const feed_request::Hold& wanted,
                           rt::TimePoint now);
  Result<std::string> drive(const rt::WheelSpeeds& speeds);
  Result<std::string> control(const std::string& line);
  void stop();

  FeedSteering steering_;
  double wheel_base_mm_;
  Lease lease_{kLease};
};

}  // namespace cargobay::hal
