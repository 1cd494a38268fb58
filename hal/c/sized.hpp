// The size rule of structs that grow, as the kernel has it for its own (include/linux/uaccess.h,
// copy_struct_from_user): what a shorter one lacks is 0, what a longer one has more must be.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "rt/nonblocking.hpp"

namespace cargobay::c {

// Each of them begins with `size`, in bytes, as its program knows it. By so much may a later
// version have made the struct longer: beyond that the number is no size, but what an uninitialised
// member holds, and would lead far away from the struct.
inline constexpr std::size_t kLeastSize = sizeof(std::uint32_t);
inline constexpr std::size_t kMostGrowth = 4096;

// False for null, and for what is shorter than its size or longer than any version will make it.
template <typename Struct>
[[nodiscard]] bool sized(const Struct* given) CARGOBAY_NONBLOCKING {
  return given != nullptr && given->size >= kLeastSize &&
         given->size <= sizeof(Struct) + kMostGrowth;
}

// From the program. False where `given` is not sized(), or asks for what this library does not
// know; `known` is then not to be used.
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

// To the program, as much as it has room for; its size stays. False where `wanted` is not sized(),
// and nothing is written.
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
