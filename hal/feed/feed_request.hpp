// What a reader of a feed may ask (docs/feed.md), from a line of JSON.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "hal/feed/feed_connection.hpp"
#include "hal/result.hpp"
#include "rt/odometry.hpp"
#include "rt/twist.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

namespace feed_request {

struct Subscribe {
  FeedChoice choice{};
};
struct Hold {
  std::string name{};
  bool take = false;
};
struct Release {};
struct DriveWheels {
  rt::WheelSpeeds speeds{};
};
struct DriveTwist {
  rt::Twist twist{};
};
struct Stop {};
struct Rearm {};
struct ResetOdometry {
  rt::OdometryPose pose{};
};
struct Send {
  std::string command{};
};
struct Control {
  std::string line{};
};

}  // namespace feed_request

struct FeedRequest {
  using What = std::variant<feed_request::Subscribe, feed_request::Hold, feed_request::Release,
                            feed_request::DriveWheels, feed_request::DriveTwist, feed_request::Stop,
                            feed_request::Rearm, feed_request::ResetOdometry, feed_request::Send,
                            feed_request::Control>;
};

// A failure says what is wrong. `id` becomes that of the request, as JSON; it stays as it is if the
// request has none, and so wants no answer. Allocates, blocks for nothing; never throws.
Result<FeedRequest::What> parse_request(std::string_view line, std::string& id);

}  // namespace cargobay::hal
