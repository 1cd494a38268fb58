// The command line of a campaign over random plants: how many, and which.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <span>

#include "tests/campaign/number.hpp"

namespace cargobay::campaign {

struct Draws {
  std::uint64_t count = 0;
  std::uint64_t first = 1;  // seed
};

// Of `PROGRAM [N [SEED]]`; says how it is used, and returns nothing, if that is not what it says.
inline std::optional<Draws> draws_of(int argc, char** argv, const char* program,
                                     std::uint64_t count) {
  const std::span<char*> arguments{argv, static_cast<std::size_t>(argc)};
  std::uint64_t values[] = {count, 1};
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const auto value = number(arguments[i]);
    if (i > 2 || !value || *value == 0) {
      std::fprintf(stderr, "usage: %s [N [SEED]], both above 0\n", program);
      return std::nullopt;
    }
    values[i - 1] = *value;
  }
  return Draws{.count = values[0], .first = values[1]};
}

}  // namespace cargobay::campaign
