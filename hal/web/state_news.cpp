#include "hal/web/state_news.hpp"

#include <utility>
#include <variant>

#include "hal/feed/message/reading.hpp"

namespace cargobay::web {

void StateNews::begin(std::string reason) {
  state_.clear();
  reason_ = std::move(reason);
  is_driving_ = false;
}

void StateNews::hear(std::string_view line) {
  const auto message = hal::read_message(line);
  if (!message) return;
  if (const auto* const status = std::get_if<hal::heard::Status>(&message->what)) {
    begin(status->text.empty() ? "no loop drives the robot now" : status->text);
    is_driving_ = status->stage == "driving";
    if (is_driving_) reason_ = "the robot has sent no frame yet";
  }
  if (message->type == hal::FeedType::state && is_driving_) state_ = line;
}

}  // namespace cargobay::web
