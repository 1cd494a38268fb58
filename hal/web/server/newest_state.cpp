#include "hal/web/server/newest_state.hpp"

namespace cargobay::web {

void StateFollower::attach(lws_vhost* host) {
  auto feed = FeedLink::open(host, which_, *this);
  if (!feed) {
    news_.begin(feed.failure().message);
    retry_();
    return;
  }
  feed_ = std::move(*feed);
  news_.begin("the robot has sent no frame yet");
  feed_->send("{\"do\":\"subscribe\",\"types\":[\"state\"]}\n");
}

void StateFollower::feed_gone() {
  feed_.reset();
  news_.begin("the feed has ended");
  retry_();
}

}  // namespace cargobay::web
