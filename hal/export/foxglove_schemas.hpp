// Messages that Foxglove's panels know without being told: where the robot is, the way it came, and
// what happened. Each with its JSON schema, which is that of Foxglove's own definitions in all that
// it says of names and types (https://docs.foxglove.dev/docs/sdk/schemas). Metres and radians.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/sensing/events.hpp"
#include "rt/odometry.hpp"

namespace cargobay::hal {

// The frame of the odometry, which begins where the robot does; and that of the robot.
inline constexpr std::string_view kOdometryFrame = "odom";
inline constexpr std::string_view kRobotFrame = "base_link";

struct FoxgloveSchema {
  std::string_view name{};  // "foxglove.PoseInFrame"
  std::string json{};
};
FoxgloveSchema pose_in_frame_schema();
FoxgloveSchema frame_transform_schema();
FoxgloveSchema poses_in_frame_schema();
FoxgloveSchema log_schema();

// Append one message, a JSON object. Any thread.
void append_pose_in_frame(std::string& out, std::int64_t unix_ns, const rt::OdometryPose& pose);
// Of the robot in the frame of the odometry.
void append_frame_transform(std::string& out, std::int64_t unix_ns, const rt::OdometryPose& pose);
void append_poses_in_frame(std::string& out, std::int64_t unix_ns,
                           std::span<const rt::OdometryPose> poses);
// An event in words; a warning if it keeps the robot from what it is asked for.
void append_log(std::string& out, std::int64_t unix_ns, const Event& event);

// The way so far, in no more than 256 poses, evenly spaced: their distance doubles when they are
// too many. One thread.
class WaySoFar {
 public:
  void add(const rt::OdometryPose& pose);
  // The last one is the newest pose.
  std::span<const rt::OdometryPose> poses() const { return poses_; }

 private:
  static constexpr std::size_t kMost = 256;

  std::vector<rt::OdometryPose> poses_{};
  double spacing_mm_ = 10.0;
};

}  // namespace cargobay::hal
