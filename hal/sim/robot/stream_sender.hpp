// The list of packets that the robot streams, and whether it streams (OI p. 14).
#pragma once

#include <cstdint>
#include <span>

#include "oi/dialect.hpp"
#include "oi/fixed_list.hpp"
#include "oi/limits.hpp"
#include "oi/packet_table.hpp"

namespace cargobay::hal::sim {

class StreamSender {
 public:
  // A new list starts the stream, an empty one ends it. Ids that are not packets are skipped. A
  // list longer than the manual's 43 is ignored: the stream stays as it was.
  void start(std::span<const std::uint8_t> packet_ids, const oi::Dialect& dialect) {
    if (packet_ids.size() > oi::kMaxStreamPackets) return;
    packets_.clear();
    for (const std::uint8_t id : packet_ids) {
      if (dialect.find_packet(id) != nullptr)
        (void)packets_.push_back(id);  // never full: checked above
    }
    running_ = true;
  }
  void pause() { running_ = false; }
  void resume() { running_ = true; }
  void reset() {
    packets_.clear();
    running_ = false;
  }

  bool running() const { return running_ && !packets_.empty(); }
  std::span<const std::uint8_t> packets() const { return packets_; }

 private:
  oi::FixedList<std::uint8_t, oi::kMaxStreamPackets> packets_{};
  bool running_ = false;
};

}  // namespace cargobay::hal::sim
