// For letters of names in either case. ASCII only: independent of the locale.
#pragma once

namespace cargobay::oi {

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace cargobay::oi
