// The commands of one write, and what the port left of the previous one.
//
// A port whose queue is full takes only part of what it is given. If that part ends inside a
// command, the robot waits for the rest and takes whatever comes next for it: so the rest comes
// next. Commands that were not begun are forgotten, since newer ones replace them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "hal/cycle/request.hpp"
#include "hal/sensing/frame_lists.hpp"
#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/fixed_list.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

// One thread; no allocation.
class Outgoing {
 public:
  // What reached the robot whole; of each kind, the last.
  struct Taken {
    bool drive = false;
    rt::WheelSpeeds speeds{};
    bool missed_drive = false;  // one did not, or not whole
    bool fill = false;
    bool request = false;  // or begun: its rest comes first in the next write
    bool list = false;
    FrameList streamed = FrameList::reading;
  };

  // The dialect must outlive it.
  explicit Outgoing(const oi::Dialect& dialect = oi::kCreate) : dialect_{dialect} {}

  // DriveDirect in whole mm/s, within the robot's range.
  void add_drive(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING;
  void add_list(FrameList list) CARGOBAY_NONBLOCKING;
  // Completes whatever command the robot may have received the beginning of: as data, 0 is no
  // speed; as an opcode, it does nothing. At most kMostFill.
  static constexpr std::size_t kMostFill = 160;
  void add_fill(std::size_t zeros) CARGOBAY_NONBLOCKING;
  // Safe or Full.
  void add_mode(oi::Mode mode) CARGOBAY_NONBLOCKING;
  // A whole command, as encoded; at most Request::kMostBytes.
  void add_request(std::span<const std::uint8_t> command) CARGOBAY_NONBLOCKING;

  // All of it, the rest of the previous write first.
  std::span<const std::uint8_t> bytes() const CARGOBAY_NONBLOCKING { return bytes_; }
  bool empty() const CARGOBAY_NONBLOCKING { return bytes_.empty(); }
  // Whether a DriveDirect is in it, or the rest of one.
  bool drives() const CARGOBAY_NONBLOCKING;

  // The port took the first `count` bytes. Keeps only the rest of a command that it took in part.
  Taken took(std::size_t count) CARGOBAY_NONBLOCKING;

 private:
  enum class Kind : std::uint8_t { drive, list, mode, fill, request };
  struct Piece {
    Kind kind = Kind::drive;
    std::size_t end = 0;  // in bytes_
    rt::WheelSpeeds speeds{};
    FrameList list = FrameList::reading;
  };
  // A Stream list is the longest of the loop's own commands.
  static constexpr std::size_t kMostCommandBytes = 2 + oi::kMaxStreamPackets;
  static constexpr std::size_t kMostPieces = 6;  // a rest, and one of each kind

  template <typename Encoded>
  void add(const Piece& piece, const Encoded& encoded) CARGOBAY_NONBLOCKING {
    if (encoded.has_value()) append(piece, *encoded);  // by construction it can be encoded
  }
  void append(Piece piece, std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING;

  static void note(const Piece& piece, Taken& taken) CARGOBAY_NONBLOCKING;
  void clear() CARGOBAY_NONBLOCKING;
  void keep(Piece piece, std::size_t from) CARGOBAY_NONBLOCKING;

  // The rest may be that of the longest request, or of a fill.
  static constexpr std::size_t kMostRestBytes = std::max(Request::kMostBytes, kMostFill);
  static constexpr std::size_t kMostBytes =
      kMostRestBytes + 3 * kMostCommandBytes + kMostFill + Request::kMostBytes;
  const oi::Dialect& dialect_;
  oi::FixedList<std::uint8_t, kMostBytes> bytes_{};
  oi::FixedList<Piece, kMostPieces> pieces_{};
  bool begins_with_rest_ = false;
};

}  // namespace cargobay::hal
