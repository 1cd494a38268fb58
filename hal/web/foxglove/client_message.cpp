#include "hal/web/foxglove/client_message.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

#include <nlohmann/json.hpp>

namespace cargobay::web {
namespace {

using Json = nlohmann::json;
namespace msg = client_message;

const Json* member(const Json& object, std::string_view key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

std::string text(const Json& object, std::string_view key) {
  const Json* const value = member(object, key);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string{};
}

std::optional<std::uint32_t> number32(const Json& value) {
  if (!value.is_number_unsigned()) return std::nullopt;
  const auto number = value.get<std::uint64_t>();
  if (number > std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
  return static_cast<std::uint32_t>(number);
}

std::optional<std::uint32_t> number32(const Json& object, std::string_view key) {
  const Json* const value = member(object, key);
  return value == nullptr ? std::nullopt : number32(*value);
}

// The elements of a list; none if it is not one.
std::vector<Json> list(const Json& object, std::string_view key) {
  const Json* const value = member(object, key);
  if (value == nullptr || !value->is_array()) return {};
  return {value->begin(), value->end()};
}

hal::Failure bad(std::string_view op, std::string_view what) {
  return {.message = std::string{op} + ": " + std::string{what}};
}

hal::Result<std::vector<std::uint32_t>> numbers(const Json& object, std::string_view key) {
  std::vector<std::uint32_t> result;
  for (const Json& one : list(object, key)) {
    const auto number = number32(one);
    if (!number) return bad(key, "these are numbers");
    result.push_back(*number);
  }
  return result;
}

hal::Result<std::vector<std::string>> names(const Json& object) {
  std::vector<std::string> result;
  for (const Json& one : list(object, "parameterNames")) {
    if (!one.is_string()) return bad("parameterNames", "these are strings");
    result.push_back(one.get<std::string>());
  }
  return result;
}

hal::Result<ClientMessage> subscribe(const Json& json) {
  msg::Subscribe message;
  for (const Json& one : list(json, "subscriptions")) {
    const auto subscription = number32(one, "id");
    const auto channel = number32(one, "channelId");
    if (!subscription || !channel) return bad("subscribe", "id and channelId are numbers");
    message.subscriptions.push_back({.subscription = *subscription, .channel = *channel});
  }
  return ClientMessage{message};
}

hal::Result<ClientMessage> advertise(const Json& json) {
  msg::Advertise message;
  for (const Json& one : list(json, "channels")) {
    const auto channel = number32(one, "id");
    if (!channel) return bad("advertise", "id is a number");
    message.channels.push_back(
        {.channel = *channel, .topic = text(one, "topic"), .encoding = text(one, "encoding")});
  }
  return ClientMessage{message};
}

hal::Result<ClientMessage> set_parameters(const Json& json) {
  msg::SetParameters message{.parameters = {}, .id = text(json, "id")};
  for (const Json& one : list(json, "parameters")) {
    msg::SetParameters::One parameter{.name = text(one, "name")};
    if (parameter.name.empty()) return bad("setParameters", "a parameter has a name");
    const Json* const value = member(one, "value");
    if (value != nullptr && value->is_string()) parameter.text = value->get<std::string>();
    if (value != nullptr && value->is_boolean()) parameter.truth = value->get<bool>();
    message.parameters.push_back(std::move(parameter));
  }
  return ClientMessage{message};
}

hal::Result<ClientMessage> with_names(const Json& json, const std::string& op) {
  auto found = names(json);
  if (!found) return found.failure();
  if (op == "getParameters")
    return ClientMessage{msg::GetParameters{.names = std::move(*found), .id = text(json, "id")}};
  return ClientMessage{
      msg::WatchParameters{.names = std::move(*found), .on = op == "subscribeParameterUpdates"}};
}

hal::Result<ClientMessage> with_numbers(const Json& json, const std::string& op) {
  auto found = numbers(json, op == "unsubscribe" ? "subscriptionIds" : "channelIds");
  if (!found) return found.failure();
  if (op == "unsubscribe") return ClientMessage{msg::Unsubscribe{std::move(*found)}};
  return ClientMessage{msg::Unadvertise{std::move(*found)}};
}

// Little endian.
std::uint32_t number_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < 4; ++i)
    number |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << 8U * i;
  return number;
}

hal::Result<double> component(const Json& twist, std::string_view vector, std::string_view axis) {
  const Json* const found = member(twist, vector);
  const Json* const value = found == nullptr ? nullptr : member(*found, axis);
  if (value == nullptr) return 0.0;
  if (!value->is_number() || !std::isfinite(value->get<double>()))
    return bad(vector, "its components are numbers");
  return value->get<double>();
}

}  // namespace

hal::Result<ClientMessage> read_client_text(std::string_view bytes) {
  const Json json = Json::parse(bytes, nullptr, false);
  const std::string op = text(json, "op");
  if (op.empty()) return hal::Failure{.message = "a message is a JSON object with an `op`"};
  if (op == "subscribe") return subscribe(json);
  if (op == "advertise") return advertise(json);
  if (op == "setParameters") return set_parameters(json);
  if (op == "unsubscribe" || op == "unadvertise") return with_numbers(json, op);
  if (op == "getParameters" || op == "subscribeParameterUpdates" ||
      op == "unsubscribeParameterUpdates")
    return with_names(json, op);
  return ClientMessage{msg::Other{op}};
}

hal::Result<ClientMessage> read_client_binary(std::string_view bytes) {
  constexpr std::size_t kDataHead = 5;
  constexpr std::size_t kCallHead = 13;
  if (bytes.size() >= kDataHead && bytes.front() == 1) {
    return ClientMessage{
        msg::Data{.channel = number_at(bytes, 1), .payload = std::string{bytes.substr(kDataHead)}}};
  }
  if (bytes.size() >= kCallHead && bytes.front() == 2) {
    const std::size_t length = number_at(bytes, 9);
    const std::string_view rest = bytes.substr(kCallHead);
    if (length > rest.size()) return bad("service call", "its encoding is longer than the message");
    return ClientMessage{msg::ServiceCall{.service = number_at(bytes, 1),
                                          .call = number_at(bytes, 5),
                                          .encoding = std::string{rest.substr(0, length)},
                                          .payload = std::string{rest.substr(length)}}};
  }
  return hal::Failure{.message = "a binary message is data or a service call"};
}

hal::Result<Velocity> read_velocity(std::string_view payload) {
  const Json json = Json::parse(payload, nullptr, false);
  if (!json.is_object()) return bad(payload.empty() ? "nothing" : "velocity", "JSON is expected");
  const Json* const stamped = member(json, "twist");
  const Json& twist = stamped != nullptr ? *stamped : json;
  const auto linear = component(twist, "linear", "x");
  if (!linear) return linear.failure();
  const auto angular = component(twist, "angular", "z");
  if (!angular) return angular.failure();
  return Velocity{.linear_m_s = *linear, .angular_rad_s = *angular};
}

}  // namespace cargobay::web
