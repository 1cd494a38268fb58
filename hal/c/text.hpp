// Text for a C program's buffer, and what to say if the buffer is invalid.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace cargobay::c {

inline constexpr const char* kBadOut =
    "the struct to be filled is NULL, or its `size` is not set: set it to its sizeof";

// Copies and NUL-terminates; truncates what does not fit. Returns the full length.
inline int copy_text(std::string_view text, char* buffer, std::size_t size) {
  if (buffer != nullptr && size > 0) {
    const std::size_t length = std::min(text.size(), size - 1);
    std::memcpy(buffer, text.data(), length);
    buffer[length] = '\0';
  }
  return static_cast<int>(text.size());
}

}  // namespace cargobay::c
