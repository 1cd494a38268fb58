// A part of a text, like std::string_view::substr, but it never throws.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace cargobay::oi {

// The characters from `begin` on, `count` at most, as many as there are.
constexpr std::string_view slice(std::string_view text, std::size_t begin,
                                 std::size_t count = std::string_view::npos) {
  text.remove_prefix(std::min(begin, text.size()));
  text.remove_suffix(text.size() - std::min(count, text.size()));
  return text;
}

}  // namespace cargobay::oi
