// Commands to a robot that may not be there, and what is heard meanwhile. For set-up and shutdown;
// runs on the stream's clock, so in virtual time as well.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gpio/pulse_player.hpp"
#include "hal/bring_up/text_source.hpp"
#include "hal/stream/byte_stream.hpp"
#include "hal/stream/write_all.hpp"
#include "oi/command_table.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"

namespace cargobay::hal {

// Time to listen for a line of text: a charging robot and a GPS receiver send one a second.
inline constexpr std::chrono::milliseconds kTimeOfALine{1200};

// What was heard since the beginning, or since the last forget().
struct Heard {
  std::size_t bytes = 0;
  std::size_t printable = 0;
  std::size_t nonzero = 0;
  std::size_t echoed = 0;   // of those, what was sent, in the same order
  std::string last_line{};  // the last whole line of text, up to 60 characters of it
  // The last line whose source is known; a prompt counts though it has not ended.
  TextSource source = TextSource::unknown;
  std::string known_line{};

  // Mostly text, and a line of it.
  bool is_text() const { return !last_line.empty() && mostly(printable, bytes); }
  // What a robot prints while it charges or is switched off.
  bool is_robots_text() const { return source == TextSource::robot; }
  // Something else is at the other end, and it is known what.
  bool is_strangers_text() const { return is_stranger(source) && mostly(printable, bytes); }
  // Enough to say that it is not text at this rate.
  bool is_gibberish() const { return bytes >= kEnough && !mostly(printable, bytes); }
  // What was sent comes back. Zeros prove nothing: a frame is full of them.
  bool is_echo() const { return echoed >= kLeastEcho && mostly(echoed, nonzero); }

 private:
  static constexpr std::size_t kLeastEcho = 4;  // fewer may be chance
  static constexpr std::size_t kEnough = 64;    // about a line
  static constexpr bool mostly(std::size_t part, std::size_t all) { return part * 4 > all * 3; }
};

// What frames of one list reported.
struct FramesHeard {
  int frames = 0;  // of exactly that list
  int in_mode = 0;
  oi::Mode mode = oi::Mode::off;  // of the last
  std::int32_t battery_mv = 0;    // if the list has it
};

class Dialogue final : public gpio::PulseClock {
 public:
  // `stream` must outlive it. `cancelled` is called every 20 ms; empty: never cancelled.
  Dialogue(ByteStream& stream, std::function<bool()> cancelled,
           const oi::Dialect& dialect = oi::kCreate)
      : stream_{stream}, dialect_{dialect}, cancelled_{std::move(cancelled)} {}

  // Uses write_all(). What the port does not take is lost: a command that goes unanswered is
  // noticed by the silence.
  template <typename Command>
  void send(const Command& command) {
    if (const auto bytes = oi::encode(command)) write(*bytes);
  }
  // Completes any command that was cut short, and waits until the zeros have gone through.
  void resynchronise();

  // Reads whatever arrives meanwhile. False if the dialogue is over.
  bool pause(rt::Duration duration) { return wait_until(stream_.now() + duration); }
  TimePoint now() override { return stream_.now(); }
  bool wait_until(TimePoint deadline) override;
  // Until `enough` frames of the list in that mode have come, or `timeout` has passed.
  FramesHeard listen(const oi::StreamList& packets, oi::Mode mode, int enough,
                     rt::Duration timeout);

  // The first `bytes` bytes that arrive, or those of them that arrived within `timeout`.
  std::vector<std::uint8_t> reply(std::size_t bytes, rt::Duration timeout);

  bool hung_up() const { return hung_up_; }
  bool cancelled() const { return was_cancelled_; }
  bool over() const { return hung_up_ || was_cancelled_; }
  const Heard& heard() const { return heard_; }
  void forget() {
    heard_ = {};
    unreturned_.clear();
  }

 private:
  // What has arrived by the deadline, or within a short while; empty if nothing did.
  std::span<const std::uint8_t> take(TimePoint deadline);
  void write(std::span<const std::uint8_t> bytes);
  void note(std::span<const std::uint8_t> bytes);
  void note_echo(std::uint8_t byte);
  void note_source(TextSource source);

  ByteStream& stream_;
  const oi::Dialect& dialect_;
  std::function<bool()> cancelled_;
  bool hung_up_ = false;
  bool was_cancelled_ = false;
  Heard heard_{};
  std::string line_{};
  std::deque<std::uint8_t> unreturned_{};  // what was sent and has not come back
  std::array<std::uint8_t, 256> bytes_{};
};

}  // namespace cargobay::hal
