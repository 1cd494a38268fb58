#include "hal/web/conversation.hpp"

#include <algorithm>

namespace cargobay::web {

std::optional<Ending> FeedConversation::hear(std::string_view message, bool is_binary) {
  if (is_binary) return Ending{.code = CloseCode::unacceptable, .reason = "requests are text"};
  // Would be several requests, or part of one. JSON needs none of these.
  if (std::ranges::any_of(message, [](unsigned char c) { return c < ' '; }))
    return Ending{.code = CloseCode::policy, .reason = "a request is one line"};
  if (!message.empty()) request(message);
  return std::nullopt;
}

void FeedConversation::tell(std::string_view line, std::int64_t /*unix_ns*/) {
  send(std::string{line});
}

bool MessageAssembly::add(std::string_view part, bool is_last) {
  if (is_whole_) message_.clear();
  is_whole_ = false;
  if (message_.size() + part.size() > kMostMessageBytes) {
    message_.clear();
    return false;
  }
  message_ += part;
  is_whole_ = is_last;
  return true;
}

std::optional<std::string> MessageAssembly::take() {
  if (!is_whole_) return std::nullopt;
  is_whole_ = false;
  return std::exchange(message_, {});
}

bool LineSplitter::add(std::string_view bytes) {
  bytes_.erase(0, begin_);
  begin_ = 0;
  bytes_ += bytes;
  const std::size_t last_end = bytes_.rfind('\n');
  const std::size_t rest =
      last_end == std::string::npos ? bytes_.size() : bytes_.size() - last_end - 1;
  return rest <= kMostLineBytes;
}

std::optional<std::string_view> LineSplitter::next() {
  const std::size_t end = bytes_.find('\n', begin_);
  if (end == std::string::npos) return std::nullopt;
  const std::string_view line = std::string_view{bytes_}.substr(begin_, end - begin_);
  begin_ = end + 1;
  return line;
}

}  // namespace cargobay::web
