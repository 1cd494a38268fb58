// A pseudo-terminal reports the rate it is set to, but not which bytes were written before that;
// and those come late, in pieces. A host that sends Baud and sets its port immediately would seem
// to have sent the command at the new rate.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

// How many of the bytes were written before the port was set to `baud`: up to and including a Baud
// command that asks for this rate; none if there is no such command.
constexpr std::size_t sent_before_change(std::span<const std::uint8_t> bytes, std::uint32_t baud) {
  const auto code = oi::kCreate.baud_code(baud);
  if (!code) return 0;
  for (std::size_t end = bytes.size(); end >= 2; --end) {
    if (bytes[end - 2] == oi::Baud::kOpcode && bytes[end - 1] == *code) return end;
  }
  return 0;
}

// Lasts from a change of the host's rate until it is known what was sent before; keeps the bytes.
class HostRateChange {
 public:
  static constexpr std::size_t kMostBytes = 512;

  // The host has changed its rate, and the robot listened at the former one. `last` is the last
  // byte that came before.
  void begin(std::uint32_t former, std::uint32_t baud, std::uint8_t last, rt::TimePoint now) {
    *this = HostRateChange{};
    last_ = last;
    former_ = former;
    baud_ = baud;
    began_at_ = now;
  }
  bool under_way() const { return former_ != 0; }
  std::uint32_t former() const { return former_; }
  std::uint32_t baud() const { return baud_; }
  // How much room is left of `in_all`, the room for everything that is kept in the end.
  std::size_t room(std::size_t in_all) const {
    const std::size_t most = std::min(in_all, kept_.size());
    return most - std::min(size_, most);
  }
  // Takes no more than there is room for.
  void keep(std::span<const std::uint8_t> bytes, rt::TimePoint now) {
    if (size_ == 0) kept_since_ = now;
    for (const std::uint8_t byte : bytes) kept_[size_++] = byte;
  }
  std::span<const std::uint8_t> kept() const { return std::span{kept_}.first(size_); }
  // How many of the kept bytes were sent at the former rate.
  std::size_t before() const {
    const std::size_t whole = sent_before_change(kept(), baud_);
    if (whole > 0 || size_ == 0) return whole;
    const std::array<std::uint8_t, 2> cut{last_, kept_[0]};
    return sent_before_change(cut, baud_) / 2;
  }

  // When the decision is due: at once if there is a Baud command, else when the rest of one would
  // have come. A host that sent one waits for 100 ms (OI p. 7).
  rt::TimePoint decided_at() const {
    if (before() > 0 || size_ == kept_.size()) return kept_since_;
    if (size_ == 0) return began_at_ + kPause;
    const bool in_baud = kept_[size_ - 1] == oi::Baud::kOpcode;
    return kept_since_ + (in_baud ? kPause : kPieces);
  }
  void end() { former_ = 0; }

 private:
  static constexpr rt::Duration kPause = std::chrono::milliseconds{100};
  static constexpr rt::Duration kPieces = std::chrono::milliseconds{5};

  std::uint32_t former_ = 0;  // 0: no change is under way
  std::uint32_t baud_ = 0;
  std::uint8_t last_ = 0;
  rt::TimePoint began_at_{};
  rt::TimePoint kept_since_{};
  std::array<std::uint8_t, kMostBytes> kept_{};
  std::size_t size_ = 0;
};

}  // namespace cargobay::hal::sim
