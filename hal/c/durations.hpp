// Times that a program passes in nanoseconds.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "hal/c/errors.hpp"

namespace cargobay::c {

// A day: far longer than anything here takes, and far from overflow when times are added.
inline constexpr std::int64_t kLongestNs = std::int64_t{86'400} * 1'000'000'000;

// CARGOBAY_OK for 0 to kLongestNs.
inline int check_duration(const char* name, std::int64_t duration_ns) noexcept {
  if (duration_ns >= 0 && duration_ns <= kLongestNs) return CARGOBAY_OK;
  std::array<char, 96> said{};
  // Cannot fail, and fits.
  const int length =
      std::snprintf(said.data(), said.size(), "`%s` is %s: give 0 to 86400000000000 ns", name,
                    duration_ns < 0 ? "negative" : "more than a day");
  return bad_argument({said.data(), static_cast<std::size_t>(length)});
}

}  // namespace cargobay::c
