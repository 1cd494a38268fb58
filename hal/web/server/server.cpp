#include "hal/web/server/server.hpp"

#include <fcntl.h>
#include <libwebsockets.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

#include <openssl/ssl.h>

#include "hal/web/foxglove/foxglove_conversation.hpp"
#include "hal/web/server/bind_error.hpp"
#include "hal/web/server/http.hpp"
#include "hal/web/server/newest_state.hpp"
#include "hal/web/server/web_socket.hpp"

namespace cargobay::web {
namespace {

constexpr unsigned kMostDescriptors = 256;  // two for each WebSocket, and room for handshakes
constexpr lws_usec_t kRetryMicroseconds = 500 * LWS_US_PER_MS;
constexpr lws_usec_t kGoodbyeMicroseconds = 500 * LWS_US_PER_MS;
constexpr const char* kStopProtocol = "stop";

// With each reply. Nothing comes from elsewhere, and no other page may show this one.
constexpr auto kHeaders = std::to_array<std::pair<const char*, const char*>>({
    {"Content-Security-Policy:",
     "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'self'; "
     "frame-ancestors 'none'"},
    {"X-Content-Type-Options:", "nosniff"},
    {"Referrer-Policy:", "no-referrer"},
    {"Cross-Origin-Resource-Policy:", "same-origin"},
    {"Cross-Origin-Opener-Policy:", "same-origin"},
});

const lws_retry_bo_t kAliveness{.retry_ms_table = nullptr,
                                .retry_ms_table_count = 0,
                                .conceal_count = 0,
                                .secs_since_valid_ping = kPingSeconds,
                                .secs_since_valid_hangup = kDeadSeconds,
                                .jitter_percent = 0};

// The library takes others too.
bool is_version_13(lws* wsi) {
  std::array<char, 8> version{};
  return lws_hdr_copy(wsi, version.data(), static_cast<int>(version.size()), WSI_TOKEN_VERSION) >
             0 &&
         std::string_view{version.data()} == "13";
}

// What belongs to one connection of a client, in the memory that libwebsockets keeps for it, which
// begins as zeros.
struct Attached {
  std::string* body;  // of a log-in that is being received
  WebSocket* socket;
};

}  // namespace

struct Server::Parts {
  // So that a timer leads back here.
  struct Timer {
    lws_sorted_usec_list_t sul{};
    Parts* parts = nullptr;
  };

  explicit Parts(Options given)
      : options{std::move(given)},
        gate{options.policy},
        site{gate, [this] { return follower.newest(); }},
        follower{options.feed, [this] { retry_later(); }} {}
  ~Parts() {
    is_stopping = true;
    if (context != nullptr) lws_context_destroy(context);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  hal::Result<void> listen();
  hal::Result<void> watch(int stop);
  lws_context_creation_info creation_info();
  void retry_later() {
    if (!is_stopping) lws_sul_schedule(context, 0, &retry.sul, attach_again, kRetryMicroseconds);
  }
  static void attach_again(lws_sorted_usec_list_t* sul);

  static Parts& of(lws* wsi) {
    return *static_cast<Parts*>(lws_context_user(lws_get_context(wsi)));
  }
  template <bool kIsFoxglove>
  static int on_client(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);
  static int on_feed(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);
  static int on_stop(lws* wsi, lws_callback_reasons reason, void* user, void* in, size_t length);

  int on_http(lws* wsi, lws_callback_reasons reason, Attached& attached, std::string_view in);
  int on_web_socket(lws* wsi, lws_callback_reasons reason, Attached& attached, std::string_view in);
  int confirm_upgrade(lws* wsi) const;
  int answer(lws* wsi, Attached& attached) const;
  int log_in(lws* wsi, Attached& attached) const;
  void establish(lws* wsi, Attached& attached, std::unique_ptr<Conversation> conversation);

  static const std::array<lws_protocols, 6> kProtocols;

  Options options;
  Gate gate;
  Site site;
  StateFollower follower;
  Timer retry{.parts = this};
  std::array<lws_protocol_vhost_options, kHeaders.size()> headers{};
  lws_context* context = nullptr;
  lws_vhost* host = nullptr;
  std::vector<WebSocket*> sockets{};
  bool is_stopping = false;
};

// The first is that of HTTP, and of a WebSocket that asks for no protocol: /api/feed.
const std::array<lws_protocols, 6> Server::Parts::kProtocols{{
    {"http", on_client<false>, sizeof(Attached), 0, 0, nullptr, 0},
    {"foxglove.websocket.v1", on_client<true>, sizeof(Attached), 0, 0, nullptr, 0},
    {"foxglove.sdk.v1", on_client<true>, sizeof(Attached), 0, 0, nullptr, 0},
    {FeedLink::kProtocol, on_feed, 0, 0, 0, nullptr, 0},
    {kStopProtocol, on_stop, 0, 0, 0, nullptr, 0},
    {nullptr, nullptr, 0, 0, 0, nullptr, 0},
}};

void Server::Parts::attach_again(lws_sorted_usec_list_t* sul) {
  Parts& parts = *lws_container_of(sul, Timer, sul)->parts;
  parts.follower.attach(parts.host);
}

int Server::Parts::on_feed(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* /*in*/,
                           size_t /*length*/) {
  return FeedLink::callback(wsi, reason);
}

int Server::Parts::on_stop(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* /*in*/,
                           size_t /*length*/) {
  if (reason != LWS_CALLBACK_RAW_RX_FILE) return 0;
  of(wsi).is_stopping = true;
  return -1;  // it stays readable, and is not to keep the loop busy
}

template <bool kIsFoxglove>
int Server::Parts::on_client(lws* wsi, lws_callback_reasons reason, void* user, void* in,
                             size_t length) {
  if (reason == LWS_CALLBACK_HTTP_CONFIRM_UPGRADE) return of(wsi).confirm_upgrade(wsi);
  // CONNECT and the like.
  if (reason == LWS_CALLBACK_RAW_ADOPT || reason == LWS_CALLBACK_RAW_RX) return -1;
  if (reason == LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION) {
    // A Foxglove client at the feed, or the other way round.
    const bool is_at_foxglove = received_request(wsi).path == "/foxglove";
    return is_at_foxglove == kIsFoxglove ? 0 : -1;
  }
  if (user == nullptr) return 0;
  auto& attached = *static_cast<Attached*>(user);
  if (reason == LWS_CALLBACK_ESTABLISHED) {
    if constexpr (kIsFoxglove) {
      of(wsi).establish(wsi, attached, std::make_unique<FoxgloveConversation>());
    } else {
      of(wsi).establish(wsi, attached, std::make_unique<FeedConversation>());
    }
    return 0;
  }
  const std::string_view bytes{static_cast<const char*>(in), in == nullptr ? 0 : length};
  if (attached.socket != nullptr) return of(wsi).on_web_socket(wsi, reason, attached, bytes);
  return of(wsi).on_http(wsi, reason, attached, bytes);
}

int Server::Parts::on_web_socket(lws* wsi, lws_callback_reasons reason, Attached& attached,
                                 std::string_view in) {
  switch (reason) {
    case LWS_CALLBACK_RECEIVE: {
      const bool is_last =
          lws_is_final_fragment(wsi) != 0 && lws_remaining_packet_payload(wsi) == 0;
      return attached.socket->receive(in, is_last, lws_frame_is_binary(wsi) != 0);
    }
    case LWS_CALLBACK_SERVER_WRITEABLE: return attached.socket->write();
    case LWS_CALLBACK_CLOSED:
      std::erase(sockets, attached.socket);
      delete std::exchange(attached.socket, nullptr);
      return 0;
    default: return 0;
  }
}

void Server::Parts::establish(lws* wsi, Attached& attached,
                              std::unique_ptr<Conversation> conversation) {
  attached.socket = new WebSocket{wsi, std::move(conversation)};
  sockets.push_back(attached.socket);
  attached.socket->begin(options.feed);
}

int Server::Parts::on_http(lws* wsi, lws_callback_reasons reason, Attached& attached,
                           std::string_view in) {
  switch (reason) {
    case LWS_CALLBACK_HTTP: return answer(wsi, attached);
    case LWS_CALLBACK_HTTP_BODY:
      if (attached.body == nullptr || attached.body->size() + in.size() > kMostLogInBytes)
        return -1;
      *attached.body += in;
      return 0;
    case LWS_CALLBACK_HTTP_BODY_COMPLETION: return log_in(wsi, attached);
    case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
    case LWS_CALLBACK_CLOSED_HTTP: delete std::exchange(attached.body, nullptr); return 0;
    default: return 0;
  }
}

// Negative hangs up; positive: another reply has been sent.
int Server::Parts::confirm_upgrade(lws* wsi) const {
  // What the callback is given may have been freed by then if it is not `websocket`.
  std::array<char, 16> what{};
  if (lws_hdr_copy(wsi, what.data(), static_cast<int>(what.size()), WSI_TOKEN_UPGRADE) <= 0 ||
      strcasecmp(what.data(), "websocket") != 0)
    return -1;
  const ReceivedRequest request = received_request(wsi);
  Reply reply = site.upgrade(request.view(true));
  if (!request.is_get) reply = error_reply(405, "a WebSocket begins with GET");
  if (!is_version_13(wsi)) reply = error_reply(426, "the version of the WebSocket is 13");
  if (reply.status == 101 && sockets.size() >= kMostWebSockets)
    reply = error_reply(503, std::to_string(kMostWebSockets) + " clients are connected; close one");
  if (reply.status == 101) return 0;
  return send_reply(wsi, reply, request.is_head) ? 1 : -1;
}

int Server::Parts::answer(lws* wsi, Attached& attached) const {
  const ReceivedRequest request = received_request(wsi);
  if (request.is_post) {
    // Its headers are gone when the body is there, so it is decided now whether to read that.
    if (const auto refusal = site.refused_post(request.view(false))) {
      (void)send_reply(wsi, *refusal, false);
      return -1;
    }
    attached.body = new std::string;
    return 0;
  }
  const Reply reply =
      request.is_get ? site.get(request.view(false)) : error_reply(405, "GET, HEAD and POST only");
  if (!send_reply(wsi, reply, request.is_head)) return -1;
  return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
}

int Server::Parts::log_in(lws* wsi, Attached& attached) const {
  if (attached.body == nullptr) return -1;
  const Reply reply = site.log_in(*attached.body);
  delete std::exchange(attached.body, nullptr);
  if (!send_reply(wsi, reply, false)) return -1;
  return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
}

lws_context_creation_info Server::Parts::creation_info() {
  for (std::size_t i = 0; i < headers.size(); ++i) {
    headers[i] = {.next = i + 1 < headers.size() ? &headers[i + 1] : nullptr,
                  .options = nullptr,
                  .name = kHeaders[i].first,
                  .value = kHeaders[i].second};
  }
  lws_context_creation_info info{};
  const ListenAddress& address = options.policy.address;
  const bool is_ipv6 = address.host.find(':') != std::string::npos;
  info.iface = is_any(address.host) ? nullptr : address.host.c_str();
  info.port = address.port;
  info.protocols = kProtocols.data();
  info.headers = headers.data();
  info.user = this;
  info.vhost_name = "cargobay";
  info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_VALIDATE_UTF8 |
                 LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  if (!is_ipv6) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  info.max_http_header_data = kMostHeaderBytes;
  info.max_http_header_pool = kMostHandshakes;
  info.fd_limit_per_thread = kMostDescriptors;
  info.timeout_secs = kHandshakeSeconds;
  info.timeout_secs_ah_idle = kHandshakeSeconds;
  info.keepalive_timeout = kHandshakeSeconds;
  info.retry_and_idle_policy = &kAliveness;
  info.alpn = "http/1.1";
  if (!options.certificate.empty()) {
    info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    info.ssl_cert_filepath = options.certificate.c_str();
    info.ssl_private_key_filepath = options.certificate.c_str();
    info.ssl_options_set = SSL_OP_NO_TLSv1 | SSL_OP_NO_TLSv1_1 | SSL_OP_NO_RENEGOTIATION;
  }
  return info;
}

hal::Result<void> Server::Parts::listen() {
  lws_set_log_level(0, nullptr);
  lws_context_creation_info info = creation_info();
  context = lws_create_context(&info);
  if (context == nullptr) return hal::Failure{.message = "libwebsockets cannot be set up"};
  host = lws_create_vhost(context, &info);
  if (host == nullptr) {
    const ListenAddress& address = options.policy.address;
    const std::string why = bind_error(address);
    const std::string where = authority(address.host, address.port);
    if (why.empty() && !options.certificate.empty())
      return hal::Failure{.message = "--cert " + options.certificate +
                                     ": a PEM file with a certificate and its key is needed"};
    return hal::Failure{.message = "cannot listen on " + where + ": " + why};
  }
  options.policy.address.port = static_cast<std::uint16_t>(lws_get_vhost_listen_port(host));
  gate = Gate{options.policy};
  follower.attach(host);
  return {};
}

hal::Result<std::unique_ptr<Server>> Server::open(Options options) {
  auto parts = std::make_unique<Parts>(std::move(options));
  if (const auto listening = parts->listen(); !listening) return listening.failure();
  return std::unique_ptr<Server>{new Server{std::move(parts)}};
}

Server::Server(std::unique_ptr<Parts> parts) : parts_{std::move(parts)} {}
Server::~Server() = default;

const Gate& Server::gate() const { return parts_->gate; }

std::string Server::url() const {
  const Gate::Policy& policy = parts_->gate.policy();
  return (policy.is_encrypted ? "https://" : "http://") +
         authority(link_host(policy.address), policy.address.port);
}

// The loop closes its own copy of the descriptor.
hal::Result<void> Server::Parts::watch(int stop) {
  lws_sock_file_fd_type descriptor{};
  descriptor.filefd = fcntl(stop, F_DUPFD_CLOEXEC, 0);
  if (descriptor.filefd < 0 || lws_adopt_descriptor_vhost(host, LWS_ADOPT_RAW_FILE_DESC, descriptor,
                                                          kStopProtocol, nullptr) == nullptr)
    return hal::Failure{.message = "no descriptor is left"};
  return {};
}

hal::Result<void> Server::run(int stop) {
  Parts& parts = *parts_;
  if (auto watching = parts.watch(stop); !watching) return watching;
  while (!parts.is_stopping && lws_service(parts.context, 0) >= 0) {
  }
  for (WebSocket* const socket : parts.sockets)
    socket->end({.code = CloseCode::going_away, .reason = "the server ends"});
  lws_sorted_usec_list_t wake{};
  lws_sul_schedule(
      parts.context, 0, &wake, [](lws_sorted_usec_list_t* /*sul*/) {}, kGoodbyeMicroseconds);
  const lws_usec_t deadline = lws_now_usecs() + kGoodbyeMicroseconds;
  while (!parts.sockets.empty() && lws_now_usecs() < deadline &&
         lws_service(parts.context, 0) >= 0) {
  }
  lws_sul_schedule(parts.context, 0, &wake, nullptr, LWS_SET_TIMER_USEC_CANCEL);
  return {};
}

}  // namespace cargobay::web
