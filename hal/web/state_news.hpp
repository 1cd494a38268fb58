// The newest state of the robot, as a feed tells it, for who asks once. Knows neither sockets nor
// the clock.
#pragma once

#include <string>
#include <string_view>

namespace cargobay::web {

// A state, a JSON object, or why there is none.
struct NewestState {
  std::string json{};
  std::string reason{};  // if `json` is empty
};

// One thread.
class StateNews {
 public:
  // The feed has been reached, or has not, or is gone: nothing is known yet, for this reason.
  void begin(std::string reason);
  // A line of the feed. What a loop said that has ended since is not the state of anything.
  void hear(std::string_view line);
  NewestState newest() const { return {.json = state_, .reason = reason_}; }

 private:
  std::string state_{};
  std::string reason_ = "not attached to the feed yet";
  bool is_driving_ = false;
};

}  // namespace cargobay::web
