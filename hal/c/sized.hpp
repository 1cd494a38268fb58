// The size rule for structs that grow, the same as the kernel's (include/linux/uaccess.h,
// copy_struct_from_user): members missing from a shorter struct are 0, extra members of a longer
// one must be 0.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "rt/nonblocking.hpp"

namespace cargobay::c {

// Each struct begins with `size`, in bytes, as its program knows it. kMostGrowth is how much longer
// a later version may have made it: anything above is not a size but what an uninitialised member
// holds, and would lead far outside the struct.
inline constexpr std::size_t kLeastSize = sizeof(std::uint32_t);
inline constexpr std::size_t kMostGrowth = 4096;

// False for null, and for a size that is too short or longer than any version will make it.
template <typename Struct>
[[nodiscard]] bool sized(const Struct* given) CARGOBAY_NONBLOCKING {
  return given != nullptr && given->size >= kLeastSize &&
         given->size <= sizeof(Struct) + kMostGrowth;
}

// Copies from the program. False if `given` is not sized(), or asks for something this library does
// not know; do not use `known` then.
template <typename Struct>
[[nodiscard]] bool take(const Struct* given, Struct& known) CARGOBAY_NONBLOCKING {
  known = Struct{};
  if (!sized(given)) return false;
  const std::size_t size = given->size;
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(given);
  for (std::size_t i = sizeof(Struct); i < size; ++i) {
    if (bytes[i] != 0) return false;
  }
  std::memcpy(static_cast<void*>(&known), bytes, std::min(size, sizeof(Struct)));
  known.size = static_cast<std::uint32_t>(sizeof(Struct));
  return true;
}

// Copies to the program, as much as it has room for; its size stays. False if `wanted` is not
// sized(); nothing is written then.
template <typename Struct>
[[nodiscard]] bool give(const Struct& known, Struct* wanted) CARGOBAY_NONBLOCKING {
  if (!sized(wanted)) return false;
  const std::size_t size = wanted->size;
  auto* bytes = reinterpret_cast<std::uint8_t*>(wanted);
  const std::size_t both = std::min(size, sizeof(Struct));
  std::memcpy(bytes + kLeastSize, reinterpret_cast<const std::uint8_t*>(&known) + kLeastSize,
              both - kLeastSize);
  if (size > both) std::memset(bytes + both, 0, size - both);
  return true;
}

}  // namespace cargobay::c
