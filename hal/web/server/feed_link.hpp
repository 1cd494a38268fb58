// A connection to the feed's socket, served by the event loop of libwebsockets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "hal/result.hpp"
#include "hal/web/conversation.hpp"

struct lws;
struct lws_vhost;

namespace cargobay::web {

// Who a connection tells. Called on the thread of the loop.
class FeedListener {
 public:
  virtual ~FeedListener() = default;
  virtual void line(std::string_view line) = 0;
  virtual void feed_gone() = 0;      // once; the connection may be destroyed then
  virtual bool has_enough() = 0;     // after some lines: reading stops until resume()
  virtual void feed_has_room() = 0;  // again, after is_congested()
};

// One thread, that of the loop. Allocates for what waits.
class FeedLink {
 public:
  // Attaches to the feed of a port, to a socket, or to the only feed if that is empty, without
  // blocking. The listener outlives it.
  static hal::Result<std::unique_ptr<FeedLink>> open(lws_vhost* host, const std::string& feed,
                                                     FeedListener& listener);
  // Closes it at once; tells nobody.
  ~FeedLink();
  FeedLink(const FeedLink&) = delete;
  FeedLink& operator=(const FeedLink&) = delete;

  // Whole lines, with their ends. What the feed does not take at once waits.
  void send(std::string_view lines);
  bool is_congested() const { return waiting_.size() > kMostWaitingBytes; }
  void resume();

  // The callback of the protocol `feed`, for Server.
  static int callback(lws* wsi, int reason);
  static constexpr const char* kProtocol = "feed";

 private:
  static constexpr std::size_t kMostWaitingBytes = std::size_t{16} << 10;

  explicit FeedLink(FeedListener& listener) : listener_{listener} {}
  int read();
  int write();
  void lost();

  FeedListener& listener_;
  lws* wsi_ = nullptr;  // the loop's; null once it is closed
  LineSplitter lines_{};
  std::string waiting_{};
};

}  // namespace cargobay::web
