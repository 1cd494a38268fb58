// Text for a C program's buffer, and what is said where it is no good.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace cargobay::c {

inline constexpr const char* kBadOut =
    "the struct to be filled is NULL, or its `size` is not set: set it to its sizeof";

// Copies with a 0 behind it, cut off where it does not fit. Returns the length of all of it.
inline int copy_text(std::string_view text, char* buffer, std::size_t size) {
  if (buffer != nullptr && size > 0) {
    const std::size_t length = std::min(text.size(), size - 1);
    std::memcpy(buffer, text.data(), length);
    buffer[length] = '\0';
  }
  return static_cast<int>(text.size());
}

}  // namespace cargobay::c
