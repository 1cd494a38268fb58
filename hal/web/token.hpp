// The token that lets a client in from beyond the loopback.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cargobay::web {

inline constexpr std::size_t kLeastTokenLength = 8;
inline constexpr std::size_t kMostTokenLength = 128;

// 128 bits of the kernel's, as 32 hexadecimal digits; nothing if it has none. Any thread.
std::optional<std::string> make_token();

// Whether `token` may be one: letters, digits, `-`, `_`, `.` and `~`, which stand in a link as they
// are, and neither too few nor too many of them.
bool is_token(std::string_view token);

// In a time that depends on the length of `presented` alone.
bool is_same_token(std::string_view presented, std::string_view expected);

// What `name` is set to in a Cookie header, or nothing. The first, if it is there twice.
std::optional<std::string_view> cookie(std::string_view header, std::string_view name);

// The token of `Bearer TOKEN`, or nothing.
std::optional<std::string_view> bearer(std::string_view header);

}  // namespace cargobay::web
