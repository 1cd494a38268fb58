// Units of the Open Interface as types: what the bytes on the wire count.
#pragma once

#include <compare>
#include <cstdint>
#include <string_view>

namespace cargobay::oi {

// An integer in one unit. Its constructor is explicit, so that a speed is never taken for a radius.
// int32_t holds every value on the wire, signed or not; the range of each use is in the command
// table or the packet table.
template <typename Unit>
struct Quantity {
  std::int32_t value = 0;

  constexpr Quantity() = default;
  constexpr explicit Quantity(std::int32_t count) : value{count} {}
  friend constexpr auto operator<=>(const Quantity&, const Quantity&) = default;
  constexpr Quantity operator-() const { return Quantity{-value}; }
};

using MmPerSec = Quantity<struct MmPerSecUnit>;
using Mm = Quantity<struct MmUnit>;
using Deg = Quantity<struct DegUnit>;
using MilliVolt = Quantity<struct MilliVoltUnit>;
using MilliAmp = Quantity<struct MilliAmpUnit>;
using MilliAmpHour = Quantity<struct MilliAmpHourUnit>;
using DegCelsius = Quantity<struct DegCelsiusUnit>;
using Tenths = Quantity<struct TenthOfSecondUnit>;      // Wait Time, OI p. 15
using SixtyFourths = Quantity<struct SixtyFourthUnit>;  // note durations, OI p. 11

// The unit of a table entry.
enum class Unit : std::uint8_t {
  none,
  mm,
  mm_per_sec,
  deg,
  millivolt,
  milliamp,
  milliamp_hour,
  deg_celsius,
  tenth_of_second,
  sixty_fourth_of_second,
};

// The unit's symbol as printed; empty for none.
constexpr std::string_view symbol(Unit unit) {
  switch (unit) {
    case Unit::none: return "";
    case Unit::mm: return "mm";
    case Unit::mm_per_sec: return "mm/s";
    case Unit::deg: return "deg";
    case Unit::millivolt: return "mV";
    case Unit::milliamp: return "mA";
    case Unit::milliamp_hour: return "mAh";
    case Unit::deg_celsius: return "deg C";
    case Unit::tenth_of_second: return "s/10";
    case Unit::sixty_fourth_of_second: return "s/64";
  }
  return "";
}

}  // namespace cargobay::oi
