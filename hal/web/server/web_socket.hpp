// One WebSocket of a client, and the connection to the feed that is its own: dropping what a slow
// client does not take, and the lease of one that goes away, are the feed's.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "hal/web/conversation.hpp"
#include "hal/web/server/feed_link.hpp"

struct lws;

namespace cargobay::web {

// One thread, that of the loop.
class WebSocket final : public FeedListener {
 public:
  WebSocket(lws* wsi, std::unique_ptr<Conversation> conversation)
      : wsi_{wsi}, conversation_{std::move(conversation)} {}

  // Opens the feed; if there is none, ends.
  void begin(const std::string& feed);
  // Some bytes of a message; -1 to close the WebSocket, with its reason set.
  int receive(std::string_view part, bool is_last, bool is_binary);
  // Sends what the client's socket takes; -1 likewise.
  int write();
  // Closes it as soon as what is being sent is gone, or in 2 s.
  void end(Ending ending);

  void line(std::string_view line) override;
  void feed_gone() override;
  bool has_enough() override;
  void feed_has_room() override;

 private:
  int close() const;
  void after_hearing();
  std::size_t waiting_bytes() const;

  lws* wsi_;
  std::unique_ptr<Conversation> conversation_;
  std::unique_ptr<FeedLink> feed_{};
  MessageAssembly message_{};
  std::optional<Ending> ending_{};
  bool is_deaf_ = false;  // reads nothing of the client until there is room
};

}  // namespace cargobay::web
