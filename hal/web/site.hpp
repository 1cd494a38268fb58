// What is answered to a request for a page or the state. Knows no sockets.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/web/gate.hpp"
#include "hal/web/state_news.hpp"

namespace cargobay::web {

// The most that a log-in may have.
inline constexpr std::size_t kMostLogInBytes = 512;

struct Reply {
  unsigned status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body{};
  std::vector<std::pair<std::string, std::string>> headers{};  // beside those of each reply
};

class Site {
 public:
  // Borrows the gate, which outlives it.
  Site(const Gate& gate, std::function<NewestState()> state)
      : gate_{gate}, state_{std::move(state)} {}

  Reply get(const Request& request) const;
  // Of a POST before its body is read: what is said instead of reading it, if anything.
  std::optional<Reply> refused_post(const Request& request) const;
  // To a POST that was not refused. `body`: of a form with a field `token`, or the token alone.
  Reply log_in(std::string_view body) const;
  // For a WebSocket: status 101 if it may begin, else what is said instead.
  Reply upgrade(const Request& request) const;

 private:
  Reply refusal(const Request& request, Verdict verdict) const;
  Reply state() const;

  const Gate& gate_;
  std::function<NewestState()> state_;
};

Reply error_reply(unsigned status, std::string_view text);

}  // namespace cargobay::web
