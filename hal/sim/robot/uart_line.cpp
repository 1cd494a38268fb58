#include "hal/sim/robot/uart_line.hpp"

#include <algorithm>

namespace cargobay::hal::sim {
namespace {

constexpr rt::Duration kInstant{1};

}  // namespace

bool UartLine::push(rt::Duration now, std::uint8_t value, std::uint32_t baud,
                    rt::Duration spacing) {
  if (flights_.full()) return false;
  rt::Duration start = std::max(now, free_at_);
  if (spacing > rt::Duration::zero()) start = std::max(start, last_start_ + spacing);
  last_start_ = start;
  const bool follows = start == free_at_ && baud == burst_baud_ && burst_bytes_ != 0;
  if (!follows) {
    burst_start_ = start;
    burst_bytes_ = 0;
    burst_baud_ = baud;
  }
  // Counted from the first byte of the burst, so that a rate that does not divide a second does not
  // drift.
  ++burst_bytes_;
  free_at_ = burst_start_ + bit_time(kBitsPerByte * burst_bytes_, baud);
  return flights_.push_back({.start = start, .end = free_at_, .baud = baud, .value = value});
}

std::optional<rt::Duration> UartLine::next_arrival(std::uint32_t baud) const {
  const std::optional<Sampled> next = sample(baud);
  if (!next) return std::nullopt;
  return next->arrival.time;
}

std::optional<rt::Duration> UartLine::batch_arrival(std::size_t count) const {
  if (flights_.empty() || count == 0) return std::nullopt;
  // The first one may have arrived already, with only its end still on the line.
  const std::size_t first = flights_.front().start < listen_from_ ? 1 : 0;
  if (first == flights_.size()) return std::nullopt;
  return flights_[std::min(first + count, flights_.size()) - 1].end;
}

std::optional<UartLine::Arrival> UartLine::pop(rt::Duration now, std::uint32_t baud) {
  pass_over_glitches(now, baud);
  const std::optional<Sampled> next = sample(baud);
  if (!next || next->arrival.time > now) return std::nullopt;
  listen_from_ = next->listen_from;
  forget_past();
  return next->arrival;
}

void UartLine::listen_again(rt::Duration now) {
  listen_from_ = std::max(listen_from_, now);
  forget_past();
}

void UartLine::cut_off(rt::Duration time) {
  if (free_at_ <= time) return;
  while (!flights_.empty() && flights_.back().end > time) flights_.pop_back();
  free_at_ = flights_.empty() ? time : flights_.back().end;
  last_start_ = std::min(last_start_, free_at_);
  burst_bytes_ = 0;
}

void UartLine::clear() {
  flights_.clear();
  burst_bytes_ = 0;
  free_at_ = rt::Duration{0};
}

bool UartLine::level_in(const Flight& flight, rt::Duration time) {
  const std::int64_t bit = (time - flight.start).count() * flight.baud / 1'000'000'000;
  if (bit <= 0) return false;
  if (bit > 8) return true;
  return ((static_cast<unsigned>(flight.value) >> static_cast<unsigned>(bit - 1)) & 1U) != 0;
}

bool UartLine::level(rt::Duration time) const {
  for (std::size_t i = 0; i < flights_.size() && flights_[i].start <= time; ++i) {
    if (time < flights_[i].end) return level_in(flights_[i], time);
  }
  return true;  // idle
}

std::optional<rt::Duration> UartLine::falling_edge(rt::Duration from) const {
  for (std::size_t i = 0; i < flights_.size(); ++i) {
    const Flight& flight = flights_[i];
    if (flight.end <= from) continue;
    if (flight.start >= from) return flight.start;
    for (std::int64_t bit = 2; bit <= 8; ++bit) {
      const rt::Duration edge = flight.start + bit_time(bit, flight.baud);
      if (edge < from || level_in(flight, edge)) continue;
      if (level_in(flight, flight.start + bit_time(bit - 1, flight.baud))) return edge;
    }
  }
  return std::nullopt;
}

std::optional<UartLine::Sampled> UartLine::sample(std::uint32_t baud) const {
  if (!flights_.empty()) {
    const Flight& next = flights_.front();
    if (next.start >= listen_from_ && next.baud == baud) {
      return Sampled{.arrival = {.time = next.end, .value = next.value},
                     .listen_from = next.start + bit_time(19, 2 * baud)};
    }
  }
  std::optional<rt::Duration> edge = falling_edge(listen_from_);
  while (edge && glitch(*edge, baud)) edge = falling_edge(*edge + kInstant);
  if (!edge) return std::nullopt;
  // In half bits from the edge: 3, 5 .. 17 are the middles of the data bits, 19 that of the stop
  // bit.
  unsigned value = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    if (level(*edge + bit_time(3 + 2 * static_cast<std::int64_t>(bit), 2 * baud)))
      value |= 1U << bit;
  }
  const rt::Duration stop = *edge + bit_time(19, 2 * baud);
  return Sampled{.arrival = {.time = *edge + bit_time(kBitsPerByte, baud),
                             .value = static_cast<std::uint8_t>(value),
                             .framing_error = !level(stop)},
                 .listen_from = stop};
}

// A UART checks the start bit again in its middle: if the line is high by then, it was a glitch.
bool UartLine::glitch(rt::Duration edge, std::uint32_t baud) const {
  return level(edge + bit_time(1, 2 * baud));
}

void UartLine::pass_over_glitches(rt::Duration now, std::uint32_t baud) {
  for (;;) {
    const std::optional<rt::Duration> edge = falling_edge(listen_from_);
    if (!edge || *edge + bit_time(1, 2 * baud) > now || !glitch(*edge, baud)) return;
    listen_from_ = *edge + kInstant;
    forget_past();
  }
}

void UartLine::forget_past() {
  while (!flights_.empty() && flights_.front().end <= listen_from_) flights_.pop_front();
  // At equal rates the receiver has finished with a byte half a bit before its end, and the rest is
  // the stop bit: no edge can come from it.
  while (!flights_.empty() &&
         flights_.front().start + bit_time(19, 2 * flights_.front().baud) <= listen_from_) {
    flights_.pop_front();
  }
}

}  // namespace cargobay::hal::sim
