#include "hal/cli/attached/feed_news.hpp"

#include <utility>
#include <variant>

#include <fmt/format.h>

namespace cargobay::cli {
namespace {

namespace heard = hal::heard;

// Puts what one message says where it is shown.
struct Taking {
  FeedNews& news;
  std::int64_t unix_ns = 0;

  void operator()(heard::Hello& hello) const { news.hello = std::move(hello); }
  void operator()(heard::Status& status) const {
    if (!status.stage) return;
    news.stage = std::move(*status.stage);
    news.text = std::move(status.text);
  }
  void operator()(const hal::StateRecord& record) const {
    news.state = record.state;
    news.state_unix_ns = unix_ns;
  }
  void operator()(const heard::Sensors& sensors) const { news.sensors = sensors; }
  void operator()(const heard::Event& event) const {
    news.events.push_back(fmt::format("{:8.3f} s  {}", event.robot_time_s, event.text));
    if (news.events.size() > FeedNews::kMostEvents) news.events.pop_front();
  }
  void operator()(heard::Statistics& statistics) const { news.statistics = std::move(statistics); }
  void operator()(const heard::Truth& truth) const { news.truth = truth; }
  void operator()(heard::Holder& holder) const {
    news.holder = std::move(holder.name).value_or("");
    news.lease = holder.lease;
  }
  void operator()(const heard::Missed& missed) const { news.missed += missed.messages; }
  void operator()(heard::Answer& answer) const { news.answer = std::move(answer); }
  void operator()(const heard::World& /*world*/) const {}
  void operator()(const heard::Other& /*other*/) const {}
};

}  // namespace

std::optional<hal::FeedType> FeedNews::hear(std::string_view line) {
  auto message = hal::read_message(line);
  if (!message) return std::nullopt;
  std::visit(Taking{.news = *this, .unix_ns = message->unix_ns}, message->what);
  return message->type;
}

}  // namespace cargobay::cli
