#include "hal/web/token.hpp"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>

namespace cargobay::web {

std::optional<std::string> make_token() {
  std::array<std::uint8_t, 16> random{};
  if (getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size()))
    return std::nullopt;
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string token;
  for (const std::uint8_t byte : random) {
    token += kDigits[byte >> 4U];
    token += kDigits[byte & 0xfU];
  }
  return token;
}

bool is_token(std::string_view token) {
  static constexpr std::string_view kOthers = "-_.~";
  const auto allowed = [](char c) {
    const bool ascii = static_cast<unsigned char>(c) < 0x80;
    return (ascii && std::isalnum(static_cast<unsigned char>(c)) != 0) ||
           kOthers.find(c) != std::string_view::npos;
  };
  return token.size() >= kLeastTokenLength && token.size() <= kMostTokenLength &&
         std::ranges::all_of(token, allowed);
}

bool is_same_token(std::string_view presented, std::string_view expected) {
  // Volatile, so that no compiler ends the loop at the first difference.
  volatile unsigned difference = presented.size() == expected.size() ? 0U : 1U;
  for (std::size_t i = 0; i < presented.size(); ++i) {
    const char other = expected.empty() ? '\0' : expected[i % expected.size()];
    difference =
        difference | (static_cast<unsigned char>(presented[i]) ^ static_cast<unsigned char>(other));
  }
  return difference == 0 && !expected.empty();
}

std::optional<std::string_view> cookie(std::string_view header, std::string_view name) {
  while (!header.empty()) {
    const std::size_t end = header.find(';');
    std::string_view one = header.substr(0, end);
    header = end == std::string_view::npos ? std::string_view{} : header.substr(end + 1);
    one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
    if (one.starts_with(name) && one.substr(name.size()).starts_with('='))
      return one.substr(name.size() + 1);
  }
  return std::nullopt;
}

std::optional<std::string_view> bearer(std::string_view header) {
  constexpr std::string_view kScheme = "Bearer ";
  if (!header.starts_with(kScheme)) return std::nullopt;
  return header.substr(kScheme.size());
}

}  // namespace cargobay::web
