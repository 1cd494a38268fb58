#include "hal/web/server/newest_state.hpp"

#include "hal/feed/message/reading.hpp"

namespace cargobay::web {

void StateFollower::attach(lws_vhost* host) {
  auto feed = FeedLink::open(host, which_, *this);
  if (!feed) {
    reason_ = feed.failure().message;
    retry_();
    return;
  }
  feed_ = std::move(*feed);
  reason_ = "the robot has sent no frame yet";
  feed_->send("{\"do\":\"subscribe\",\"types\":[\"state\"]}\n");
}

NewestState StateFollower::newest() const { return {.json = state_, .reason = reason_}; }

void StateFollower::line(std::string_view line) {
  const auto message = hal::read_message(line);
  if (message && message->type == hal::FeedType::state) state_ = line;
}

void StateFollower::feed_gone() {
  feed_.reset();
  state_.clear();
  reason_ = "the feed has ended";
  retry_();
}

}  // namespace cargobay::web
