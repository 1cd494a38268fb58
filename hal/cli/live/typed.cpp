#include "hal/cli/live/typed.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>

#include <fmt/format.h>

namespace cargobay::cli {
namespace {

// Reading from the terminal of another job suspends a process.
bool is_our_terminal() { return isatty(STDIN_FILENO) == 1 && tcgetpgrp(STDIN_FILENO) == getpgrp(); }

hal::Failure ended(const FeedNews& news) {
  return {fmt::format("{} has ended: {}", news.hello.program, news.text)};
}

}  // namespace

bool keys_can_come() { return isatty(STDIN_FILENO) == 1; }

std::string typed() {
  if (!is_our_terminal()) return {};
  pollfd one{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (poll(&one, 1, 0) != 1 || (one.revents & POLLIN) == 0) return {};
  std::array<char, 256> bytes{};
  const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
  return {bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
}

void wait_for_input(const hal::FeedReader& reader, int other, rt::TimePoint until) {
  std::array<pollfd, 3> waited{
      {{.fd = reader.descriptor(), .events = POLLIN, .revents = 0},
       {.fd = is_our_terminal() ? STDIN_FILENO : -1, .events = POLLIN, .revents = 0},
       {.fd = other, .events = POLLIN, .revents = 0}}};
  const timespec timeout =
      rt::as_timespec(std::max(until - rt::Clock::now(), rt::Duration::zero()));
  (void)ppoll(waited.data(), waited.size(), &timeout, nullptr);  // at a signal: sooner
}

hal::Result<void> take_news(hal::FeedReader& reader, FeedNews& news,
                            const std::function<void(hal::FeedType)>& see) {
  for (;;) {
    const auto line = reader.next(rt::TimePoint{});
    if (!line) return news.text.empty() ? line.failure() : ended(news);
    if (!*line) break;
    const auto type = news.hear(**line);  // what is not known is not shown
    if (type && see) see(*type);
  }
  return news.stage == "ended" ? ended(news) : hal::Result<void>{};
}

}  // namespace cargobay::cli
