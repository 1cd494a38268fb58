// One direction of a serial line, in virtual time: 8N1 at the sender's rate, and a receiver that
// samples the line at its own. If the two agree, bytes arrive unchanged; if not, what arrives is
// what a UART would make of that waveform.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/sim/ring_buffer.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

inline constexpr int kBitsPerByte = 10;  // start, eight data bits lowest first, stop

// The duration of `bits`, rounded up to whole nanoseconds. `baud` is not 0.
constexpr rt::Duration bit_time(std::int64_t bits, std::uint32_t baud) {
  return rt::Duration{(bits * 1'000'000'000 + baud - 1) / baud};
}

class UartLine {
 public:
  struct Arrival {
    rt::Duration time{};  // when the stop bit is over
    std::uint8_t value = 0;
    bool framing_error = false;  // the stop bit was low; the value is what the UART holds
  };

  // Room for `capacity` bytes that have not arrived.
  explicit UartLine(std::size_t capacity) : flights_{capacity} {}

  // The byte leaves at `now` or, if others are still leaving, after them, and at least `spacing`
  // after the beginning of the last. False if the line has no room: the byte is lost. `now` never
  // decreases; `baud` is not 0.
  bool push(rt::Duration now, std::uint8_t value, std::uint32_t baud,
            rt::Duration spacing = rt::Duration::zero());

  std::size_t room() const { return flights_.capacity() - flights_.size(); }
  // When everything pushed so far has left.
  rt::Duration free_at() const { return free_at_; }

  // When the next byte will have arrived at a receiver with that rate; nothing while the line is
  // idle. Bytes pushed later cannot make it earlier.
  std::optional<rt::Duration> next_arrival(std::uint32_t baud) const;
  // When everything pushed will have arrived or, if that is sooner, the `count`-th byte from now;
  // nothing while the line is idle. For a receiver that listens at the sender's rate.
  std::optional<rt::Duration> batch_arrival(std::size_t count) const;
  // The next byte that has arrived by `now`.
  std::optional<Arrival> pop(rt::Duration now, std::uint32_t baud);
  // The receiver has changed its rate: what has passed is gone, and a byte in progress is heard
  // from its middle.
  void listen_again(rt::Duration now);
  // The sender drops the bytes that would not have left by `time`.
  void cut_off(rt::Duration time);
  // Drops what is in flight.
  void clear();

 private:
  struct Flight {
    rt::Duration start{};
    rt::Duration end{};
    std::uint32_t baud = 1;
    std::uint8_t value = 0;
  };
  struct Sampled {
    Arrival arrival{};
    rt::Duration listen_from{};  // the middle of the stop bit: the next edge counts from there
  };

  static bool level_in(const Flight& flight, rt::Duration time);
  bool level(rt::Duration time) const;
  // The first at or after `from`.
  std::optional<rt::Duration> falling_edge(rt::Duration from) const;
  bool glitch(rt::Duration edge, std::uint32_t baud) const;
  // Skips those that are over by `now`.
  void pass_over_glitches(rt::Duration now, std::uint32_t baud);
  std::optional<Sampled> sample(std::uint32_t baud) const;
  void forget_past();

  RingBuffer<Flight> flights_;
  rt::Duration free_at_{0};
  rt::Duration last_start_ = rt::Duration::min() / 2;
  rt::Duration burst_start_{0};  // bytes in close succession are timed from here
  std::int64_t burst_bytes_ = 0;
  std::uint32_t burst_baud_ = 0;
  rt::Duration listen_from_{0};
};

}  // namespace cargobay::hal::sim
