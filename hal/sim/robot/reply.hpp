// The answer in progress: what Sensors, Query List or Show Script asked for and is still to be
// sent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/fixed_list.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal::sim {

class Reply {
 public:
  // Of these packets, or of these bytes unchanged; at most 255. Only if no reply is under way.
  void begin_packets(std::span<const std::uint8_t> ids) { begin(Kind::packets, ids); }
  void begin_bytes(std::span<const std::uint8_t> bytes) { begin(Kind::bytes, bytes); }
  void clear() {
    parts_.clear();
    sent_ = 0;
  }

  bool under_way() const { return sent_ < parts_.size(); }
  // Its next part, a packet's id or a byte. Only while one is under way.
  bool is_packet() const { return kind_ == Kind::packets; }
  std::uint8_t front() const { return parts_[sent_]; }
  void pop() { ++sent_; }

 private:
  enum class Kind : std::uint8_t { packets, bytes };

  void begin(Kind kind, std::span<const std::uint8_t> parts) {
    clear();
    kind_ = kind;
    (void)parts_.append(parts);  // no command asks for more
  }

  Kind kind_ = Kind::packets;
  oi::FixedList<std::uint8_t, oi::kMaxQueryPackets> parts_{};
  std::size_t sent_ = 0;
};

}  // namespace cargobay::hal::sim
