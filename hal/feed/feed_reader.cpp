#include "hal/feed/feed_reader.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <variant>
#include <vector>

#include "hal/feed/feed_place.hpp"
#include "hal/feed/message/reading.hpp"
#include "hal/file/unix_listener.hpp"

namespace cargobay::hal {

namespace {

constexpr rt::Duration kTimeToGreet = std::chrono::seconds{1};

Failure no_such_feed(const std::string& what, const std::vector<FoundFeed>& feeds) {
  std::string there;
  for (const FoundFeed& feed : feeds) (there += there.empty() ? "" : ", ") += feed.name;
  return {.message = what + (there.empty() ? "; nothing publishes a feed here: start "
                                             "`cargobay serve` or `cargobay drive`"
                                           : "; there are feeds of " + there),
          .code = std::make_error_code(std::errc::no_such_device)};
}

// Not by std::filesystem::equivalent(), which compares no devices.
bool lead_to_one_file(const std::string& one, const std::string& other) {
  std::error_code error;
  const auto real = std::filesystem::canonical(one, error);
  return !error && real == std::filesystem::canonical(other, error) && !error;
}

// Whether the descriptor is ready by then.
bool wait_for(int descriptor, short events, rt::TimePoint deadline) {
  for (;;) {
    pollfd one{.fd = descriptor, .events = events, .revents = 0};
    const timespec timeout =
        rt::as_timespec(std::max(deadline - rt::Clock::now(), rt::Duration::zero()));
    const int ready = ppoll(&one, 1, &timeout, nullptr);
    if (ready >= 0) return ready > 0;
    if (errno != EINTR) return false;
    if (rt::Clock::now() >= deadline) return false;
  }
}

}  // namespace

Result<FeedReader> FeedReader::attach_to(const std::string& socket_path) {
  Descriptor socket = connect_to(socket_path);
  if (socket.number() < 0) {
    const std::error_code code{errno, std::generic_category()};
    return Failure{.message = "cannot attach to " + socket_path + ": " + code.message() +
                              "; run this as the user who drives, or try again in a moment",
                   .code = code};
  }
  if (!is_trusted_peer(socket.number(), socket_path)) {
    return Failure{.message = socket_path +
                              " belongs to another user's process, which is not trusted; "
                              "run this as that user, or drive as yourself",
                   .code = std::make_error_code(std::errc::permission_denied)};
  }
  return FeedReader{socket_path, std::move(socket)};
}

bool FeedReader::publishes(const std::string& socket_path, const std::string& port) {
  auto reader = attach_to(socket_path);
  if (!reader) return false;
  const auto first = reader->next(rt::Clock::now() + kTimeToGreet);
  if (!first || !*first) return false;
  const std::optional<HeardMessage> heard = read_message(**first);
  const auto* const hello = heard ? std::get_if<heard::Hello>(&heard->what) : nullptr;
  return hello != nullptr && lead_to_one_file(hello->port, port);
}

Result<FeedReader> FeedReader::attach(const std::string& port) {
  struct stat status{};
  if (!port.empty() && stat(port.c_str(), &status) == 0 && S_ISSOCK(status.st_mode))
    return attach_to(port);
  const std::vector<FoundFeed> feeds = find_feeds();
  if (port.empty()) {
    if (feeds.size() == 1) return attach_to(feeds.front().socket);
    return no_such_feed(feeds.empty() ? "no feed" : "name one of the feeds by its port", feeds);
  }
  auto found = std::ranges::find(feeds, feed_name(port), &FoundFeed::name);
  if (found == feeds.end()) {
    found = std::ranges::find_if(
        feeds, [&](const FoundFeed& feed) { return publishes(feed.socket, port); });
  }
  if (found == feeds.end()) return no_such_feed("no feed of " + port, feeds);
  return attach_to(found->socket);
}

Failure FeedReader::ended() const {
  return {.message = "the feed at " + path_ + " has ended",
          .code = std::make_error_code(std::errc::connection_reset)};
}

Result<std::optional<std::string>> FeedReader::next(rt::TimePoint deadline) {
  for (;;) {
    if (const std::size_t end = received_.find('\n', begin_); end != std::string::npos) {
      std::string line = received_.substr(begin_, end - begin_);
      begin_ = end + 1;
      return std::optional{std::move(line)};
    }
    received_.erase(0, std::exchange(begin_, 0));
    std::array<char, std::size_t{1} << 14U> bytes{};
    const ssize_t count = recv(socket_.number(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count == 0) return ended();
    if (count > 0) {
      received_.append(bytes.data(), static_cast<std::size_t>(count));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN) return ended();
    if (!wait_for(socket_.number(), POLLIN, deadline)) return std::optional<std::string>{};
  }
}

Result<void> FeedReader::ask(std::string_view request) {
  std::string line{request};
  line += '\n';
  const rt::TimePoint deadline = rt::Clock::now() + std::chrono::seconds{1};
  for (std::string_view rest = line; !rest.empty();) {
    const ssize_t count =
        send(socket_.number(), rest.data(), rest.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count >= 0) {
      rest.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN) {
      if (!wait_for(socket_.number(), POLLOUT, deadline)) return ended();
    } else if (errno != EINTR) {
      return ended();
    }
  }
  return {};
}

}  // namespace cargobay::hal
