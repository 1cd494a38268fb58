// Sets of flags as the names of those that are set, and back.
#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "hal/columns/value.hpp"
#include "hal/sensing/events.hpp"
#include "oi/bit_set.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {

// How many there are, from bit 0 on.
template <typename Flag>
inline constexpr unsigned kFlags = static_cast<unsigned>(oi::kValueNames<Flag>.size());
template <>
inline constexpr unsigned kFlags<Hazard> = static_cast<unsigned>(Hazard::charger) + 1;
template <>
inline constexpr unsigned kFlags<Limit> = static_cast<unsigned>(Limit::acceleration) + 1;
template <>
inline constexpr unsigned kFlags<Wheel> = static_cast<unsigned>(Wheel::right) + 1;

template <typename Flag>
std::vector<std::string_view> names_of(oi::BitSet<Flag> set) {
  using oi::name;
  std::vector<std::string_view> names;
  for (unsigned bit = 0; bit < kFlags<Flag>; ++bit) {
    const auto flag = static_cast<Flag>(bit);
    if (set.has(flag)) names.push_back(name(flag));
  }
  return names;
}

// Of a list of words. Those that are no flag's name are passed over.
template <typename Flag>
oi::BitSet<Flag> flags_named(const Value& words) {
  using oi::name;
  const auto& list = std::get<std::vector<std::string_view>>(words);
  oi::BitSet<Flag> set;
  for (unsigned bit = 0; bit < kFlags<Flag>; ++bit) {
    const auto flag = static_cast<Flag>(bit);
    if (std::ranges::find(list, name(flag)) != list.end()) set = set.with(flag);
  }
  return set;
}

}  // namespace cargobay::hal
