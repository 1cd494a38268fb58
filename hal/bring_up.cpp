#include "hal/bring_up.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include "oi/baud.hpp"
#include "oi/encode.hpp"
#include "oi/limits.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_budget.hpp"
#include "oi/stream_decoder.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

// What host software for this robot waits after Start, Safe and Full: from 20 to 500 ms.
constexpr milliseconds kModeChangeWait{50};
constexpr milliseconds kFrameTimeout{800};
constexpr milliseconds kAnswerTimeout{100};
constexpr std::uint32_t kTooFast = 115200;  // OI p. 7
constexpr int kGoodFrames = 3;              // in the wanted mode, before the robot is believed
// Start is harmless as data and as a command; this many fill up any command that was cut short.
constexpr std::size_t kResynchronisingBytes = 2 + oi::kMaxScriptBytes + 1;

template <typename Command>
void send(ByteStream& stream, const Command& command) {
  const auto bytes = oi::encode(command);
  if (bytes.has_value())
    (void)stream.write(*bytes);  // an unanswered command is noticed by its silence
}

// What was heard while waiting.
struct Heard {
  std::size_t bytes = 0;
  std::size_t text = 0;  // printable
  int frames = 0;
  int frames_in_mode = 0;
  oi::Mode mode = oi::Mode::off;
  std::int32_t battery_mv = 0;
  bool hung_up = false;
};

void pause(ByteStream& stream, rt::Duration duration) {
  const rt::TimePoint until = stream.now() + duration;
  std::array<std::uint8_t, 256> bytes{};
  while (stream.now() < until && stream.wait(until) == ByteStream::Wait::ready) {
    (void)stream.read(bytes);  // what comes in between belongs to nobody
  }
}

void take_frame(const oi::StreamDecoder& decoder, oi::Mode wanted, Heard& heard) {
  oi::SensorValues values;
  if (!oi::decode_frame(decoder.frame(), values)) return;
  ++heard.frames;
  if (values.has(oi::PacketId::voltage)) heard.battery_mv = values.raw(oi::PacketId::voltage);
  if (!values.has(oi::PacketId::oi_mode)) return;
  heard.mode = values.mode();
  if (heard.mode == wanted) ++heard.frames_in_mode;
}

void take_bytes(std::span<const std::uint8_t> bytes, oi::Mode wanted, oi::StreamDecoder& decoder,
                Heard& heard) {
  heard.bytes += bytes.size();
  for (const std::uint8_t byte : bytes) {
    if (byte >= 0x20 && byte < 0x7f) ++heard.text;
    for (auto outcome = decoder.push(byte); outcome != oi::StreamDecoder::Outcome::nothing;
         outcome = decoder.next()) {
      if (outcome == oi::StreamDecoder::Outcome::frame) take_frame(decoder, wanted, heard);
    }
  }
}

Heard listen(ByteStream& stream, oi::Mode wanted) {
  Heard heard;
  oi::StreamDecoder decoder;
  std::array<std::uint8_t, 256> bytes{};
  const rt::TimePoint until = stream.now() + kFrameTimeout;
  while (stream.now() < until && heard.frames_in_mode < kGoodFrames) {
    const ByteStream::Wait woken = stream.wait(until);
    if (woken == ByteStream::Wait::hung_up) {
      heard.hung_up = true;
      break;
    }
    const ByteStream::Transfer transfer = stream.read(bytes);
    take_bytes(std::span{bytes}.first(transfer.count), wanted, decoder, heard);
  }
  return heard;
}

Heard attempt(ByteStream& stream, const BringUpRequest& request) {
  const auto tell = [&request](std::string_view step) {
    if (request.progress) request.progress(step);
  };
  tell("Start");
  stream.discard_input();
  send(stream, oi::Start{});
  pause(stream, kModeChangeWait);
  tell(request.mode == oi::Mode::full ? "Full" : "Safe");
  if (request.mode == oi::Mode::full) {
    send(stream, oi::Full{});
  } else {
    send(stream, oi::Safe{});
  }
  pause(stream, kModeChangeWait);
  tell("Stream");
  send(stream, oi::Stream{request.packets});
  return listen(stream, request.mode);
}

void resynchronise(ByteStream& stream) {
  const std::array<std::uint8_t, 1> start{oi::Start::kOpcode};
  for (std::size_t i = 0; i < kResynchronisingBytes; ++i) (void)stream.write(start);
  pause(stream, oi::wire_time(kResynchronisingBytes, stream.baud()) + kModeChangeWait);
}

std::string other_rates(std::uint32_t baud) {
  return baud == oi::kDefaultBaud ? "--baud 19200, or switch it off and on: it starts at 57600"
                                  : "--baud 57600";
}

Failure too_long(const oi::StreamList& packets, std::uint32_t baud) {
  const auto* enough =
      std::find_if(oi::kBaudRates.begin(), oi::kBaudRates.end(),
                   [&packets](std::uint32_t rate) { return oi::fits(packets, rate); });
  const std::string remedy = enough == oi::kBaudRates.end()
                                 ? "stream fewer packets"
                                 : "choose " + std::to_string(*enough) + " baud or more";
  return {"frames of " + std::to_string(oi::frame_bytes(packets)) +
          " bytes every 15 ms do not fit " + std::to_string(baud) + " baud, which carries " +
          std::to_string(oi::bytes_per_tick(baud)) + " bytes in that time; " + remedy};
}

Failure explain(const Heard& heard, const BringUpRequest& request, std::uint32_t baud) {
  const std::string rate = std::to_string(baud) + " baud";
  if (heard.hung_up)
    return {
        "the port hung up during bring-up; check the cable and that the robot's end is running"};
  if (heard.bytes == 0) {
    return {"the robot is silent at " + rate +
            "; is it switched on, and are TX and RX the right way round? "
            "It may also run at another rate: try " +
            other_rates(baud)};
  }
  if (heard.frames == 0 && heard.text * 4 > heard.bytes * 3) {
    return {"the robot sends text instead of frames at " + rate +
            ": it is charging or switched off; unplug the charger and press its power button"};
  }
  if (heard.frames == 0) {
    return {"heard " + std::to_string(heard.bytes) + " bytes at " + rate +
            " but no whole frame; the robot probably runs at another rate: try " +
            other_rates(baud)};
  }
  return {"the robot streams, but stays in " + std::string{oi::name(heard.mode)} +
          " mode instead of " + std::string{oi::name(request.mode)} +
          "; set it on its wheels, away from edges, and unplug the charger"};
}

// Whether the robot says that it is Passive: by the answer to a query, one byte, or by a frame of a
// stream that did not end.
bool says_passive(ByteStream& stream) {
  constexpr auto kPassive = static_cast<std::uint8_t>(oi::Mode::passive);
  oi::StreamDecoder decoder;
  Heard heard;
  std::array<std::uint8_t, 256> bytes{};
  const rt::TimePoint until = stream.now() + kAnswerTimeout;
  while (stream.wait(until) == ByteStream::Wait::ready) {
    const ByteStream::Transfer transfer = stream.read(bytes);
    if (transfer.error != 0) return false;
    if (heard.bytes == 0 && transfer.count == 1 && bytes[0] == kPassive) return true;
    take_bytes(std::span{bytes}.first(transfer.count), oi::Mode::passive, decoder, heard);
    if (heard.frames_in_mode > 0) return true;
  }
  return false;
}

}  // namespace

Result<BringUpReport> bring_up(ByteStream& stream, const BringUpRequest& request) {
  if (stream.baud() == kTooFast) {
    return Failure{
        "at 115200 baud the robot drops bytes that follow within 200 us, and a command is sent "
        "without such gaps; choose 57600"};
  }
  if (!oi::fits(request.packets, stream.baud())) {
    return too_long(request.packets, stream.baud());
  }
  BringUpReport report;
  Heard heard = attempt(stream, request);
  if (heard.frames_in_mode < kGoodFrames && heard.frames == 0 && !heard.hung_up) {
    report.attempts = 2;
    if (request.progress) request.progress("resynchronise");
    resynchronise(stream);
    heard = attempt(stream, request);
  }
  if (heard.frames_in_mode < kGoodFrames) {
    if (!heard.hung_up) (void)leave(stream);  // the failure at hand is the one to report
    return explain(heard, request, stream.baud());
  }
  report.battery_mv = heard.battery_mv;
  return report;
}

bool leave(ByteStream& stream) {
  constexpr int kTries = 3;
  for (int i = 0; i < kTries; ++i) {
    send(stream, oi::DriveDirect{});  // while it still obeys
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
