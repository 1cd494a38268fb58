// Which of its robot's frame lists (oi/frame_list.hpp) a frame is of, and which of them are
// streamed only on request.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "oi/bit_set.hpp"
#include "oi/dialect.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_budget.hpp"
#include "rt/axes.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal {

using oi::FrameList;

// A multiple of half the PL011's FIFO, on every Raspberry Pi: no wait for its receive time-out.
static_assert(oi::kCreate.frame_bytes % oi::kPl011HalfFifoPi0To3 == 0);
static_assert(oi::kCreate.frame_bytes % oi::kPl011HalfFifoPi4And5 == 0);

// The list of a frame with exactly these packets; nothing if it is of none.
inline std::optional<FrameList> list_of(const oi::SensorValues& frame, const oi::Dialect& dialect)
    CARGOBAY_NONBLOCKING {
  for (std::size_t i = 0; i < oi::kFrameLists; ++i) {
    if (frame.present() == dialect.listed[i]) return static_cast<FrameList>(i);
  }
  return std::nullopt;
}

// Which counters a frame of the list reads.
constexpr rt::Axes axes_of(FrameList list) CARGOBAY_NONBLOCKING {
  switch (list) {
    case FrameList::reading: return rt::kBothAxes;
    case FrameList::distance:
    case FrameList::distance_buttons: return {.distance = true};
    case FrameList::angle: return {.turn = true};
    case FrameList::hazards:
    case FrameList::battery:
    case FrameList::signals_left:
    case FrameList::signals_right:
    case FrameList::outputs: break;
  }
  return {};
}

// Those that are streamed only on request, in the order of FrameList.
enum class ExtraList : std::uint8_t { signals_left, signals_right, outputs };
using ExtraLists = oi::BitSet<ExtraList>;
inline constexpr int kExtraLists = 3;
inline constexpr ExtraLists kAllExtraLists{(1U << kExtraLists) - 1U};

constexpr FrameList list_of_extra(ExtraList extra) {
  return static_cast<FrameList>(static_cast<unsigned>(FrameList::signals_left) +
                                static_cast<unsigned>(extra));
}

}  // namespace cargobay::hal
