#include "hal/bring_up/sensor_stream.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

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

template <typename Command>
bool tell(ByteStream& stream, const Command& command) {
  const auto bytes = oi::encode(command);
  return bytes.has_value() && stream.write(*bytes).count == bytes->size();
}

Failure no_answer(const ByteStream& stream) {
  return {"the robot does not answer at " + std::to_string(stream.baud()) +
          " baud; is it switched on and connected, and is this its baud rate? `cargobay bringup` "
          "finds it at any"};
}

// Reads and drops until nothing has arrived for a while. Returns whether anything had.
bool settle(ByteStream& stream) {
  std::array<std::uint8_t, 256> bytes{};
  bool heard = false;
  const rt::TimePoint limit = stream.now() + kStreamTimeout;
  while (stream.now() < limit && stream.wait(stream.now() + kQuiet) == ByteStream::Wait::ready) {
    heard = stream.read(bytes).count > 0 || heard;
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

}  // namespace

Result<oi::SensorValues> query_sensors(ByteStream& stream, std::span<const oi::PacketId> packets) {
  oi::QueryList query;
  std::size_t size = 0;
  for (const oi::PacketId packet : packets) {
    if (!query.packets.push_back(packet)) return Failure{"more than 255 packets; ask for fewer"};
    size += oi::kCreate.packet(packet).size;
  }
  (void)tell(stream, oi::PauseResumeStream{oi::StreamState::pause});
  const bool streamed = settle(stream);
  const rt::Duration timeout =
      oi::wire_time(size + packets.size() + 2, stream.baud()) + kAnswerMargin;
  (void)tell(stream, query);  // if it was not sent, there is no answer
  std::vector<std::uint8_t> answer = receive(stream, size, timeout);
  if (answer.empty()) {  // a robot that is off hears only Start
    (void)tell(stream, oi::Start{});
    (void)stream.wait(stream.now() + kStartWait);
    (void)settle(stream);
    (void)tell(stream, query);
    answer = receive(stream, size, timeout);
  }
  if (streamed) {
    (void)tell(stream, oi::PauseResumeStream{oi::StreamState::resume});
    (void)stream.wait(stream.now() + kQuiet);  // let it hear this before the rate may change
  }
  if (answer.size() != size) return no_answer(stream);
  oi::SensorValues values;
  std::span<const std::uint8_t> rest{answer};
  for (const oi::PacketId packet : packets) {
    const std::size_t bytes = oi::kCreate.packet(packet).size;
    (void)oi::decode_packet(static_cast<std::uint8_t>(packet), rest.first(bytes),
                            values);  // known and whole
    rest = rest.subspan(bytes);
  }
  return values;
}

Result<std::unique_ptr<SensorStream>> SensorStream::open(ByteStream& stream,
                                                         std::span<const oi::PacketId> packets) {
  oi::Stream list;
  for (const oi::PacketId packet : packets) {
    if (!list.packets.push_back(packet))
      return Failure{"a stream holds 43 packets at most; ask for fewer"};
  }
  if (!oi::fits(list.packets, stream.baud())) {
    return Failure{"frames of " + std::to_string(oi::frame_bytes(list.packets)) +
                   " bytes every 15 ms do not fit " + std::to_string(stream.baud()) +
                   " baud, which carries " + std::to_string(oi::bytes_per_tick(stream.baud())) +
                   "; ask for fewer packets (--packets), or for one reading (--once)"};
  }
  std::unique_ptr<SensorStream> sensors{new SensorStream{stream}};
  (void)tell(stream, list);
  if (sensors->next()) return sensors;
  (void)tell(stream, oi::Start{});
  (void)stream.wait(stream.now() + kStartWait);
  (void)tell(stream, list);
  if (!sensors->next()) return no_answer(stream);
  return sensors;
}

SensorStream::~SensorStream() {
  (void)tell(stream_, oi::PauseResumeStream{oi::StreamState::pause});
  // Closing the port sets it as it was found: until the robot is silent, this command may still be
  // on its way, and would arrive at another rate.
  (void)settle(stream_);
}

Result<oi::SensorValues> SensorStream::next() {
  const rt::TimePoint limit = stream_.now() + kStreamTimeout;
  for (;;) {
    std::array<std::uint8_t, 1> byte{};
    if (decoder_.next() == oi::StreamDecoder::Outcome::frame) break;
    const ByteStream::Wait woken = stream_.wait(limit);
    if (woken == ByteStream::Wait::hung_up)
      return Failure{"the port hung up; plug it in and start again"};
    if (woken == ByteStream::Wait::timed_out) return no_answer(stream_);
    if (stream_.read(byte).count == 0) continue;
    if (decoder_.push(byte[0]) == oi::StreamDecoder::Outcome::frame) break;
  }
  oi::SensorValues values;
  (void)oi::decode_frame(decoder_.frame(), values);  // whole: the decoder checked its structure
  return values;
}

}  // namespace cargobay::hal
