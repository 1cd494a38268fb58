// Random numbers that are the same for a given seed on every machine; those of the standard
// library's distributions are not.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace cargobay::hal::sim {

// xoshiro256** (Blackman, Vigna), seeded by splitmix64.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) {
    for (std::uint64_t& word : state_) {
      seed += 0x9e3779b97f4a7c15U;
      std::uint64_t mixed = seed;
      mixed = (mixed ^ (mixed >> 30U)) * 0xbf58476d1ce4e5b9U;
      mixed = (mixed ^ (mixed >> 27U)) * 0x94d049bb133111ebU;
      word = mixed ^ (mixed >> 31U);
    }
  }

  constexpr std::uint64_t next() {
    const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
    const std::uint64_t shifted = state_[1] << 17U;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }
  // From 0 up to, but not including, 1.
  constexpr double uniform() { return static_cast<double>(next() >> 11U) * 0x1p-53; }
  // From 0 up to, but not including, `bound`, which is not 0. The modulo bias is below 1e-9.
  constexpr std::uint32_t below(std::uint32_t bound) {
    return static_cast<std::uint32_t>(next() % bound);
  }
  // Mean 0, standard deviation 1, never beyond 6: the sum of twelve uniform numbers, less its mean.
  // Only additions, so that no two mathematical libraries can disagree.
  constexpr double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::array<std::uint64_t, 4> state_{};
};

}  // namespace cargobay::hal::sim
