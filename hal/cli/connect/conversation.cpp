#include "hal/cli/connect/conversation.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

#include <fmt/format.h>

#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/sensor_format.hpp"
#include "hal/stream/spaced_stream.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::cli {
namespace {

using Wait = hal::ByteStream::Wait;

constexpr std::chrono::milliseconds kSlice{20};  // longest time until a signal is noticed
constexpr std::chrono::milliseconds kQuiet{
    40};  // longer than a tick: a paused stream is silent by then
constexpr std::chrono::milliseconds kSettle{500};  // for a stream to end
constexpr std::chrono::milliseconds kAnswer{400};  // on top of the time on the wire
constexpr std::chrono::seconds kSendTimeout{2};
constexpr std::size_t kQueuedBytes = 4096;  // at most, in the kernel
constexpr std::size_t kUartFifo = 32;  // bytes that the driver counts as sent though they are not
constexpr std::size_t kLeastText = 4;  // characters; fewer may be damage by chance

}  // namespace

Conversation::Conversation(hal::ByteStream& port, StopSignals& signals)
    : port_{port}, signals_{signals} {
  decoder_.collect_text(&tail_);
}

bool Conversation::interrupted() {
  if (!signal_) signal_ = signals_.wait(rt::Duration::zero());
  return signal_.has_value() && !signals_ignored_;
}

bool Conversation::send(std::span<const std::uint8_t> bytes) {
  const rt::TimePoint limit = port_.now() + kSendTimeout;
  while (!bytes.empty()) {
    const hal::ByteStream::Transfer transfer = port_.write(bytes);
    bytes = bytes.subspan(transfer.count);
    if (transfer.error != 0 || port_.now() > limit) return false;
    if (!bytes.empty()) port_.sleep(std::chrono::milliseconds{1});
  }
  return true;
}

bool Conversation::listen(rt::Duration duration) {
  const rt::TimePoint until = port_.now() + duration;
  std::array<std::uint8_t, 256> bytes{};
  while (!hung_up_ && port_.now() < until && !interrupted()) {
    const Wait woken = port_.wait(std::min<rt::TimePoint>(until, port_.now() + kSlice));
    if (woken == Wait::hung_up) hung_up_ = true;
    if (woken == Wait::timed_out) print_bytes();
    if (woken != Wait::ready) continue;
    const hal::ByteStream::Transfer transfer = port_.read(bytes);
    for (const std::uint8_t byte : std::span{bytes}.first(transfer.count)) take(byte);
    if (transfer.count > 0) std::fflush(stdout);
  }
  return !hung_up_;
}

void Conversation::take(std::uint8_t byte) {
  if (bytes_shown_) unexplained_.push_back(byte);
  for (auto outcome = decoder_.push(byte); outcome != oi::StreamDecoder::Outcome::nothing;
       outcome = decoder_.next()) {
    if (outcome == oi::StreamDecoder::Outcome::frame && frames_shown_)
      print_frame(decoder_.frame());
    if (outcome == oi::StreamDecoder::Outcome::frame) unexplained_.clear();
  }
  take_text();
  constexpr std::size_t kMost = 64;
  if (unexplained_.size() >= kMost) print_bytes();
}

void Conversation::print_bytes() {
  if (unexplained_.empty()) return;
  if (std::ranges::all_of(unexplained_, oi::is_text) && unexplained_.size() >= kLeastText) {
    end_text();  // a line whose end has not come
  } else {
    clear_line();
    fmt::print("bytes: {:02x}\n", fmt::join(unexplained_, " "));
    std::fflush(stdout);
    line_.clear();
  }
  unexplained_.clear();
}

void Conversation::take_text() {
  const std::uint64_t count =
      std::min<std::uint64_t>(tail_.pushed() - text_taken_, oi::TextTail::kCapacity);
  text_taken_ = tail_.pushed();
  if (count == 0) return;
  std::string text(static_cast<std::size_t>(count), '\0');
  text.resize(tail_.copy(text));
  for (const char c : text) {
    if (c == '\n') {
      end_text();
    } else if (c != '\r') {
      line_.push_back(c);
    }
  }
}

void Conversation::end_text() {
  if (line_.size() >= kLeastText) {
    clear_line();
    fmt::print("text: {}\n", line_);
    unexplained_.clear();
  }
  line_.clear();
  std::fflush(stdout);
}

void Conversation::print_frame(std::span<const std::uint8_t> frame) const {
  oi::SensorValues values;
  if (!oi::decode_frame(frame, values)) return;
  std::vector<oi::PacketId> packets;
  for (std::size_t at = 2; at + 1 < frame.size(); at += 1 + oi::kCreate.packet_size(frame[at]))
    packets.push_back(static_cast<oi::PacketId>(frame[at]));
  std::string line;
  for (const oi::PacketId packet : singles(packets)) {
    if (!line.empty()) line += ", ";
    line += fmt::format("{} {}", oi::kCreate.packet(packet).key, text(packet, values));
  }
  clear_line();  // of progress
  fmt::print("{}\n", line);
}

void Conversation::settle() {
  const rt::TimePoint limit = port_.now() + kSettle;
  for (std::uint64_t before = ~0ULL; port_.now() < limit;) {
    if (before == decoder_.counters().bytes) return;
    before = decoder_.counters().bytes;
    if (!listen(kQuiet)) return;
  }
}

bool Conversation::begin_question(std::span<const std::uint8_t> request) {
  if (streaming_) {
    const auto pause = oi::encode(oi::PauseResumeStream{oi::StreamState::pause});
    if (!send(*pause)) return false;
  }
  (void)listen(asked_at_ + oi::kTick - port_.now());
  if (streaming_) settle();
  // A partial frame still in the decoder would take the beginning of the next one for its own rest.
  while (decoder_.abandon() != oi::StreamDecoder::Outcome::nothing) {
  }
  take_text();
  if (!all_left() || !send(request)) return false;
  asked_at_ = port_.now();
  return true;
}

bool Conversation::resume_stream() {
  return !streaming_ || send(*oi::encode(oi::PauseResumeStream{oi::StreamState::resume}));
}

std::vector<std::uint8_t> Conversation::ask(std::span<const std::uint8_t> request,
                                            std::size_t reply_bytes) {
  if (!begin_question(request)) return {};
  std::vector<std::uint8_t> reply = more_reply(reply_bytes);
  if (reply.size() == reply_bytes && !resume_stream()) return {};
  return reply;
}

std::vector<std::uint8_t> Conversation::ask_anything(std::span<const std::uint8_t> request) {
  constexpr std::size_t kMost = 1024;
  if (!begin_question(request)) return {};
  std::vector<std::uint8_t> answer;
  for (;;) {
    const std::vector<std::uint8_t> more = more_reply(1);
    if (more.empty() || answer.size() == kMost) break;
    answer.push_back(more[0]);
  }
  return resume_stream() ? answer : std::vector<std::uint8_t>{};
}

std::vector<std::uint8_t> Conversation::more_reply(std::size_t reply_bytes) {
  std::vector<std::uint8_t> reply;
  const rt::TimePoint limit =
      port_.now() + oi::wire_time(reply_bytes + oi::kMaxCommandBytes, port_.baud()) + kAnswer;
  std::array<std::uint8_t, 256> bytes{};
  while (reply.size() < reply_bytes && port_.now() < limit && !interrupted()) {
    const Wait woken = port_.wait(std::min<rt::TimePoint>(limit, port_.now() + kSlice));
    if (woken == Wait::hung_up) hung_up_ = true;
    if (hung_up_) break;
    const std::size_t wanted = std::min(bytes.size(), reply_bytes - reply.size());
    const hal::ByteStream::Transfer transfer = port_.read(std::span{bytes}.first(wanted));
    if (transfer.error != 0) break;
    reply.insert(reply.end(), bytes.begin(),
                 bytes.begin() + static_cast<std::ptrdiff_t>(transfer.count));
  }
  return reply;
}

bool Conversation::all_left() {
  const rt::TimePoint limit =
      port_.now() + kSendTimeout + hal::sending_time(kQueuedBytes, port_.baud());
  while (!port_.drain(kSlice)) {
    if (port_.now() >= limit || interrupted()) return false;
    if (!listen(std::chrono::milliseconds{1})) return false;
  }
  return true;
}

bool Conversation::change_baud(std::uint32_t baud) {
  if (!all_left()) return false;
  port_.sleep(oi::wire_time(kUartFifo, port_.baud()));
  if (port_.set_baud(baud)) return false;
  return listen(oi::kBaudChangeWait);
}

}  // namespace cargobay::cli
