#include "hal/cli/live/steering.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "hal/json_object.hpp"

namespace cargobay::cli {
namespace {

constexpr std::string_view kHoldId = R"("hold")";

// For people. Another machine, or a container, may have one that is the same.
std::string own_name() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) host[0] = '\0';
  constexpr std::size_t kLongestHost = 32;
  const std::string_view name{host.data()};
  return fmt::format("teleop on {} ({})", name.substr(0, kLongestHost), getpid());
}

}  // namespace

Steering::Steering(hal::FeedReader& reader, FeedNews& news)
    : reader_{reader}, news_{news}, name_{own_name()} {}

hal::Result<void> Steering::hold(bool take) {
  hal::JsonObject request;
  request.text("do", "hold").raw("id", std::string{kHoldId}).text("name", name_);
  if (take) request.truth("take", true);
  return reader_.ask(request.take());
}

hal::Result<void> Steering::begin(bool take) {
  const rt::TimePoint deadline = rt::Clock::now() + std::chrono::seconds{2};
  bool asked = false;
  while (rt::Clock::now() < deadline) {
    const auto line = reader_.next(deadline);
    if (!line) return line.failure();
    if (!*line) break;
    const auto type = news_.hear(**line);
    if (!type) continue;
    hear(*type);
    if (type == hal::FeedType::hello && !news_.hello.steerable) {
      return hal::Failure{fmt::format(
          "{} (process {}) drives {} by itself and cannot be steered; end it and run this again, "
          "or start `cargobay serve --port {}` in its place",
          news_.hello.program, news_.hello.process, news_.hello.port, news_.hello.port)};
    }
    if (type == hal::FeedType::hello && !asked) {
      if (const auto sent = hold(take); !sent) return sent;
      asked = true;
    }
    if (type != hal::FeedType::answer || news_.answer.id != kHoldId) continue;
    if (holds_) return {};
    if (news_.holder.empty()) return hal::Failure{news_.answer.error};
    return hal::Failure{news_.holder + " steers; --take takes it from them"};
  }
  return hal::Failure{"the feed at " + reader_.path() + " does not answer"};
}

hal::Result<void> Steering::ask_again(bool take) { return hold(take); }

void Steering::hear(hal::FeedType type) {
  if (type == hal::FeedType::holder) holds_ = holds_ && news_.lease == lease_;
  if (type != hal::FeedType::answer) return;
  if (news_.answer.id == kHoldId) {
    holds_ = news_.answer.ok;
    lease_ = news_.answer.lease;
  }
  complaint_ = news_.answer.ok ? "" : news_.answer.error;
  complained_ = rt::Clock::now();
}

std::string Steering::complaint(rt::TimePoint now) const {
  return now - complained_ < std::chrono::seconds{1} ? complaint_ : std::string{};
}

hal::Result<void> Steering::steer(const rt::WheelSpeeds& speeds, rt::TimePoint now) {
  if (!holds_ || (speeds == sent_ && now < next_)) return {};
  sent_ = speeds;
  next_ = now + kEvery;
  hal::JsonObject request;
  request.text("do", "drive")
      .number("left_mm_s", speeds.left_mm_s)
      .number("right_mm_s", speeds.right_mm_s);
  return reader_.ask(request.take());
}

hal::Result<void> Steering::stop() { return reader_.ask(R"({"do":"stop","id":"stop"})"); }
hal::Result<void> Steering::rearm() { return reader_.ask(R"({"do":"rearm","id":"rearm"})"); }

void Steering::end() {
  if (holds_) (void)reader_.ask(R"({"do":"release"})");  // if not, its lapse stops the robot
  holds_ = false;
}

}  // namespace cargobay::cli
