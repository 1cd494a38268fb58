// Any lines as requests to a feed, from two clients: nothing moves the robot but the holder's
// setpoints, each within the robot's range; and every answer is one line of JSON.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "hal/feed/feed_connection.hpp"
#include "hal/feed/feed_desk.hpp"

namespace {

namespace hal = cargobay::hal;
namespace rt = cargobay::rt;

void require(bool condition) {
  if (!condition) std::abort();
}

hal::FeedSteering steering(const bool& holder_asks) {
  const auto require_holder = [&holder_asks] { require(holder_asks); };
  return {.drive =
              [=](const rt::WheelSpeeds& speeds) {
                require_holder();
                require(std::abs(speeds.left_mm_s) <= 500 && std::abs(speeds.right_mm_s) <= 500);
                return hal::Result<void>{};
              },
          .stop = [] {},
          .rearm =
              [=] {
                require_holder();
                return hal::Result<void>{};
              },
          .reset_odometry =
              [=](const rt::OdometryPose& pose) {
                require_holder();
                require(std::abs(pose.x_mm) <= 1e9 && std::abs(pose.y_mm) <= 1e9);
                require(std::abs(pose.heading_rad) <= 1e6);
                return hal::Result<void>{};
              },
          .send =
              [=](std::string_view) {
                require_holder();
                return hal::Result<void>{};
              },
          .control = [](std::string_view line) { return std::string{line}; }};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  bool holder_asks = false;
  hal::FeedDesk desk{steering(holder_asks), 258.0};
  hal::FeedConnection clients[2] = {hal::FeedConnection{hal::Descriptor{}, 1, {}},
                                    hal::FeedConnection{hal::Descriptor{}, 2, {}}};
  rt::TimePoint now{};
  std::string_view rest{reinterpret_cast<const char*>(data), size};
  while (!rest.empty()) {
    // The first byte of a line says who asks, and how much later.
    const auto head = static_cast<unsigned char>(rest.front());
    rest.remove_prefix(1);
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    hal::FeedConnection& client = clients[head % 2];
    now += std::chrono::milliseconds{head * 10};
    desk.expire(now);
    holder_asks = desk.lease().holds(client.number());
    const std::optional<std::string> answer = desk.hear(client, line, now);
    if (!answer) continue;
    require(answer->find('\n') == std::string::npos);
    const auto read = nlohmann::json::parse(*answer, nullptr, false);
    require(read.is_object() && read.contains("ok") && read["type"] == "answer");
  }
  return 0;
}
