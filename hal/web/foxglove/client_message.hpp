// What a Foxglove client sends (foxglove.websocket.v1), read from its bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "hal/result.hpp"

namespace cargobay::web {

namespace client_message {

struct Subscribe {
  struct One {
    std::uint32_t subscription = 0;
    std::uint64_t channel = 0;
  };
  std::vector<One> subscriptions{};
};
struct Unsubscribe {
  std::vector<std::uint32_t> subscriptions{};
};
struct Advertise {
  struct One {
    std::uint32_t channel = 0;  // the client's number
    std::string topic{};
    std::string encoding{};
  };
  std::vector<One> channels{};
};
struct Unadvertise {
  std::vector<std::uint32_t> channels{};
};
struct GetParameters {
  std::vector<std::string> names{};  // empty: all
  std::string id{};
};
struct SetParameters {
  struct One {
    std::string name{};
    std::optional<std::string> text{};
    std::optional<bool> truth{};
  };
  std::vector<One> parameters{};
  std::string id{};
};
struct WatchParameters {
  std::vector<std::string> names{};
  bool on = true;
};
// A message on a channel of the client's.
struct Data {
  std::uint32_t channel = 0;
  std::string payload{};
};
struct ServiceCall {
  std::uint32_t service = 0;
  std::uint32_t call = 0;
  std::string encoding{};
  std::string payload{};
};
// Nothing that concerns this server.
struct Other {
  std::string op{};
};

}  // namespace client_message

using ClientMessage =
    std::variant<client_message::Subscribe, client_message::Unsubscribe, client_message::Advertise,
                 client_message::Unadvertise, client_message::GetParameters,
                 client_message::SetParameters, client_message::WatchParameters,
                 client_message::Data, client_message::ServiceCall, client_message::Other>;

// Of any bytes. A failure says what is wrong. Allocates; never throws. Any thread.
hal::Result<ClientMessage> read_client_text(std::string_view bytes);
hal::Result<ClientMessage> read_client_binary(std::string_view bytes);

// A velocity like geometry_msgs/Twist, or TwistStamped: `linear.x` in m/s, `angular.z` in rad/s. A
// member that is missing is 0; one that is no finite number is a failure.
struct Velocity {
  double linear_m_s = 0.0;
  double angular_rad_s = 0.0;
};
hal::Result<Velocity> read_velocity(std::string_view payload);

}  // namespace cargobay::web
