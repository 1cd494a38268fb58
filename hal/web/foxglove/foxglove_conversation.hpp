// `/foxglove`: Foxglove's WebSocket protocol in front of a feed.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "hal/export/foxglove_schemas.hpp"
#include "hal/feed/message/reading.hpp"
#include "hal/web/conversation.hpp"
#include "hal/web/foxglove/channels.hpp"
#include "hal/web/foxglove/client_message.hpp"
#include "hal/web/foxglove/drawn.hpp"
#include "hal/web/foxglove/steering.hpp"
#include "rt/clock.hpp"

namespace cargobay::web {

// One thread. Nothing that a client sends ends it; what is not understood is said in a status.
class FoxgloveConversation final : public Conversation {
 public:
  // `now`: for tests.
  explicit FoxgloveConversation(std::function<rt::TimePoint()> now = rt::Clock::now);

  std::optional<Ending> hear(std::string_view message, bool is_binary) override;
  void tell(std::string_view line, std::int64_t unix_ns) override;

 private:
  static constexpr std::size_t kMostSubscriptions = 128;
  static constexpr std::size_t kMostClientChannels = 16;

  void act(const client_message::Subscribe& message);
  void act(const client_message::Unsubscribe& message);
  void act(const client_message::Advertise& message);
  void act(const client_message::Unadvertise& message);
  void act(const client_message::GetParameters& message);
  void act(const client_message::SetParameters& message);
  void act(const client_message::WatchParameters& message);
  void act(const client_message::Data& message);
  void act(const client_message::ServiceCall& message);
  void act(const client_message::Other& message);

  void take(const hal::HeardMessage& message, std::int64_t unix_ns);
  void greet(const hal::heard::Hello& hello);
  void choose();
  void complain(std::string_view text);
  void fail_call(const client_message::ServiceCall& call, std::string_view text);
  void answer_call(const client_message::ServiceCall& call, const hal::heard::Answer& answer);
  void send_parameters(const std::set<std::string>& names, const std::string& id);
  void tell_holder(const hal::heard::Holder& holder);

  bool is_wanted(ChannelId channel) const;
  void publish(ChannelId channel, std::int64_t unix_ns, std::string_view payload);
  void publish_newest(std::uint32_t subscription, const Channel& channel);
  void publish_state(const rt::OdometryPose& odometry, std::int64_t unix_ns);
  void publish_truth(const rt::OdometryPose& truth, std::int64_t unix_ns);
  void publish_log(std::string_view name, std::string_view text, bool is_warning,
                   std::int64_t unix_ns);

  std::map<std::uint32_t, ChannelId> subscriptions_{};  // by the client's numbers
  std::set<std::uint32_t> velocity_channels_{};         // likewise
  std::set<std::string> watched_{};                     // parameters
  std::map<std::string, std::string> parameters_{};     // name and JSON
  struct Newest {
    std::int64_t unix_ns = 0;
    std::string line{};
  };
  std::map<hal::FeedType, Newest> newest_{};  // of types that come rarely
  Steering steering_;
  hal::WaySoFar way_{};
  std::int64_t path_sent_ns_ = 0;
  std::optional<Pose> odometry_{};  // the newest
  std::optional<Pose> origin_{};    // of the world, in the frame of the odometry
  std::optional<hal::heard::World> world_{};
  bool is_scene_due_ = true;
  std::set<hal::FeedType> chosen_{};  // of the feed
};

}  // namespace cargobay::web
