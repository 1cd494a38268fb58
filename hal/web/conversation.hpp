// What goes on over one WebSocket, between a client and a feed (docs/feed.md). Knows neither
// sockets nor the clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace cargobay::web {

// The most that a client may send in one message, as with a request to the feed.
inline constexpr std::size_t kMostMessageBytes = 4096;

// Why a WebSocket is closed (RFC 6455, 7.4.1).
enum class CloseCode : std::uint16_t {
  going_away = 1001,    // the server ends
  unacceptable = 1003,  // binary where only text is understood
  policy = 1008,        // what is not a line
  too_big = 1009,
  restart = 1012,         // the feed went away: come again
  try_again_later = 1013  // the feed has too many clients
};
struct Ending {
  CloseCode code = CloseCode::going_away;
  std::string reason{};
};

struct Frame {
  std::string bytes{};
  bool is_binary = false;
};

class Conversation {
 public:
  virtual ~Conversation() = default;

  // A whole message of the client, at most kMostMessageBytes. If that ends it, why.
  virtual std::optional<Ending> hear(std::string_view message, bool is_binary) = 0;
  // A line of the feed, without its end. `unix_ns`: now.
  virtual void tell(std::string_view line, std::int64_t unix_ns) = 0;

  // What the client gets next; the owner sends and removes it.
  std::deque<Frame>& to_client() { return to_client_; }
  // What the feed gets next: lines with their ends.
  std::string& to_feed() { return to_feed_; }

 protected:
  Conversation() = default;
  void send(std::string text) { to_client_.push_back({.bytes = std::move(text)}); }
  void send_binary(std::string bytes) {
    to_client_.push_back({.bytes = std::move(bytes), .is_binary = true});
  }
  void request(std::string_view line) { (to_feed_ += line) += '\n'; }

 private:
  std::deque<Frame> to_client_{};
  std::string to_feed_{};
};

// `/api/feed`: the feed's own lines, each a message, both ways and unchanged.
class FeedConversation final : public Conversation {
 public:
  std::optional<Ending> hear(std::string_view message, bool is_binary) override;
  void tell(std::string_view line, std::int64_t unix_ns) override;
};

// Makes whole messages of what arrives in parts.
class MessageAssembly {
 public:
  // `is_last`: the message is whole with this. False if it is longer than kMostMessageBytes; what
  // there was of it is gone then.
  [[nodiscard]] bool add(std::string_view part, bool is_last);
  // Of a whole message; nothing before. It is taken, and the next one may begin.
  std::optional<std::string> take();

 private:
  std::string message_{};
  bool is_whole_ = false;
};

// Makes lines of the bytes of a feed.
class LineSplitter {
 public:
  // The longest that a feed would send is a world: its file has at most 1 MiB, and what is in it
  // takes less than four times as much as JSON.
  static constexpr std::size_t kMostLineBytes = std::size_t{8} << 20;

  // False if there is a line that does not end: this is no feed.
  [[nodiscard]] bool add(std::string_view bytes);
  // The next whole line, without its end. Valid until the next call.
  std::optional<std::string_view> next();

 private:
  std::string bytes_{};
  std::size_t begin_ = 0;  // of what has not been taken
};

}  // namespace cargobay::web
