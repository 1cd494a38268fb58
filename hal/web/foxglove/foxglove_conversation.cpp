#include "hal/web/foxglove/foxglove_conversation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include <nlohmann/json.hpp>

#include "hal/web/foxglove/drawn.hpp"
#include "hal/web/foxglove/services.hpp"

namespace cargobay::web {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kNameParameter = "steer.name";
constexpr std::string_view kTakeParameter = "steer.take";
constexpr std::string_view kHolderParameter = "holder";
constexpr std::int64_t kPathEveryNs = 500'000'000;
// Farther than wheels go between two states: the odometry was set.
constexpr double kJumpMetres = 0.2;
// Types of which all is read, since little comes of them.
constexpr auto kRareTypes =
    std::to_array<std::string_view>({"statistics", "virtual_create", "world"});

bool is_kept(std::string_view type) {
  constexpr auto kOthers = std::to_array<std::string_view>({"hello", "status", "holder"});
  return std::ranges::find(kRareTypes, type) != kRareTypes.end() ||
         std::ranges::find(kOthers, type) != kOthers.end();
}

void put_number(std::string& bytes, std::uint64_t number, unsigned length) {
  for (unsigned i = 0; i < length; ++i)
    bytes += static_cast<char>(static_cast<unsigned char>(number >> 8U * i));
}

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// In two parts: all of it in nanoseconds is more than a double holds.
std::int64_t nanoseconds(double time_s) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  constexpr double kMostSeconds = 4e9;  // beyond which it is no time of ours
  if (!(time_s >= 0.0 && time_s < kMostSeconds)) return 0;
  const double whole_s = std::floor(time_s);
  return std::llround(whole_s) * kSecond + std::llround((time_s - whole_s) * 1e9);
}

rt::OdometryPose as_odometry(const Pose& pose) {
  rt::OdometryPose result;
  result.x_mm = pose.x_m * 1e3;
  result.y_mm = pose.y_m * 1e3;
  result.heading_rad = pose.heading_rad;
  return result;
}

}  // namespace

FoxgloveConversation::FoxgloveConversation(std::function<rt::TimePoint()> now)
    : steering_{[this](const std::string& line) { request(line); }, std::move(now)} {
  parameters_[std::string{kNameParameter}] = dump(Json(steering_.name()));
  parameters_[std::string{kTakeParameter}] = "false";
  send(dump({{"op", "serverInfo"},
             {"name", "Cargobay"},
             {"capabilities", {"clientPublish", "parameters", "parametersSubscribe", "services"}},
             {"supportedEncodings", {"json"}},
             {"metadata", Json::object()}}));
  send(advertisement());
  send(services_advertisement());
}

// From the client.

std::optional<Ending> FoxgloveConversation::hear(std::string_view message, bool is_binary) {
  const auto read = is_binary ? read_client_binary(message) : read_client_text(message);
  if (read) {
    std::visit([this](const auto& one) { act(one); }, *read);
  } else {
    complain(read.failure().message);
  }
  return std::nullopt;
}

void FoxgloveConversation::complain(std::string_view text) {
  constexpr int kWarning = 1;
  send(dump({{"op", "status"}, {"level", kWarning}, {"message", text}}));
}

void FoxgloveConversation::act(const client_message::Subscribe& message) {
  for (const auto& [subscription, channel] : message.subscriptions) {
    const Channel* const found = find_channel(channel);
    if (found == nullptr || subscriptions_.size() >= kMostSubscriptions) {
      complain(found == nullptr ? "subscribe: there is no such channel"
                                : "subscribe: too many subscriptions");
      continue;
    }
    subscriptions_[subscription] = found->id;
    if (found->id == ChannelId::scene) is_scene_due_ = true;
    choose();
    // What does not come again soon comes now.
    const auto newest = newest_.find(found->feed_type);
    if (newest == newest_.end() || own_channel(found->feed_type) != found) continue;
    std::string bytes{1};
    put_number(bytes, subscription, 4);
    put_number(bytes, 0, 8);
    send_binary(bytes + newest->second);
  }
}

void FoxgloveConversation::act(const client_message::Unsubscribe& message) {
  for (const std::uint32_t subscription : message.subscriptions) subscriptions_.erase(subscription);
  choose();
}

void FoxgloveConversation::act(const client_message::Advertise& message) {
  for (const auto& channel : message.channels) {
    if (channel.topic != kVelocityTopic || channel.encoding != "json" ||
        velocity_channels_.size() >= kMostClientChannels) {
      complain("advertise " + channel.topic + ": only " + std::string{kVelocityTopic} +
               " is understood, a geometry_msgs/Twist in json");
      continue;
    }
    velocity_channels_.insert(channel.channel);
  }
}

void FoxgloveConversation::act(const client_message::Unadvertise& message) {
  for (const std::uint32_t channel : message.channels) velocity_channels_.erase(channel);
  if (velocity_channels_.empty()) steering_.release();
}

void FoxgloveConversation::act(const client_message::GetParameters& message) {
  send_parameters({message.names.begin(), message.names.end()}, message.id);
}

void FoxgloveConversation::act(const client_message::SetParameters& message) {
  std::set<std::string> names;
  for (const auto& one : message.parameters) {
    names.insert(one.name);
    if (one.name == kNameParameter && one.text && !one.text->empty()) {
      steering_.set_name(*one.text);
      parameters_[one.name] = dump(Json(*one.text));
    } else if (one.name == kTakeParameter && one.truth) {
      steering_.set_take(*one.truth);
      parameters_[one.name] = *one.truth ? "true" : "false";
    } else {
      complain("parameter " + one.name +
               ": only steer.name, a string, and steer.take, true or "
               "false, can be set");
    }
  }
  send_parameters(names, message.id);
}

void FoxgloveConversation::act(const client_message::WatchParameters& message) {
  for (const std::string& name : message.names) {
    if (!message.on) {
      watched_.erase(name);
    } else if (parameters_.contains(name)) {
      watched_.insert(name);
    }
  }
  if (message.names.empty() && !message.on) watched_.clear();
  if (message.names.empty() && message.on) {
    for (const auto& [name, value] : parameters_) watched_.insert(name);
  }
}

void FoxgloveConversation::act(const client_message::Data& message) {
  if (!velocity_channels_.contains(message.channel)) {
    complain("data on a channel that was not advertised");
    return;
  }
  const auto velocity = read_velocity(message.payload);
  if (!velocity) {
    complain(std::string{kVelocityTopic} + ": " + velocity.failure().message);
    return;
  }
  const auto refused = [this](const std::string& reason) {
    complain(std::string{kVelocityTopic} + ": " + reason +
             (steering_.takes() ? "" : " (the parameter steer.take takes the robot from others)") +
             "; let go, then publish again");
  };
  if (!steering_.drive(*velocity, refused)) complain("the feed does not answer");
}

void FoxgloveConversation::act(const client_message::ServiceCall& message) {
  const auto request = service_request(message.service);
  if (!request || message.encoding != "json") {
    fail_call(message, request ? "the encoding is json" : "there is no such service");
    return;
  }
  client_message::ServiceCall call = message;
  call.payload.clear();
  const auto done = [this, call](const FeedAnswer& answer) { answer_call(call, answer); };
  if (!steering_.ask(*request, done)) fail_call(call, "the feed does not answer");
}

void FoxgloveConversation::act(const client_message::Other& message) {
  // How clients of Foxglove's SDK introduce themselves.
  if (message.op != "clientInfo") complain(message.op + ": not understood");
}

void FoxgloveConversation::fail_call(const client_message::ServiceCall& call,
                                     std::string_view text) {
  send(dump({{"op", "serviceCallFailure"},
             {"serviceId", call.service},
             {"callId", call.call},
             {"message", text}}));
}

void FoxgloveConversation::answer_call(const client_message::ServiceCall& call,
                                       const FeedAnswer& answer) {
  std::string bytes{3};
  put_number(bytes, call.service, 4);
  put_number(bytes, call.call, 4);
  put_number(bytes, call.encoding.size(), 4);
  bytes += call.encoding;
  send_binary(bytes + dump({{"ok", answer.ok}, {"error", answer.error}}));
}

void FoxgloveConversation::send_parameters(const std::set<std::string>& names,
                                           const std::string& id) {
  std::string list;
  for (const auto& [name, value] : parameters_) {
    if (!names.empty() && !names.contains(name)) continue;
    list += (list.empty() ? "" : ",") + std::string{R"({"name":)"} + dump(Json(name)) +
            R"(,"value":)" + value + "}";
  }
  send(R"({"op":"parameterValues","parameters":[)" + list + "]" +
       (id.empty() ? std::string{} : R"(,"id":)" + dump(Json(id))) + "}");
}

// Which types the feed is to send: all that come rarely, the others if somebody wants them.
void FoxgloveConversation::choose() {
  std::set<std::string> types{kRareTypes.begin(), kRareTypes.end()};
  for (const auto& [subscription, id] : subscriptions_) {
    const Channel* const channel = find_channel(static_cast<std::uint64_t>(id));
    types.emplace(channel->feed_type);
    if (!channel->also.empty()) types.emplace(channel->also);
  }
  for (const char* const always : {"hello", "status", "holder", "event", "missed"})
    types.erase(always);
  if (types == chosen_) return;
  chosen_ = types;
  request(dump({{"do", "subscribe"}, {"types", types}}));
}

// From the feed.

void FoxgloveConversation::greet(std::string_view hello) {
  for (const Constant& constant : read_constants(hello)) parameters_[constant.name] = constant.json;
  chosen_.clear();
  choose();
}

std::int64_t FoxgloveConversation::time_of(const FeedMessage& message, std::int64_t unix_ns) {
  if (message.unix_time_s) {
    if (message.time_s) robot_epoch_s_ = *message.unix_time_s - *message.time_s;
    return nanoseconds(*message.unix_time_s);
  }
  if (message.time_s && robot_epoch_s_) return nanoseconds(*robot_epoch_s_ + *message.time_s);
  return unix_ns;
}

void FoxgloveConversation::tell(std::string_view line, std::int64_t unix_ns) {
  const auto message = read_feed_message(line);
  if (!message) return;
  if (message->type == "answer") {
    if (message->answer) steering_.answered(*message->answer);
    return;
  }
  if (message->type == "hello") greet(line);
  if (message->type == "holder") tell_holder(*message);
  if (message->type == "world") world_ = line;
  if (is_kept(message->type)) newest_[message->type] = line;
  const std::int64_t time = time_of(*message, unix_ns);
  if (const Channel* const own = own_channel(message->type)) publish(own->id, time, line);
  if (message->type == "state" && message->pose) publish_state(*message, time);
  if (message->type == "truth" && message->pose) publish_truth(*message, time);
  if (message->type == "event" || message->type == "status") publish_log(*message, time);
}

void FoxgloveConversation::tell_holder(const FeedMessage& message) {
  steering_.held_by(message.name);
  parameters_[std::string{kHolderParameter}] = dump(Json(message.name.value_or("")));
  if (watched_.contains(std::string{kHolderParameter}))
    send_parameters({std::string{kHolderParameter}}, "");
}

bool FoxgloveConversation::is_wanted(ChannelId channel) const {
  return std::ranges::any_of(subscriptions_,
                             [channel](const auto& one) { return one.second == channel; });
}

void FoxgloveConversation::publish(ChannelId channel, std::int64_t unix_ns,
                                   std::string_view payload) {
  for (const auto& [subscription, wanted] : subscriptions_) {
    if (wanted != channel) continue;
    std::string bytes{1};
    put_number(bytes, subscription, 4);
    put_number(bytes, static_cast<std::uint64_t>(unix_ns), 8);
    bytes += payload;
    send_binary(std::move(bytes));
  }
}

void FoxgloveConversation::publish_state(const FeedMessage& message, std::int64_t unix_ns) {
  const Pose& pose = *message.pose;
  if (odometry_ && std::hypot(pose.x_m - odometry_->x_m, pose.y_m - odometry_->y_m) > kJumpMetres) {
    origin_.reset();
    is_scene_due_ = true;
    way_ = {};
  }
  odometry_ = pose;
  const rt::OdometryPose odometry = as_odometry(pose);
  way_.add(odometry);
  std::string payload;
  if (is_wanted(ChannelId::pose)) {
    hal::append_pose_in_frame(payload, unix_ns, odometry);
    publish(ChannelId::pose, unix_ns, payload);
  }
  if (is_wanted(ChannelId::transform)) {
    payload.clear();
    hal::append_frame_transform(payload, unix_ns, odometry);
    publish(ChannelId::transform, unix_ns, payload);
  }
  if (is_wanted(ChannelId::path) && unix_ns - path_sent_ns_ >= kPathEveryNs) {
    path_sent_ns_ = unix_ns;
    payload.clear();
    hal::append_poses_in_frame(payload, unix_ns, way_.poses());
    publish(ChannelId::path, unix_ns, payload);
  }
}

// The world is drawn in the frame of the odometry, so that one frame is enough: at first the two
// agree; later the truth shows how far the odometry has drifted.
void FoxgloveConversation::publish_truth(const FeedMessage& message, std::int64_t unix_ns) {
  if (!odometry_) return;
  if (!origin_) origin_ = placed_in(*odometry_, seen_from(*message.pose, Pose{}));
  if (is_scene_due_ && !world_.empty() && is_wanted(ChannelId::scene)) {
    is_scene_due_ = false;
    publish(ChannelId::scene, unix_ns, scene_update(unix_ns, read_world(world_), *origin_));
  }
  if (!is_wanted(ChannelId::true_pose)) return;
  std::string payload;
  hal::append_pose_in_frame(payload, unix_ns, as_odometry(placed_in(*origin_, *message.pose)));
  publish(ChannelId::true_pose, unix_ns, payload);
}

void FoxgloveConversation::publish_log(const FeedMessage& message, std::int64_t unix_ns) {
  if (!is_wanted(ChannelId::log)) return;
  const bool is_warning = message.type == "status" && message.what == "lost";
  publish(ChannelId::log, unix_ns, log_message(unix_ns, message.what, message.text, is_warning));
}

}  // namespace cargobay::web
