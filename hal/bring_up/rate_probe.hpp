// Asks at one rate whether the robot is there, without harm to one that listens at another.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/bring_up/bring_up_failure.hpp"
#include "hal/bring_up/dialogue.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"

namespace cargobay::hal {

// A stream begins within a tick.
inline constexpr std::chrono::milliseconds kFrameTimeout{300};

// At which consoles and GPS receivers talk, likeliest first.
inline constexpr std::array<std::uint32_t, 4> kRatesOfOthers{115200, 9600, 4800, 38400};

std::string at_baud(std::uint32_t baud);  // "at 57600 baud"

// Blocks as long as the questions take, and no longer than the dialogue may.
class RateProbe {
 public:
  using Tell = std::function<void(std::string_view step, const std::string& detail)>;

  // `stream` and `talk` outlive it. `packets`: the list to stream at the stream's present rate.
  RateProbe(ByteStream& stream, Dialogue& talk, const oi::StreamList& packets, Tell tell)
      : stream_{stream},
        talk_{talk},
        packets_{packets},
        wanted_{stream.baud()},
        tell_{std::move(tell)} {}

  // Whether it answers at this rate: with a stream, or with replies if the rate cannot carry one.
  bool answers(std::uint32_t baud);
  // The same after completing whatever command it may have got the beginning of.
  bool answers_freed(std::uint32_t baud);
  void set_port(std::uint32_t baud);

  // The rates at which to listen for text: those at which the robot prints it and, if something was
  // heard that is no text at these, those at which others do.
  std::vector<std::uint32_t> rates_of_text(const oi::Dialect& dialect) const;
  // Asks nothing, and notes what comes. False if the dialogue is over.
  bool listen(std::uint32_t baud, rt::Duration duration);

  // What was heard at each rate that did not answer.
  const std::vector<HeardAt>& heard() const { return heard_; }
  void note_silence(std::uint32_t baud);
  // It is off, booting or charging, and its text shows the rate.
  bool heard_text() const;
  // What is there is known, and not the robot.
  bool heard_strangers_text() const;
  // The same, or an echo: the robot may be there too, if a wire is connected to another.
  bool heard_stranger() const;
  // Bytes, but neither text nor an echo.
  bool heard_noise() const;
  // It answered only after its command had been completed.
  bool freed() const { return freed_; }
  // As its answer said; 0 if it did not.
  std::int32_t battery_mv() const { return battery_mv_; }

 private:
  bool heard_any(bool (Heard::*is)() const) const;
  bool stirs(std::uint32_t baud);
  bool streams(std::uint32_t baud);
  bool replies(std::uint32_t baud);
  const oi::StreamList& list_at(std::uint32_t baud) const;

  ByteStream& stream_;
  Dialogue& talk_;
  oi::StreamList packets_;
  std::uint32_t wanted_;
  Tell tell_;
  std::vector<HeardAt> heard_{};
  FramesHeard last_{};
  bool freed_ = false;
  std::int32_t battery_mv_ = 0;
};

}  // namespace cargobay::hal
