#include "hal/cycle/outgoing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace cargobay::hal {
namespace {

constexpr std::array<std::uint8_t, Outgoing::kMostFill> kZeros{};

oi::MmPerSec to_wire(double speed_mm_s) CARGOBAY_NONBLOCKING {
  return oi::MmPerSec{static_cast<std::int32_t>(std::lrint(speed_mm_s))};
}

}  // namespace

void Outgoing::add_drive(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  add({.kind = Kind::drive, .speeds = speeds},
      oi::encode(
          oi::DriveDirect{.left = to_wire(speeds.left_mm_s), .right = to_wire(speeds.right_mm_s)}));
}

void Outgoing::add_list(FrameList list) CARGOBAY_NONBLOCKING {
  add({.kind = Kind::list, .list = list}, oi::encode(oi::Stream{dialect_.list(list)}));
}

void Outgoing::add_mode(oi::Mode mode) CARGOBAY_NONBLOCKING {
  if (mode == oi::Mode::full) {
    add({.kind = Kind::mode}, oi::encode(oi::Full{}));
  } else {
    add({.kind = Kind::mode}, oi::encode(oi::Safe{}));
  }
}

void Outgoing::add_fill(std::size_t zeros) CARGOBAY_NONBLOCKING {
  if (zeros == 0) return;
  append({.kind = Kind::fill}, std::span{kZeros}.first(std::min(zeros, kMostFill)));
}

void Outgoing::add_request(std::span<const std::uint8_t> command) CARGOBAY_NONBLOCKING {
  append({.kind = Kind::request}, command);
}

void Outgoing::append(Piece piece, std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING {
  if (pieces_.full() || !bytes_.append(bytes)) return;  // by construction there is room
  piece.end = bytes_.size();
  (void)pieces_.push_back(piece);
}

bool Outgoing::drives() const CARGOBAY_NONBLOCKING {
  return std::any_of(pieces_.begin(), pieces_.end(),
                     [](const Piece& piece) { return piece.kind == Kind::drive; });
}

Outgoing::Taken Outgoing::took(std::size_t count) CARGOBAY_NONBLOCKING {
  Taken taken;
  std::optional<Piece> rest;
  std::size_t begin = 0;
  for (const Piece& piece : pieces_) {
    const bool whole = piece.end <= count;
    const bool begun = begin < count || (begin == 0 && begins_with_rest_);
    if (whole) note(piece, taken);
    if (!whole && begun) rest = piece;
    if (begun && piece.kind == Kind::request) taken.request = true;
    if (!whole && piece.kind == Kind::drive) taken.missed_drive = true;
    begin = piece.end;
  }
  if (rest) {
    keep(*rest, count);
  } else {
    clear();
  }
  return taken;
}

void Outgoing::clear() CARGOBAY_NONBLOCKING {
  bytes_.clear();
  pieces_.clear();
  begins_with_rest_ = false;
}

void Outgoing::note(const Piece& piece, Taken& taken) CARGOBAY_NONBLOCKING {
  if (piece.kind == Kind::drive) {
    taken.drive = true;
    taken.speeds = piece.speeds;
  } else if (piece.kind == Kind::list) {
    taken.list = true;
    taken.streamed = piece.list;
  } else if (piece.kind == Kind::fill) {
    taken.fill = true;
  }
}

// Keeps only what comes after `from` in this piece.
void Outgoing::keep(Piece piece, std::size_t from) CARGOBAY_NONBLOCKING {
  const auto old = bytes_;
  clear();
  (void)bytes_.append(std::span{old}.subspan(from, piece.end - from));  // less than there was
  piece.end = bytes_.size();
  (void)pieces_.push_back(piece);
  begins_with_rest_ = true;
}

}  // namespace cargobay::hal
