// The name that a misspelt word probably meant.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace cargobay::oi {

// Consider every name, then ask. A word is near a name if it differs only in capitals, hyphens, or
// one letter in three added, lost or changed.
class NearestName {
 public:
  constexpr explicit NearestName(std::string_view word) : word_{word} {}

  constexpr void consider(std::string_view name) {
    const std::size_t most = (std::max(word_.size(), name.size()) + 2) / 3;
    if (word_.size() > kLongest || name.size() > kLongest) return;
    const std::size_t distance = distance_to(name);
    if (distance > most || distance >= name.size() || distance >= best_) return;
    best_ = distance;
    name_ = name;
  }
  // Empty if none is near.
  constexpr std::string_view name() const { return name_; }

 private:
  static constexpr std::size_t kLongest = 40;

  static constexpr char folded(char letter) {
    if (letter >= 'A' && letter <= 'Z') return static_cast<char>(letter - 'A' + 'a');
    return letter == '-' ? '_' : letter;
  }

  // Levenshtein distance, one row at a time.
  constexpr std::size_t distance_to(std::string_view name) const {
    std::array<std::size_t, kLongest + 1> row{};
    for (std::size_t i = 0; i <= name.size(); ++i) row[i] = i;
    for (std::size_t at = 0; at < word_.size(); ++at) {
      std::size_t diagonal = row[0];
      row[0] = at + 1;
      for (std::size_t i = 1; i <= name.size(); ++i) {
        const std::size_t changed = diagonal + (folded(word_[at]) == name[i - 1] ? 0 : 1);
        diagonal = row[i];
        row[i] = std::min({row[i] + 1, row[i - 1] + 1, changed});
      }
    }
    return row[name.size()];
  }

  std::string_view word_;
  std::string_view name_{};
  std::size_t best_ = kLongest + 1;
};

}  // namespace cargobay::oi
