// The channels of the Foxglove server: the feed's messages as they are, and what Foxglove's panels
// draw without being told how.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/feed/message/messages.hpp"

namespace cargobay::web {

// The feed's own have the numbers of their types, from 1 on; these are made of them.
enum class ChannelId : std::uint8_t {
  pose = 64,  // of the odometry
  path,       // the way so far
  transform,  // the frame of the robot in that of the odometry
  log,        // events in words
  scene,      // the virtual world
  true_pose,  // of the virtual Create
};
constexpr ChannelId own_channel(hal::FeedType type) {
  return static_cast<ChannelId>(static_cast<unsigned>(type) + 1);
}

struct Channel {
  ChannelId id = ChannelId::pose;
  std::string topic{};
  hal::FeedType feed_type{};  // what it is made of; one more if it needs it
  std::optional<hal::FeedType> also{};
  bool is_own = false;  // of the feed
};

// Made once.
const std::vector<Channel>& channels();
const Channel* find_channel(std::uint64_t id);

// `advertise`, with schemas: JSON. Made once.
const std::string& advertisement();

// The topic on which clients publish a velocity, like geometry_msgs/Twist.
inline constexpr std::string_view kVelocityTopic = "/cmd_vel";

}  // namespace cargobay::web
