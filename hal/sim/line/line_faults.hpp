// What goes wrong on the line: bytes are lost, flipped, duplicated or inserted, come late, in
// bunches, or not at all. The same seed does the same to the same bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/sim/random.hpp"
#include "hal/sim/ring_buffer.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

// The probability of each fault, per byte: 0 to 1.
struct ByteFaults {
  double lost = 0.0;
  double flipped = 0.0;  // one bit of it
  double duplicated = 0.0;
  double inserted = 0.0;  // a random byte after it
};

struct LineFaults {
  ByteFaults bytes{};
  rt::Duration jitter{0};  // each byte comes up to this much later, in order
  // What an FTDI adapter does: it passes on what it has each time its latency timer expires, or
  // when it has 62 bytes. 0: no adapter.
  rt::Duration latency_timer{0};
  // Every Nth frame, or anything else that comes in one go, is held back as a whole for `held_by`,
  // and what comes after it queues. 0: none.
  std::uint32_t held_every = 0;
  rt::Duration held_by{0};
  bool unplugged = false;  // nothing comes through

  bool any() const {
    return unplugged || jitter != rt::Duration{0} || latency_timer != rt::Duration{0} ||
           held_every != 0 || bytes.lost != 0.0 || bytes.flipped != 0.0 ||
           bytes.duplicated != 0.0 || bytes.inserted != 0.0;
  }
};

// One direction of a faulty line: bytes go in as they arrive and come out as they are let through.
class FaultyLine {
 public:
  FaultyLine(std::uint64_t seed, std::size_t capacity);

  LineFaults& faults() { return faults_; }
  const LineFaults& faults() const { return faults_; }

  // Bytes may bypass it: no fault is set, and no byte is held back.
  bool bypassed() const { return held_.empty() && !faults_.any(); }
  // The byte arrived at `now`, which never decreases.
  void push(rt::Duration now, std::uint8_t byte);
  // When the next byte is let through; nothing if none is held.
  std::optional<rt::Duration> next() const;
  std::optional<std::uint8_t> pop(rt::Duration now);

 private:
  struct Held {
    rt::Duration due{};
    std::uint8_t byte = 0;
  };
  static constexpr std::size_t kAdapterBytes = 62;  // of a 64-byte packet

  bool happens(double probability) { return probability > 0.0 && random_.uniform() < probability; }
  void hold(rt::Duration now, std::uint8_t byte);
  rt::Duration let_through_at(rt::Duration now);

  LineFaults faults_{};
  rt::Duration last_push_{0};
  std::uint32_t frames_ = 0;  // since held_every was seen
  Random random_;
  RingBuffer<Held> held_;  // let through in order, none before it is due
};

}  // namespace cargobay::hal::sim
