#include "hal/guard/farewell.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

#include "hal/stream/spaced_stream.hpp"
#include "hal/stream/write_all.hpp"
#include "oi/command_table.hpp"
#include "oi/encode.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_budget.hpp"
#include "oi/stream_decoder.hpp"

namespace cargobay::hal {
namespace {

constexpr int kTries = 3;
constexpr std::chrono::milliseconds kAnswerTimeout{100};

template <typename Command>
bool send(ByteStream& stream, const Command& command) {
  const auto bytes = oi::encode(command);
  return bytes.has_value() && write_all(stream, *bytes);
}

// What arrives meanwhile is dropped. False if the port reports that it is gone.
bool pause(ByteStream& stream, rt::Duration duration) {
  const rt::TimePoint until = stream.now() + duration;
  std::array<std::uint8_t, 256> bytes{};
  while (stream.now() < until) {
    switch (stream.wait(until)) {
      case ByteStream::Wait::hung_up: return false;
      case ByteStream::Wait::timed_out: return true;
      case ByteStream::Wait::left: break;
      case ByteStream::Wait::ready:
        if (stream.read(bytes).error != 0) return false;
    }
  }
  return true;
}

bool stands(std::uint8_t mode) {
  return mode == static_cast<std::uint8_t>(oi::Mode::passive) ||
         mode == static_cast<std::uint8_t>(oi::Mode::off);
}

// Whether the frame just decoded says that it stands.
bool standing_frame(const oi::StreamDecoder& decoder) {
  oi::SensorValues values;
  return oi::decode_frame(decoder.frame(), values) && values.has(oi::PacketId::oi_mode) &&
         stands(static_cast<std::uint8_t>(values.mode()));
}

// From the answer to a query, one byte, or from a frame of a stream that did not end.
Parting hear_mode(ByteStream& stream, rt::Duration timeout) {
  oi::StreamDecoder decoder;
  bool first = true;
  std::array<std::uint8_t, 256> bytes{};
  const rt::TimePoint until = stream.now() + timeout;
  for (;;) {
    const ByteStream::Wait woken = stream.wait(until);
    if (woken == ByteStream::Wait::timed_out) return Parting::unconfirmed;
    if (woken == ByteStream::Wait::hung_up) return Parting::port_gone;
    const ByteStream::Transfer transfer = stream.read(bytes);
    if (transfer.error != 0) return Parting::port_gone;
    if (transfer.count == 0) continue;
    if (std::exchange(first, false) && transfer.count == 1 && stands(bytes[0]))
      return Parting::standing;
    bool standing = false;
    decoder.push(std::span{bytes}.first(transfer.count), [&](oi::StreamDecoder::Outcome outcome) {
      if (outcome == oi::StreamDecoder::Outcome::frame) standing |= standing_frame(decoder);
    });
    if (standing) return Parting::standing;
  }
}

Parting say_farewell(ByteStream& stream, const Unfinished& unfinished) {
  constexpr std::size_t kLongest = oi::kDriveDirectBytes + 2 + 2 + 1;  // of the four commands
  bool taken = complete_command(stream, unfinished.bytes);
  taken = send(stream, oi::DriveDirect{}) && taken;  // while the robot still obeys
  taken = send(stream, oi::PauseResumeStream{oi::StreamState::pause}) && taken;
  if (unfinished.demo) taken = send(stream, oi::Demo{oi::DemoNumber::abort}) && taken;
  taken = send(stream, oi::Start{}) && taken;  // Passive: Safe and Full do not charge
  const rt::Duration on_the_wire = sending_time(unfinished.bytes + kLongest, stream.baud());
  taken = pause(stream, on_the_wire + kModeChangeWait) && taken;
  stream.discard_input();
  if (!send(stream, oi::Sensors{oi::PacketId::oi_mode})) return Parting::port_gone;
  const Parting heard = hear_mode(stream, kAnswerTimeout);
  return heard == Parting::port_gone && taken ? Parting::unconfirmed : heard;
}

}  // namespace

bool complete_command(ByteStream& stream, std::size_t bytes) {
  constexpr std::array<std::uint8_t, oi::kLongestRest> kZeros{};
  return write_all(stream, std::span{kZeros}.first(std::min(bytes, kZeros.size())));
}

Parting farewell(ByteStream& stream, const Unfinished& unfinished) {
  (void)stream.set_wake_threshold(1);  // if this fails, single bytes show up when the time is over
  bool gone = true;
  for (int i = 0; i < kTries; ++i) {
    const std::size_t missing = i == 0 ? unfinished.bytes : oi::kLongestRest;
    const Parting parting = say_farewell(stream, {.bytes = missing, .demo = unfinished.demo});
    if (parting == Parting::standing) return parting;
    gone = gone && parting == Parting::port_gone;
  }
  return gone ? Parting::port_gone : Parting::unconfirmed;
}

}  // namespace cargobay::hal
