#include "hal/web/foxglove/channels.hpp"

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "hal/export/foxglove_schemas.hpp"
#include "hal/web/foxglove/schemas.hpp"

namespace cargobay::web {
namespace {

using hal::FeedType;

std::vector<Channel> made_channels() {
  std::vector<Channel> all;
  for (std::size_t i = 0; i < hal::kFeedTypes; ++i) {
    const auto type = static_cast<FeedType>(i);
    if (type == FeedType::answer || type == FeedType::controls) continue;  // for whoever steers
    all.push_back({.id = own_channel(type),
                   .topic = "/" + std::string{hal::name(type)},
                   .feed_type = type,
                   .is_own = true});
  }
  all.insert(all.end(), {{ChannelId::pose, "/odometry/pose", FeedType::state},
                         {ChannelId::path, "/odometry/path", FeedType::state},
                         {ChannelId::transform, "/tf", FeedType::state},
                         {ChannelId::log, "/log", FeedType::event},
                         {ChannelId::scene, "/scene", FeedType::truth, FeedType::state},
                         {ChannelId::true_pose, "/truth/pose", FeedType::truth, FeedType::state}});
  return all;
}

struct NamedSchema {
  std::string name;
  std::string json;
};

NamedSchema known(const hal::FoxgloveSchema& schema) {
  return {.name = std::string{schema.name}, .json = schema.json};
}

NamedSchema schema_of(const Channel& channel) {
  switch (channel.id) {
    case ChannelId::pose:
    case ChannelId::true_pose: return known(hal::pose_in_frame_schema());
    case ChannelId::path: return known(hal::poses_in_frame_schema());
    case ChannelId::transform: return known(hal::frame_transform_schema());
    case ChannelId::log: return known(hal::log_schema());
    case ChannelId::scene: return {.name = "foxglove.SceneUpdate", .json = scene_update_schema()};
  }
  return {.name = "cargobay." + std::string{hal::name(channel.feed_type)},
          .json = feed_schema(channel.feed_type)};
}

}  // namespace

const std::vector<Channel>& channels() {
  static const std::vector<Channel> kMade = made_channels();
  return kMade;
}

const Channel* find_channel(std::uint64_t id) {
  const auto found = std::ranges::find_if(
      channels(), [id](const Channel& one) { return static_cast<std::uint64_t>(one.id) == id; });
  return found == channels().end() ? nullptr : &*found;
}

namespace {

std::string made_advertisement() {
  nlohmann::json list = nlohmann::json::array();
  for (const Channel& channel : channels()) {
    const NamedSchema schema = schema_of(channel);
    list.push_back({{"id", static_cast<int>(channel.id)},
                    {"topic", channel.topic},
                    {"encoding", "json"},
                    {"schemaName", schema.name},
                    {"schema", schema.json},
                    {"schemaEncoding", "jsonschema"}});
  }
  return nlohmann::json{{"op", "advertise"}, {"channels", list}}.dump();
}

}  // namespace

const std::string& advertisement() {
  static const std::string kMade = made_advertisement();
  return kMade;
}

}  // namespace cargobay::web
