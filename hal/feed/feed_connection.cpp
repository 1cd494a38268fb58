#include "hal/feed/feed_connection.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/uio.h>

#include <algorithm>
#include <cerrno>

namespace cargobay::hal {

namespace {

// Goes first when there is no room: the next one says the same and more.
bool is_reading(FeedType type) {
  return type == FeedType::state || type == FeedType::sensors || type == FeedType::truth ||
         type == FeedType::statistics || type == FeedType::virtual_create;
}

bool comes_every_tick(FeedType type) {
  return type == FeedType::state || type == FeedType::sensors || type == FeedType::truth;
}

}  // namespace

short FeedConnection::events() const {
  return static_cast<short>(waiting_.empty() ? POLLIN : POLLIN | POLLOUT);
}

void FeedConnection::choose(const FeedChoice& choice) {
  choice_ = choice;
  for (std::uint32_t& passed : passed_) passed %= choice_.every;
}

std::uint64_t FeedConnection::pass(FeedType type, std::uint64_t count) {
  if (type == FeedType::hello || type == FeedType::answer) return count;
  if (!wants(type)) return 0;
  if (!comes_every_tick(type)) return count;
  std::uint32_t& passed = passed_[static_cast<std::size_t>(type)];
  const std::uint64_t every = choice_.every;
  const std::uint64_t before_due = passed == 0 ? 0 : every - passed;
  passed = static_cast<std::uint32_t>((passed + count % every) % every);
  return count <= before_due ? 0 : (count - before_due - 1) / every + 1;
}

void FeedConnection::put(const FeedMessage& message) {
  if (pass(message.type, 1) == 0) return;
  waiting_.push_back(message);
  waiting_bytes_ += message.line->size();
  while (waiting_bytes_ > kMostBytes && waiting_.size() > 1) make_room();
}

void FeedConnection::lose(FeedType type, std::uint64_t count) {
  const std::uint64_t chosen = pass(type, count);
  untold_ += chosen;
  missed_ += chosen;
}

void FeedConnection::make_room() {
  // What the reader has got half of it gets whole.
  const auto first = waiting_.begin() + (sent_of_first_ > 0 ? 1 : 0);
  auto oldest = std::find_if(first, waiting_.end(),
                             [](const FeedMessage& each) { return is_reading(each.type); });
  if (oldest == waiting_.end()) {
    oldest = std::find_if(first, waiting_.end(), [](const FeedMessage& each) {
      return each.type != FeedType::answer && each.type != FeedType::hello;
    });
  }
  if (oldest == waiting_.end()) oldest = first;
  waiting_bytes_ -= oldest->line->size();
  waiting_.erase(oldest);
  ++untold_;
  ++missed_;
}

// In front of all that waits: what is missing was before that, or among it.
void FeedConnection::tell_missed() {
  if (untold_ == 0 || sent_of_first_ > 0) return;
  JsonObject object;
  object.text("type", name(FeedType::missed)).number("messages", untold_);
  auto line = std::make_shared<const std::string>(object.take() + "\n");
  waiting_bytes_ += line->size();
  waiting_.push_front({.type = FeedType::missed, .line = std::move(line)});
  untold_ = 0;
}

bool FeedConnection::flush() {
  while (!waiting_.empty()) {
    tell_missed();
    constexpr std::size_t kAtOnce = 16;
    std::array<iovec, kAtOnce> parts{};
    std::size_t count = 0;
    for (; count < std::min(kAtOnce, waiting_.size()); ++count) {
      const std::string& line = *waiting_[count].line;
      const std::size_t skipped = count == 0 ? sent_of_first_ : 0;
      // sendmsg() only reads.
      parts[count] = {.iov_base = const_cast<char*>(line.data()) + skipped,
                      .iov_len = line.size() - skipped};
    }
    msghdr header{};
    header.msg_iov = parts.data();
    header.msg_iovlen = count;
    const ssize_t bytes = sendmsg(socket_.number(), &header, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes < 0) return errno == EAGAIN;
    sent(static_cast<std::size_t>(bytes));
  }
  return true;
}

void FeedConnection::sent(std::size_t bytes) {
  bytes += sent_of_first_;
  while (!waiting_.empty() && bytes >= waiting_.front().line->size()) {
    const std::size_t size = waiting_.front().line->size();
    bytes -= size;
    waiting_bytes_ -= size;
    waiting_.pop_front();
  }
  sent_of_first_ = bytes;
}

bool FeedConnection::receive(const std::function<void(std::string_view line)>& hear) {
  std::array<char, kLongestLine> bytes{};
  const ssize_t count = recv(socket_.number(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (count < 0) return errno == EAGAIN || errno == EINTR;
  if (count == 0) return false;
  received_.append(bytes.data(), static_cast<std::size_t>(count));
  std::size_t begin = 0;
  for (std::size_t end = received_.find('\n'); end != std::string::npos;
       end = received_.find('\n', begin)) {
    hear(std::string_view{received_}.substr(begin, end - begin));
    begin = end + 1;
  }
  received_.erase(0, begin);
  return received_.size() <= kLongestLine;
}

}  // namespace cargobay::hal
