#include "hal/web/server/feed_link.hpp"

#include <fcntl.h>
#include <libwebsockets.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "hal/feed/feed_reader.hpp"

namespace cargobay::web {
hal::Result<std::unique_ptr<FeedLink>> FeedLink::open(lws_vhost* host, const std::string& feed,
                                                      FeedListener& listener) {
  const auto attached = hal::FeedReader::attach(feed);
  if (!attached) return attached.failure();
  std::unique_ptr<FeedLink> link{new FeedLink{listener}};
  // The loop closes its descriptor itself. Nothing has been read from it yet.
  const int loops_own = fcntl(attached->descriptor(), F_DUPFD_CLOEXEC, 0);
  if (loops_own < 0) return hal::Failure{.message = "no descriptor is left"};
  lws_adopt_desc_t adopted{};
  adopted.vh = host;
  adopted.type = LWS_ADOPT_RAW_FILE_DESC;
  adopted.fd.filefd = loops_own;
  adopted.vh_prot_name = kProtocol;
  adopted.opaque = link.get();
  link->wsi_ = lws_adopt_descriptor_vhost_via_info(&adopted);  // closes it if it fails
  if (link->wsi_ == nullptr) return hal::Failure{.message = "too many connections"};
  return link;
}

FeedLink::~FeedLink() {
  if (wsi_ == nullptr) return;
  lws_set_opaque_user_data(wsi_, nullptr);
  lws_set_timeout(wsi_, PENDING_TIMEOUT_USER_REASON_BASE, LWS_TO_KILL_SYNC);
}

void FeedLink::send(std::string_view lines) {
  if (wsi_ == nullptr || lines.empty()) return;
  waiting_ += lines;
  // At once: a client that says `stop` and goes away is to be heard. An error comes up again when
  // the loop looks at the descriptor.
  if (write() < 0) lws_callback_on_writable(wsi_);
}

void FeedLink::resume() {
  if (wsi_ != nullptr) lws_rx_flow_control(wsi_, 1);
}

int FeedLink::read() {
  std::array<char, std::size_t{16} << 10> bytes{};
  const ssize_t count = ::read(lws_get_socket_fd(wsi_), bytes.data(), bytes.size());
  if (count < 0 && (errno == EAGAIN || errno == EINTR)) return 0;
  if (count <= 0 || !lines_.add({bytes.data(), static_cast<std::size_t>(count)})) return -1;
  while (const auto line = lines_.next()) listener_.line(*line);
  if (listener_.has_enough()) lws_rx_flow_control(wsi_, 0);
  return 0;
}

int FeedLink::write() {
  if (waiting_.empty()) return 0;
  const bool was_congested = is_congested();
  const ssize_t count =
      ::send(lws_get_socket_fd(wsi_), waiting_.data(), waiting_.size(), MSG_NOSIGNAL);
  if (count < 0 && errno != EAGAIN && errno != EINTR) return -1;
  if (count > 0) waiting_.erase(0, static_cast<std::size_t>(count));
  if (!waiting_.empty()) lws_callback_on_writable(wsi_);
  if (was_congested && !is_congested()) listener_.feed_has_room();
  return 0;
}

void FeedLink::lost() {
  wsi_ = nullptr;
  listener_.feed_gone();  // which may destroy this
}

int FeedLink::callback(lws* wsi, int reason) {
  auto* const link = static_cast<FeedLink*>(lws_get_opaque_user_data(wsi));
  if (link == nullptr || link->wsi_ == nullptr) return 0;
  switch (reason) {
    case LWS_CALLBACK_RAW_RX_FILE: return link->read();
    case LWS_CALLBACK_RAW_WRITEABLE_FILE: return link->write();
    case LWS_CALLBACK_RAW_CLOSE_FILE: link->lost(); return 0;
    default: return 0;
  }
}

}  // namespace cargobay::web
