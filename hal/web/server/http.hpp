// Requests and replies as libwebsockets has them.
#pragma once

#include <string>

#include "hal/web/gate.hpp"
#include "hal/web/site.hpp"

struct lws;

namespace cargobay::web {

// The headers of a request, copied; `view` refers to them.
struct ReceivedRequest {
  std::string path{};
  std::string token{};
  std::string host{};
  std::string origin{};
  std::string cookies{};
  std::string authorization{};
  bool is_get = false;   // or HEAD
  bool is_head = false;  // the reply has no body
  bool is_post = false;

  Request view(bool is_websocket) const;
};

// Of a request whose headers are complete.
ReceivedRequest received_request(lws* wsi);

// Writes all of it; what the socket does not take at once, the library keeps. False if the
// connection is of no more use.
bool send_reply(lws* wsi, const Reply& reply, bool is_head);

}  // namespace cargobay::web
