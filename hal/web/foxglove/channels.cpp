#include "hal/web/foxglove/channels.hpp"

#include <algorithm>
#include <array>

#include <nlohmann/json.hpp>

#include "hal/export/foxglove_schemas.hpp"
#include "hal/web/foxglove/schemas.hpp"

namespace cargobay::web {
namespace {

constexpr auto kChannels = std::to_array<Channel>({
    {ChannelId::hello, "/hello", "hello"},
    {ChannelId::status, "/status", "status"},
    {ChannelId::state, "/state", "state"},
    {ChannelId::sensors, "/sensors", "sensors"},
    {ChannelId::event, "/event", "event"},
    {ChannelId::statistics, "/statistics", "statistics"},
    {ChannelId::truth, "/truth", "truth"},
    {ChannelId::virtual_create, "/virtual_create", "virtual_create"},
    {ChannelId::world, "/world", "world"},
    {ChannelId::holder, "/holder", "holder"},
    {ChannelId::missed, "/missed", "missed"},
    {ChannelId::pose, "/odometry/pose", "state"},
    {ChannelId::path, "/odometry/path", "state"},
    {ChannelId::transform, "/tf", "state"},
    {ChannelId::log, "/log", "event"},
    {ChannelId::scene, "/scene", "truth", "state"},
    {ChannelId::true_pose, "/truth/pose", "truth", "state"},
});

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
    default:
      return {.name = "cargobay." + std::string{channel.feed_type},
              .json = feed_schema(channel.feed_type)};
  }
}

}  // namespace

std::span<const Channel> channels() { return kChannels; }

const Channel* find_channel(std::uint64_t id) {
  const auto* const found = std::ranges::find_if(
      kChannels, [id](const Channel& one) { return static_cast<std::uint64_t>(one.id) == id; });
  return found == kChannels.end() ? nullptr : found;
}

const Channel* own_channel(std::string_view feed_type) {
  const auto* const found = std::ranges::find(kChannels, feed_type, &Channel::feed_type);
  return found == kChannels.end() ? nullptr : found;
}

namespace {

std::string made_advertisement() {
  nlohmann::json list = nlohmann::json::array();
  for (const Channel& channel : kChannels) {
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
