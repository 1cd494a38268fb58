// The channels of the Foxglove server: the feed's messages as they are, and what Foxglove's panels
// draw without being told how.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace cargobay::web {

enum class ChannelId : std::uint8_t {
  // The feed's own, each with the type's name as its topic.
  hello = 1,
  status,
  state,
  sensors,
  event,
  statistics,
  truth,
  virtual_create,
  world,
  holder,
  missed,
  // Made of them.
  pose,       // of the odometry
  path,       // the way so far
  transform,  // the frame of the robot in that of the odometry
  log,        // events in words
  scene,      // the virtual world
  true_pose,  // of the virtual Create
};

struct Channel {
  ChannelId id = ChannelId::hello;
  std::string_view topic;
  std::string_view feed_type;  // what it is made of; one more if it needs it
  std::string_view also{};
};

std::span<const Channel> channels();
const Channel* find_channel(std::uint64_t id);
// The feed's own of that type, or null.
const Channel* own_channel(std::string_view feed_type);

// `advertise`, with schemas: JSON. Made once.
const std::string& advertisement();

// The topic on which clients publish a velocity, like geometry_msgs/Twist.
inline constexpr std::string_view kVelocityTopic = "/cmd_vel";

}  // namespace cargobay::web
