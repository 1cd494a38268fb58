#include "hal/web/server/web_socket.hpp"

#include <libwebsockets.h>
#include <sys/socket.h>

#include <chrono>
#include <cstring>
#include <utility>
#include <vector>

namespace cargobay::web {
namespace {

// Small, so that what a slow client gets is not old, and that an answer to a ping comes in time.
constexpr int kKernelBufferBytes = 64 << 10;
// Of answers to a client that asks more than it reads.
constexpr std::size_t kMostWaitingBytes = std::size_t{256} << 10;
constexpr int kClosingSeconds = 2;

std::int64_t unix_ns() {
  using std::chrono::system_clock;
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

void WebSocket::begin(const std::string& feed) {
  const int socket = lws_get_socket_fd(wsi_);
  (void)setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kKernelBufferBytes, sizeof kKernelBufferBytes);
  auto link = FeedLink::open(lws_get_vhost(wsi_), feed, *this);
  if (link) {
    feed_ = std::move(*link);
    after_hearing();  // what it has to say by itself
  } else {
    end({.code = CloseCode::restart, .reason = "the feed cannot be read"});
  }
}

int WebSocket::receive(std::string_view part, bool is_last, bool is_binary) {
  if (ending_) return 0;
  lws_validity_confirmed(wsi_);
  if (!message_.add(part, is_last)) {
    ending_ = {.code = CloseCode::too_big, .reason = "a message has at most 4096 bytes"};
    return close();
  }
  const auto message = message_.take();
  if (!message) return 0;
  ending_ = conversation_->hear(*message, is_binary);
  if (ending_) return close();
  after_hearing();
  return 0;
}

void WebSocket::after_hearing() {
  if (feed_) feed_->send(std::exchange(conversation_->to_feed(), {}));
  if (!conversation_->to_client().empty()) lws_callback_on_writable(wsi_);
  if ((feed_ && feed_->is_congested()) || waiting_bytes() > kMostWaitingBytes) {
    is_deaf_ = true;
    lws_rx_flow_control(wsi_, 0);
  }
}

std::size_t WebSocket::waiting_bytes() const {
  std::size_t bytes = 0;
  for (const Frame& frame : conversation_->to_client()) bytes += frame.bytes.size();
  return bytes;
}

int WebSocket::write() {
  auto& frames = conversation_->to_client();
  std::vector<unsigned char> buffer;
  while (!frames.empty() && !ending_) {
    const Frame& frame = frames.front();
    buffer.resize(LWS_PRE + frame.bytes.size());
    std::memcpy(buffer.data() + LWS_PRE, frame.bytes.data(), frame.bytes.size());
    const auto kind = frame.is_binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT;
    // What the socket does not take of it, the library keeps.
    const int sent = lws_write(wsi_, buffer.data() + LWS_PRE, frame.bytes.size(), kind);
    if (sent < 0) return -1;
    frames.pop_front();
    if (lws_send_pipe_choked(wsi_) != 0) {
      lws_callback_on_writable(wsi_);
      return 0;
    }
  }
  if (ending_) return close();
  if (feed_) feed_->resume();
  if (is_deaf_ && !(feed_ && feed_->is_congested())) feed_has_room();
  return 0;
}

int WebSocket::close() const {
  std::string reason = ending_->reason;
  lws_close_reason(wsi_, static_cast<lws_close_status>(ending_->code),
                   reinterpret_cast<unsigned char*>(reason.data()), reason.size());
  return -1;
}

void WebSocket::end(Ending ending) {
  if (ending_) return;
  ending_ = std::move(ending);
  lws_set_timeout(wsi_, PENDING_TIMEOUT_CLOSE_SEND, kClosingSeconds);
  lws_callback_on_writable(wsi_);
}

void WebSocket::line(std::string_view line) {
  if (ending_) return;
  conversation_->tell(line, unix_ns());
  after_hearing();
}

// Until all of it has been sent: the feed keeps what comes meanwhile, and drops what is too much.
bool WebSocket::has_enough() { return !conversation_->to_client().empty(); }

void WebSocket::feed_gone() {
  feed_.reset();
  end({.code = CloseCode::restart, .reason = "the feed has ended"});
}

void WebSocket::feed_has_room() {
  is_deaf_ = false;
  lws_rx_flow_control(wsi_, 1);
}

}  // namespace cargobay::web
