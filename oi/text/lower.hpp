// Letters of names that may be written either way. ASCII only: no locale has a say.
#pragma once

namespace cargobay::oi {

constexpr char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace cargobay::oi
