#include "hal/web/server/http.hpp"

#include <libwebsockets.h>

#include <array>
#include <cstring>
#include <vector>

#include "hal/web/server/server.hpp"
#include "hal/web/token.hpp"

namespace cargobay::web {
namespace {

std::string header(lws* wsi, lws_token_indexes token) {
  const int length = lws_hdr_total_length(wsi, token);
  if (length <= 0) return {};
  std::vector<char> text(static_cast<std::size_t>(length) + 1);
  if (lws_hdr_copy(wsi, text.data(), length + 1, token) < 0) return {};
  return {text.data(), static_cast<std::size_t>(length)};
}

std::string token_argument(lws* wsi) {
  std::array<char, kMostTokenLength + 1> text{};
  const char* const found =
      lws_get_urlarg_by_name(wsi, "token=", text.data(), static_cast<int>(text.size()));
  return found == nullptr ? std::string{} : std::string{found};
}

// Writes headers into a buffer that is large enough for all of ours.
class HeaderWriter {
 public:
  explicit HeaderWriter(lws* wsi) : wsi_{wsi} {}
  void status(unsigned code) {
    ok_ = ok_ && lws_add_http_header_status(wsi_, code, &at_, end_) == 0;
  }
  void add(const std::string& name, const std::string& value) {
    const std::string with_colon = name + ":";
    ok_ = ok_ && lws_add_http_header_by_name(
                     wsi_, reinterpret_cast<const unsigned char*>(with_colon.c_str()),
                     reinterpret_cast<const unsigned char*>(value.data()),
                     static_cast<int>(value.size()), &at_, end_) == 0;
  }
  void length(std::size_t bytes) {
    ok_ = ok_ && lws_add_http_header_content_length(wsi_, bytes, &at_, end_) == 0;
  }
  // With the body behind it.
  bool write(const std::string& body) {
    if (!ok_ || lws_finalize_http_header(wsi_, &at_, end_) != 0) return false;
    const auto headers = static_cast<std::size_t>(at_ - bytes_.data());
    bytes_.resize(headers + body.size());
    std::memcpy(bytes_.data() + headers, body.data(), body.size());
    return lws_write(wsi_, bytes_.data() + LWS_PRE, bytes_.size() - LWS_PRE, LWS_WRITE_HTTP) >= 0;
  }

 private:
  static constexpr std::size_t kRoom = 4096;

  lws* wsi_;
  std::vector<unsigned char> bytes_ = std::vector<unsigned char>(LWS_PRE + kRoom);
  unsigned char* at_ = bytes_.data() + LWS_PRE;
  unsigned char* end_ = bytes_.data() + bytes_.size();
  bool ok_ = true;
};

}  // namespace

Request ReceivedRequest::view(bool is_websocket) const {
  return {.is_post = is_post,
          .is_websocket = is_websocket,
          .path = path,
          .token = token,
          .host = host,
          .origin = origin,
          .cookies = cookies,
          .authorization = authorization};
}

ReceivedRequest received_request(lws* wsi) {
  ReceivedRequest request{.token = token_argument(wsi),
                          .host = header(wsi, WSI_TOKEN_HOST),
                          .origin = header(wsi, WSI_TOKEN_ORIGIN),
                          .cookies = header(wsi, WSI_TOKEN_HTTP_COOKIE),
                          .authorization = header(wsi, WSI_TOKEN_HTTP_AUTHORIZATION)};
  request.is_post = lws_hdr_total_length(wsi, WSI_TOKEN_POST_URI) > 0;
  request.is_head = lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0;
  request.is_get = request.is_head || lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) > 0;
  request.path = header(wsi, request.is_post   ? WSI_TOKEN_POST_URI
                             : request.is_head ? WSI_TOKEN_HEAD_URI
                                               : WSI_TOKEN_GET_URI);
  return request;
}

bool send_reply(lws* wsi, const Reply& reply, bool is_head) {
  // Nothing that one page downloads takes longer on a line on which the page is of any use.
  constexpr int kSeconds = 30;
  HeaderWriter headers{wsi};
  headers.status(reply.status);
  headers.add("Content-Type", reply.type);
  for (const auto& [name, value] : reply.headers) headers.add(name, value);
  headers.length(reply.body.size());
  lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, kSeconds);
  return headers.write(is_head ? std::string{} : reply.body);
}

}  // namespace cargobay::web
