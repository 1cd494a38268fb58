// Attaches to the feed for the newest state, and again when that is gone.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "hal/web/server/feed_link.hpp"
#include "hal/web/state_news.hpp"

namespace cargobay::web {

// One thread, that of the loop.
class StateFollower final : public FeedListener {
 public:
  // `retry` is called when the feed could not be reached or went away: attach() again later.
  StateFollower(std::string feed, std::function<void()> retry)
      : which_{std::move(feed)}, retry_{std::move(retry)} {}

  void attach(lws_vhost* host);
  NewestState newest() const { return news_.newest(); }

  void line(std::string_view line) override { news_.hear(line); }
  void feed_gone() override;
  bool has_enough() override { return false; }
  void feed_has_room() override {}

 private:
  std::string which_;
  std::function<void()> retry_;
  std::unique_ptr<FeedLink> feed_{};
  StateNews news_{};
};

}  // namespace cargobay::web
