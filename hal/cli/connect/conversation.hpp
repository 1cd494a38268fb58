// Commands to a robot and what comes back: replies, frames and text, told apart.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/cli/terminal/signals.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"
#include "oi/text_tail.hpp"

namespace cargobay::cli {

// Prints the text that the robot writes by itself and, after show_frames(), the frames.
class Conversation {
 public:
  // Both outlive it.
  Conversation(hal::ByteStream& port, StopSignals& signals);

  // False if the port did not take them within 2 s, or is gone.
  [[nodiscard]] bool send(std::span<const std::uint8_t> bytes);
  // Sends, then reads `reply_bytes`: the whole reply, or what has arrived of it. Pauses a running
  // stream meanwhile, because a reply is not framed and could not be told from it. Waits until
  // 15 ms after the last question: a robot must not be asked more often (OI p. 13).
  std::vector<std::uint8_t> ask(std::span<const std::uint8_t> request, std::size_t reply_bytes);
  // The same for an answer of unknown length: what has come when the robot falls silent, 1 KiB at
  // most.
  std::vector<std::uint8_t> ask_anything(std::span<const std::uint8_t> request);
  // The bytes that follow a reply.
  std::vector<std::uint8_t> more_reply(std::size_t reply_bytes);
  // Takes what comes for this long, or until a signal. False if the port is gone.
  bool listen(rt::Duration duration);
  // Waits until everything has left, then changes the rate of the port and waits 100 ms.
  [[nodiscard]] bool change_baud(std::uint32_t baud);
  // Prints the rest of a line of text.
  void end_text();

  void show_frames() { frames_shown_ = true; }
  // Prints also bytes that are neither frame nor text, when a pause follows them.
  void show_bytes() { bytes_shown_ = true; }
  void set_streaming(bool streaming) { streaming_ = streaming; }
  bool streaming() const { return streaming_; }
  std::uint64_t bytes() const { return decoder_.counters().bytes; }
  std::uint64_t frames() const { return decoder_.counters().frames; }
  bool hung_up() const { return hung_up_; }
  // The signal that came, if any.
  std::optional<int> signal() const { return signal_; }
  // From here on signals end nothing: for the stop.
  void ignore_signals() { signals_ignored_ = true; }

 private:
  bool interrupted();
  // Waits for it, as long as that takes at this rate.
  bool all_left();
  void take(std::uint8_t byte);
  void take_text();
  void settle();
  bool begin_question(std::span<const std::uint8_t> request);
  bool resume_stream();
  void print_bytes();
  void print_frame(std::span<const std::uint8_t> frame) const;

  hal::ByteStream& port_;
  StopSignals& signals_;
  oi::StreamDecoder decoder_{};
  oi::TextTail tail_{};
  std::uint64_t text_taken_ = 0;
  std::string line_{};
  std::vector<std::uint8_t> unexplained_{};  // bytes since the last frame or line
  bool frames_shown_ = false;
  bool bytes_shown_ = false;
  bool streaming_ = false;
  bool hung_up_ = false;
  bool signals_ignored_ = false;
  std::optional<int> signal_{};
  rt::TimePoint asked_at_{};  // the last time
};

}  // namespace cargobay::cli
