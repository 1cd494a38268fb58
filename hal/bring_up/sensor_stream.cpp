#include "hal/bring_up/sensor_stream.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "hal/trouble.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kStreamTimeout{500};
constexpr milliseconds kQuiet{40};  // longer than a tick: a paused stream is silent by then
constexpr milliseconds kStartWait{100};
constexpr milliseconds kAnswerMargin{100};
constexpr milliseconds kLate{2};  // the rest of a frame, after its wire time
// Earlier than the tick before it, the next frame is looked for this much, so that the look stays
// near the frame's end; and this much later if it was too early.
constexpr std::chrono::microseconds kEarlier{10};
constexpr std::chrono::microseconds kLater{300};
constexpr milliseconds kTooLate{2};

template <typename Command>
bool tell(ByteStream& stream, const Command& command) {
  const auto bytes = oi::encode(command);
  return bytes.has_value() && stream.write(*bytes).count == bytes->size();
}

Failure no_answer(const ByteStream& stream) {
  return {"the robot does not answer at " + std::to_string(stream.baud()) +
              " baud; is it switched on and connected, and is this its baud rate? `cargobay "
              "bringup` finds it at any",
          Trouble::silent};
}

// Reads until nothing has arrived for a while. Returns what had.
std::vector<std::uint8_t> settle(ByteStream& stream) {
  std::array<std::uint8_t, 256> bytes{};
  std::vector<std::uint8_t> heard;
  const rt::TimePoint limit = stream.now() + kStreamTimeout;
  while (stream.now() < limit && stream.wait(stream.now() + kQuiet) == ByteStream::Wait::ready) {
    const auto come = std::span{bytes}.first(stream.read(bytes).count);
    heard.insert(heard.end(), come.begin(), come.end());
  }
  return heard;
}

// Reads until `count` bytes are there or the time is up.
std::vector<std::uint8_t> receive(ByteStream& stream, std::size_t count, rt::Duration timeout) {
  std::vector<std::uint8_t> received;
  const rt::TimePoint limit = stream.now() + timeout;
  std::array<std::uint8_t, 256> bytes{};
  while (received.size() < count && stream.wait(limit) == ByteStream::Wait::ready) {
    const std::size_t wanted = std::min(bytes.size(), count - received.size());
    const ByteStream::Transfer transfer = stream.read(std::span{bytes}.first(wanted));
    if (transfer.error != 0) break;
    received.insert(received.end(), bytes.begin(),
                    bytes.begin() + static_cast<std::ptrdiff_t>(transfer.count));
  }
  return received;
}

// What comes back from Pause Stream: the rest of a stream; or the command itself, as from a
// loopback plug or a console, where the beginning of a question would be taken for its answer.
enum class PauseHeard : std::uint8_t { nothing, stream, echo };

PauseHeard pause_stream(ByteStream& stream) {
  constexpr oi::PauseResumeStream kPause{oi::StreamState::pause};
  (void)tell(stream, kPause);
  const std::vector<std::uint8_t> heard = settle(stream);
  if (heard.empty()) return PauseHeard::nothing;
  const auto sent = *oi::encode(kPause);  // its value is in range
  const bool echo =
      heard.size() >= sent.size() && std::equal(sent.begin(), sent.end(), heard.begin());
  return echo ? PauseHeard::echo : PauseHeard::stream;
}

oi::SensorValues decode(std::span<const std::uint8_t> reply,
                        std::span<const oi::PacketId> packets) {
  oi::SensorValues values;
  for (const oi::PacketId packet : packets) {
    const std::size_t bytes = oi::kCreate.packet(packet).size;
    (void)oi::decode_packet(static_cast<std::uint8_t>(packet), reply.first(bytes),
                            values);  // known and whole
    reply = reply.subspan(bytes);
  }
  return values;
}

Failure not_streamed(const ByteStream& stream, std::span<const oi::PacketId> packets) {
  return {"frames of " + std::to_string(oi::frame_bytes(packets)) +
          " bytes every 15 ms do not fit " + std::to_string(stream.baud()) +
          " baud, which carries " + std::to_string(oi::bytes_per_tick(stream.baud()))};
}

struct Query {
  oi::QueryList list{};
  std::size_t reply_bytes = 0;
};

Result<Query> query_for(std::span<const oi::PacketId> packets) {
  Query query;
  for (const oi::PacketId packet : packets) {
    if (!query.list.packets.push_back(packet))
      return Failure{"more than 255 packets; ask for fewer"};
    query.reply_bytes += oi::kCreate.packet(packet).size;
  }
  return query;
}

rt::Duration answer_time(const ByteStream& stream, std::size_t reply_bytes, std::size_t packets) {
  return oi::wire_time(reply_bytes + packets + 2, stream.baud()) + kAnswerMargin;
}

}  // namespace

Result<oi::SensorValues> query_sensors(ByteStream& stream, std::span<const oi::PacketId> packets) {
  const auto query = query_for(packets);
  if (!query) return query.failure();
  const std::size_t size = query->reply_bytes;
  const PauseHeard heard = pause_stream(stream);
  // The rest of a frame may look like it, once.
  if (heard == PauseHeard::echo && pause_stream(stream) == PauseHeard::echo)
    return no_answer(stream);
  const bool streamed = heard != PauseHeard::nothing;
  const rt::Duration timeout = answer_time(stream, size, packets.size());
  (void)tell(stream, query->list);  // if it was not sent, there is no answer
  std::vector<std::uint8_t> answer = receive(stream, size, timeout);
  if (answer.empty()) {  // a robot that is off hears only Start
    (void)tell(stream, oi::Start{});
    (void)stream.wait(stream.now() + kStartWait);
    (void)settle(stream);
    (void)tell(stream, query->list);
    answer = receive(stream, size, timeout);
  }
  if (streamed) {
    (void)tell(stream, oi::PauseResumeStream{oi::StreamState::resume});
    (void)stream.wait(stream.now() + kQuiet);  // let it hear this before the rate may change
  }
  if (answer.size() != size) return no_answer(stream);
  return decode(answer, packets);
}

Result<std::unique_ptr<SensorStream>> SensorStream::open(ByteStream& stream,
                                                         std::span<const oi::PacketId> packets) {
  std::unique_ptr<SensorStream> sensors{new SensorStream{stream}};
  oi::Stream list;
  const bool listed = std::ranges::all_of(
      packets, [&](oi::PacketId packet) { return list.packets.push_back(packet); });
  const bool streams = listed && oi::fits(packets, stream.baud());
  if (streams && sensors->begin(list)) return sensors;
  sensors->why_asked_ =
      streams ? "the robot answers, but does not stream" : not_streamed(stream, packets).message;
  if (auto asked = sensors->begin_asking(packets); !asked) return asked.failure();
  return sensors;
}

// The first frame is dropped: its distance and angle are from before.
bool SensorStream::begin(const oi::Stream& list) {
  frame_bytes_ = oi::frame_bytes(list.packets);
  wake_at(frame_bytes_);
  (void)tell(stream_, list);
  if (next_streamed()) return true;
  (void)tell(stream_, oi::Start{});
  (void)stream_.wait(stream_.now() + kStartWait);
  (void)tell(stream_, list);
  return static_cast<bool>(next_streamed());
}

Result<void> SensorStream::begin_asking(std::span<const oi::PacketId> packets) {
  wake_at(1);
  const auto query = query_for(packets);
  if (!query) return query.failure();
  query_ = query->list;
  reply_bytes_ = query->reply_bytes;
  const auto first = query_sensors(stream_, packets);
  asked_at_ = stream_.now();
  if (!first) return first.failure();
  return {};
}

SensorStream::~SensorStream() {
  (void)tell(stream_, oi::PauseResumeStream{oi::StreamState::pause});
  wake_at(1);
  // Closing the port sets it as it was found: until the robot is silent, this command may still be
  // on its way, and would arrive at another rate.
  (void)settle(stream_);
}

Result<SensorFrame> SensorStream::next() {
  auto values = why_asked_.empty() ? next_streamed() : next_asked();
  if (!values) return values.failure();
  sums_.values = *values;
  sums_.arrival = stream_.now();
  sums_.distance_mm += values->raw(oi::PacketId::distance);
  sums_.angle_deg += values->raw(oi::PacketId::angle);
  return sums_;
}

// The robot sends a frame every tick. Whoever waits on a terminal is woken for each byte or two of
// it, even if it wants more, so the tick is slept through, and the frame is there.
Result<oi::SensorValues> SensorStream::next_streamed() {
  const rt::TimePoint limit = stream_.now() + kStreamTimeout;
  oi::SensorValues values;
  if (take_frame(values)) return values;
  if (open_bytes() == 0 && due_ > stream_.now()) {
    stream_.sleep(due_ - stream_.now());
    due_ += oi::kTick - kEarlier;
    read();
    if (take_frame(values)) {
      if (begin_ != end_) due_ -= kTooLate;  // a part of the next is there
      return values;
    }
  }
  while (!take_frame(values)) {
    // After lost or additional bytes a whole frame's worth arrives in the middle of the next: its
    // rest is not waited for any longer than it needs, which brings wake-ups and frames together.
    const std::size_t held = open_bytes();
    const std::size_t rest = held == 0 ? 0 : frame_bytes_ - std::min(held, frame_bytes_);
    rt::TimePoint deadline = limit;
    if (held > 0) {
      deadline = std::min<rt::TimePoint>(
          limit, stream_.now() + oi::wire_time(rest, stream_.baud()) + kLate);
    }
    if (stream_.wait(deadline) == ByteStream::Wait::hung_up)
      return Failure{"the port hung up; plug it in and start again"};
    read();  // after a time-out, less than a frame
    if (begin_ == end_ && stream_.now() >= limit) return no_answer(stream_);
  }
  due_ = stream_.now() + oi::kTick + kLater;
  return values;
}

void SensorStream::read() {
  begin_ = 0;
  end_ = stream_.read(read_).count;
}

Result<oi::SensorValues> SensorStream::next_asked() {
  const rt::TimePoint may_ask = asked_at_ + oi::kTick;  // no more often (OI p. 13)
  if (may_ask > stream_.now()) stream_.sleep(may_ask - stream_.now());
  asked_at_ = stream_.now();
  constexpr int kTries = 3;
  for (int i = 0; i < kTries; ++i) {
    (void)tell(stream_, query_);
    const std::vector<std::uint8_t> reply =
        receive(stream_, reply_bytes_, answer_time(stream_, reply_bytes_, query_.packets.size()));
    if (reply.size() == reply_bytes_)
      return decode(reply, {query_.packets.begin(), query_.packets.end()});
    (void)settle(stream_);  // a byte too few or too many: nothing of it may end up in the next
    asked_at_ = stream_.now();
  }
  return no_answer(stream_);
}

// Decodes what has been read, up to and with the next frame.
bool SensorStream::take_frame(oi::SensorValues& values) {
  using Outcome = oi::StreamDecoder::Outcome;
  Outcome outcome = decoder_.next();
  for (;;) {
    while (outcome == Outcome::corrupt) outcome = decoder_.next();
    if (outcome == Outcome::frame) break;
    if (begin_ == end_) return false;
    outcome = decoder_.push(read_[begin_++]);
  }
  (void)oi::decode_frame(decoder_.frame(), values);  // whole: the decoder checked its structure
  return true;
}

std::size_t SensorStream::open_bytes() const {
  const oi::StreamDecoder::Counters& counters = decoder_.counters();
  return static_cast<std::size_t>(counters.bytes - counters.framed - counters.skipped);
}

// If the port cannot, there are more wake-ups, and all else is the same.
void SensorStream::wake_at(std::size_t bytes) { (void)stream_.set_wake_threshold(bytes); }

}  // namespace cargobay::hal
