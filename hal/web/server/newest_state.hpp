// The newest state of the robot, for who asks once. Attaches to the feed, and again when that is
// gone.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "hal/web/server/feed_link.hpp"
#include "hal/web/site.hpp"

namespace cargobay::web {

// One thread, that of the loop.
class StateFollower final : public FeedListener {
 public:
  // `retry` is called when the feed could not be reached or went away: attach() again later.
  StateFollower(std::string feed, std::function<void()> retry)
      : which_{std::move(feed)}, retry_{std::move(retry)} {}

  void attach(lws_vhost* host);
  NewestState newest() const;

  void line(std::string_view line) override;
  void feed_gone() override;
  bool has_enough() override { return false; }
  void feed_has_room() override {}

 private:
  std::string which_;
  std::function<void()> retry_;
  std::unique_ptr<FeedLink> feed_{};
  std::string state_{};
  std::string reason_ = "not attached to the feed yet";
};

}  // namespace cargobay::web
