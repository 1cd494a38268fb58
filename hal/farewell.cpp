#include "hal/leave.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <utility>

#include "hal/dialogue.hpp"
#include "oi/encode.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"

namespace cargobay::hal {
namespace {

constexpr std::chrono::milliseconds kAnswerTimeout{100};

template <typename Command>
void send(ByteStream& stream, const Command& command) {
  // A robot that does not get it does not confirm either.
  if (const auto bytes = oi::encode(command)) (void)stream.write(*bytes);
}

void pause(ByteStream& stream, rt::Duration duration) {
  const rt::TimePoint until = stream.now() + duration;
  std::array<std::uint8_t, 256> bytes{};
  while (stream.now() < until && stream.wait(until) == ByteStream::Wait::ready) {
    (void)stream.read(bytes);  // what comes in between belongs to nobody
  }
}

// Whether the frame that was just decoded says that the robot is Passive.
bool passive_frame(const oi::StreamDecoder& decoder) {
  oi::SensorValues values;
  return oi::decode_frame(decoder.frame(), values) && values.has(oi::PacketId::oi_mode) &&
         values.mode() == oi::Mode::passive;
}

// Whether the robot says that it is Passive: by the answer to a query, one byte, or by a frame of a
// stream that did not end.
bool says_passive(ByteStream& stream) {
  constexpr auto kPassive = static_cast<std::uint8_t>(oi::Mode::passive);
  oi::StreamDecoder decoder;
  bool first = true;
  std::array<std::uint8_t, 256> bytes{};
  const rt::TimePoint until = stream.now() + kAnswerTimeout;
  while (stream.wait(until) == ByteStream::Wait::ready) {
    const ByteStream::Transfer transfer = stream.read(bytes);
    if (transfer.error != 0) return false;
    if (std::exchange(first, false) && transfer.count == 1 && bytes[0] == kPassive) return true;
    bool passive = false;
    decoder.push(std::span{bytes}.first(transfer.count), [&](oi::StreamDecoder::Outcome outcome) {
      if (outcome == oi::StreamDecoder::Outcome::frame) passive = passive || passive_frame(decoder);
    });
    if (passive) return true;
  }
  return false;
}

}  // namespace

bool leave(ByteStream& stream) {
  constexpr int kTries = 3;
  // 0 is no speed where it is data, and no command where it is an opcode.
  constexpr std::array<std::uint8_t, kResynchronisingBytes> kFill{};
  for (int i = 0; i < kTries; ++i) {
    if (i > 0) (void)stream.write(kFill);  // it may be swallowing what it takes for data
    send(stream, oi::DriveDirect{});       // while it still obeys
    send(stream, oi::PauseResumeStream{oi::StreamState::pause});
    send(stream, oi::Start{});  // Passive: Safe and Full do not charge
    pause(stream, kModeChangeWait);
    stream.discard_input();
    send(stream, oi::Sensors{oi::PacketId::oi_mode});
    if (says_passive(stream)) return true;
  }
  return false;
}

}  // namespace cargobay::hal
