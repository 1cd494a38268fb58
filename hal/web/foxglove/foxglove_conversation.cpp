#include "hal/web/foxglove/foxglove_conversation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include <nlohmann/json.hpp>

#include "hal/web/foxglove/services.hpp"

namespace cargobay::web {
namespace {

using hal::FeedType;
using Json = nlohmann::json;

constexpr std::string_view kNameParameter = "steer.name";
constexpr std::string_view kTakeParameter = "steer.take";
constexpr std::string_view kHolderParameter = "holder";
constexpr std::int64_t kPathEveryNs = 500'000'000;
// Farther than wheels go between two states: the odometry was set.
constexpr double kJumpMetres = 0.2;
// Types of which all is read, since little comes of them.
constexpr auto kRareTypes =
    std::to_array<FeedType>({FeedType::statistics, FeedType::virtual_create, FeedType::world});

bool comes_unasked(FeedType type) {
  return type == FeedType::hello || type == FeedType::status || type == FeedType::holder ||
         type == FeedType::event || type == FeedType::missed;
}

bool is_kept(FeedType type) {
  return std::ranges::find(kRareTypes, type) != kRareTypes.end() || type == FeedType::hello ||
         type == FeedType::status || type == FeedType::holder;
}

void put_number(std::string& bytes, std::uint64_t number, unsigned length) {
  for (unsigned i = 0; i < length; ++i)
    bytes += static_cast<char>(static_cast<unsigned char>(number >> 8U * i));
}

// A message of a channel.
std::string data(std::uint32_t subscription, std::int64_t unix_ns, std::string_view payload) {
  std::string bytes{1};
  put_number(bytes, subscription, 4);
  put_number(bytes, static_cast<std::uint64_t>(unix_ns), 8);
  return bytes += payload;
}

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
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
    publish_newest(subscription, *found);
  }
}

// What does not come again soon comes now.
void FoxgloveConversation::publish_newest(std::uint32_t subscription, const Channel& channel) {
  const auto newest = newest_.find(channel.feed_type);
  if (newest == newest_.end() || !channel.is_own) return;
  send_binary(data(subscription, newest->second.unix_ns, newest->second.line));
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
  const auto done = [this, call](const hal::heard::Answer& answer) { answer_call(call, answer); };
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
                                       const hal::heard::Answer& answer) {
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
  std::set<FeedType> types{kRareTypes.begin(), kRareTypes.end()};
  for (const auto& [subscription, id] : subscriptions_) {
    const Channel* const channel = find_channel(static_cast<std::uint64_t>(id));
    types.insert(channel->feed_type);
    if (channel->also) types.insert(*channel->also);
  }
  std::erase_if(types, comes_unasked);
  if (types == chosen_) return;
  chosen_ = types;
  Json names = Json::array();
  for (const FeedType type : types) names.push_back(hal::name(type));
  request(dump({{"do", "subscribe"}, {"types", names}}));
}

// From the feed.

void FoxgloveConversation::tell(std::string_view line, std::int64_t unix_ns) {
  const auto message = hal::read_message(line);
  if (!message) return;
  const std::int64_t time = message->unix_ns != 0 ? message->unix_ns : unix_ns;
  if (is_kept(message->type)) newest_[message->type] = {.unix_ns = time, .line = std::string{line}};
  publish(own_channel(message->type), time, line);
  take(*message, time);
}

void FoxgloveConversation::take(const hal::HeardMessage& message, std::int64_t unix_ns) {
  if (const auto* const answer = std::get_if<hal::heard::Answer>(&message.what))
    steering_.answered(*answer);
  if (const auto* const hello = std::get_if<hal::heard::Hello>(&message.what)) greet(*hello);
  if (const auto* const holder = std::get_if<hal::heard::Holder>(&message.what))
    tell_holder(*holder);
  if (const auto* const world = std::get_if<hal::heard::World>(&message.what)) world_ = *world;
  if (const auto* const record = std::get_if<hal::StateRecord>(&message.what))
    publish_state(record->state.pose, unix_ns);
  if (const auto* const truth = std::get_if<hal::heard::Truth>(&message.what))
    publish_truth(truth->pose, unix_ns);
  if (const auto* const event = std::get_if<hal::heard::Event>(&message.what))
    publish_log(event->what, event->text, false, unix_ns);
  if (const auto* const status = std::get_if<hal::heard::Status>(&message.what))
    publish_log(status->stage.value_or(""), status->text, status->stage == "lost", unix_ns);
}

void FoxgloveConversation::greet(const hal::heard::Hello& hello) {
  for (const auto& [name, value] : hello.constants) parameters_[name] = value;
  chosen_.clear();
  choose();
}

void FoxgloveConversation::tell_holder(const hal::heard::Holder& holder) {
  steering_.held_by(holder);
  parameters_[std::string{kHolderParameter}] = dump(Json(holder.name.value_or("")));
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
    if (wanted == channel) send_binary(data(subscription, unix_ns, payload));
  }
}

void FoxgloveConversation::publish_state(const rt::OdometryPose& odometry, std::int64_t unix_ns) {
  const Pose pose = in_metres(odometry);
  if (odometry_ && std::hypot(pose.x_m - odometry_->x_m, pose.y_m - odometry_->y_m) > kJumpMetres) {
    origin_.reset();
    is_scene_due_ = true;
    way_ = {};
  }
  odometry_ = pose;
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
void FoxgloveConversation::publish_truth(const rt::OdometryPose& truth, std::int64_t unix_ns) {
  if (!odometry_) return;
  const Pose pose = in_metres(truth);
  if (!origin_) origin_ = placed_in(*odometry_, seen_from(pose, Pose{}));
  if (is_scene_due_ && world_ && is_wanted(ChannelId::scene)) {
    is_scene_due_ = false;
    publish(ChannelId::scene, unix_ns, scene_update(unix_ns, *world_, *origin_));
  }
  if (!is_wanted(ChannelId::true_pose)) return;
  std::string payload;
  hal::append_pose_in_frame(payload, unix_ns, in_millimetres(placed_in(*origin_, pose)));
  publish(ChannelId::true_pose, unix_ns, payload);
}

void FoxgloveConversation::publish_log(std::string_view name, std::string_view text,
                                       bool is_warning, std::int64_t unix_ns) {
  if (is_wanted(ChannelId::log))
    publish(ChannelId::log, unix_ns, log_message(unix_ns, name, text, is_warning));
}

}  // namespace cargobay::web
