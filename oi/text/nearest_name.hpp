// The name that a misspelt word probably meant.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace cargobay::oi {

namespace detail {

// Those of a word without separators, in lower case; none of a word that is too long.
class Letters {
 public:
  static constexpr std::size_t kMost = 40;

  constexpr explicit Letters(std::string_view word) {
    if (word.size() > kMost) return;
    for (const char c : word) {
      if (c == '-' || c == '_') continue;
      all_[count_++] = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
  constexpr std::size_t size() const { return count_; }
  constexpr char operator[](std::size_t at) const { return all_[at]; }
  constexpr Letters sorted() const {
    Letters letters = *this;
    std::sort(letters.all_.begin(), letters.all_.begin() + static_cast<std::ptrdiff_t>(count_));
    return letters;
  }
  // Whether the letter at this place is the same as the next.
  constexpr bool doubled(std::size_t at) const {
    return at + 1 < count_ && all_[at] == all_[at + 1];
  }
  friend constexpr bool operator==(const Letters&, const Letters&) = default;

 private:
  std::array<char, kMost> all_{};
  std::size_t count_ = 0;
};

}  // namespace detail

// Consider every name, then ask. Letters are compared without regard to case, and _ or - between
// words not at all.
class NearestName {
 public:
  constexpr explicit NearestName(std::string_view word) : word_{word} {}

  // May be meant if at most a third of the letters were added, lost, changed or swapped.
  constexpr void consider(std::string_view name) { consider(name, false); }
  // For a name that must not be suggested for another word: what moves the robot, or takes a guard
  // away. May be meant only by a misspelling: the first letter is right and one more letter wrong,
  // or two in names of eight letters or more. In names of fewer than five, where one letter makes
  // another word (spot, slot), letters may be swapped, lost or doubled, but not changed.
  constexpr void consider_misspelt(std::string_view name) { consider(name, true); }
  // Empty if none is near.
  constexpr std::string_view name() const { return name_; }

 private:
  using Letters = detail::Letters;
  static constexpr std::size_t kShort = 5;
  static constexpr std::size_t kLong = 8;

  constexpr void consider(std::string_view name, bool only_misspelt) {
    const Letters word{word_};
    const Letters meant{name};
    const std::size_t distance = distance_between(word, meant);
    const std::size_t most = (std::max(word.size(), meant.size()) + 1) / 3;
    if (distance >= meant.size() || distance > most || distance >= best_) return;
    if (only_misspelt && !is_misspelt(word, meant, distance)) return;
    best_ = distance;
    name_ = name;
  }

  static constexpr bool is_misspelt(const Letters& word, const Letters& meant,
                                    std::size_t distance) {
    if (distance == 0) return true;
    if (word.size() == 0 || word[0] != meant[0]) return false;
    if (distance > (meant.size() >= kLong ? 2U : 1U)) return false;
    if (meant.size() >= kShort || word.size() < meant.size()) return true;
    if (word.size() == meant.size()) return word.sorted() == meant.sorted();
    for (std::size_t at = 0; at < word.size(); ++at) {
      if (word.doubled(at) && !meant.doubled(at)) return true;
    }
    return false;
  }

  // Letters added, lost, changed, or swapped with the next one: the optimal string alignment
  // distance, a row at a time.
  static constexpr std::size_t distance_between(const Letters& word, const Letters& name) {
    using Row = std::array<std::size_t, Letters::kMost + 1>;
    Row before_last{};
    Row last{};
    Row row{};
    for (std::size_t i = 0; i <= name.size(); ++i) row[i] = i;
    for (std::size_t at = 1; at <= word.size(); ++at) {
      before_last = last;
      last = row;
      row[0] = at;
      for (std::size_t i = 1; i <= name.size(); ++i) {
        const bool same = word[at - 1] == name[i - 1];
        row[i] = std::min({last[i] + 1, row[i - 1] + 1, last[i - 1] + (same ? 0U : 1U)});
        const bool swapped =
            at > 1 && i > 1 && word[at - 1] == name[i - 2] && word[at - 2] == name[i - 1];
        if (swapped) row[i] = std::min(row[i], before_last[i - 2] + 1);
      }
    }
    return row[name.size()];
  }

  std::string_view word_;
  std::string_view name_{};
  std::size_t best_ = Letters::kMost + 1;
};

// Whether they are the same letters, but for case and separators; not for words without any, or of
// more than 40 characters.
constexpr bool is_spelt_alike(std::string_view word, std::string_view name) {
  const detail::Letters letters{word};
  return letters.size() > 0 && letters == detail::Letters{name};
}

}  // namespace cargobay::oi
