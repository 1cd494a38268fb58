// Who is let in: decided from the headers of a request alone, before anything else is done with it.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/web/address.hpp"

namespace cargobay::web {

// What a request says. Borrowed; a header that is missing is empty.
struct Request {
  bool is_post = false;
  bool is_websocket = false;
  std::string_view path{};   // decoded, without the query
  std::string_view token{};  // `token` of the query
  std::string_view host{};
  std::string_view origin{};
  std::string_view cookies{};
  std::string_view authorization{};
};

enum class Verdict : std::uint8_t {
  welcome,
  wrong_host,    // not a name of this server: a page elsewhere has its name lead here (rebinding)
  wrong_origin,  // sent by a page of another server
  no_token,
};

class Gate {
 public:
  struct Policy {
    ListenAddress address{};  // with the port that was got
    bool is_encrypted = false;
    std::string token{};                 // empty: none is asked for
    std::vector<std::string> names{};    // in lower case, beside numeric addresses and localhost
    std::vector<std::string> origins{};  // of other pages that may come in: `https://a.b`
  };

  explicit Gate(Policy policy) : policy_{std::move(policy)} {}

  // All but the token is checked for each request; the token not for what needs none, by its path.
  Verdict check(const Request& request) const;
  // As for a request that brings `token`; for a log-in.
  bool knows(std::string_view token) const;

  // `Set-Cookie` for who has brought the token. The port is in its name, since browsers give one
  // server's cookies to all of its ports.
  std::string cookie_header() const;

  const Policy& policy() const { return policy_; }

 private:
  bool is_served(std::string_view header) const;
  bool is_own(std::string_view origin, std::string_view host) const;
  bool has_token(const Request& request) const;
  std::string cookie_name() const;

  Policy policy_;
};

// The host of a Host header, without its port and brackets, in lower case; empty if it is none.
std::string host_of(std::string_view header);

// Pages that say nothing of the robot and are needed to log in.
bool is_public(std::string_view path);

}  // namespace cargobay::web
