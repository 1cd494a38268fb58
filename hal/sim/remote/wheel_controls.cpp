#include "hal/sim/remote/wheel_controls.hpp"

#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/next_word.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kLongestHardshipMs = 3'600'000.0;

struct Sides {
  bool left = false;
  bool right = false;
};

std::optional<Sides> sides_named(std::string_view word) {
  const bool both = word == "both";
  const Sides sides{.left = both || word == "left", .right = both || word == "right"};
  if (!sides.left && !sides.right) return std::nullopt;
  return sides;
}

// Milliseconds as the last word; for ever if there is none.
std::optional<rt::Duration> period_at_end(std::string_view rest) {
  const std::string_view word = next_word(rest);
  if (word.empty()) return rt::Duration::max();
  const std::optional<double> ms = to_number(word, 0.0, kLongestHardshipMs);
  if (!ms || !no_more_words(rest)) return std::nullopt;
  return rt::Duration{static_cast<std::int64_t>(*ms * 1e6)};
}

}  // namespace

std::optional<std::string> change_plant(std::string_view rest, Cable& cable) {
  if (no_more_words(rest)) return std::nullopt;
  WheelParameters wheels = cable.device().parameters().wheels;
  if (const std::string wrong = set_plant(rest, wheels); !wrong.empty()) return "error: " + wrong;
  cable.device().set_wheels(wheels);
  return "";
}

std::optional<std::string> change_load(std::string_view rest, Cable& cable) {
  const std::optional<double> part = to_number(next_word(rest), kLoad.least, kLoad.most);
  std::string_view after_side = rest;
  std::optional<Sides> sides = sides_named(next_word(after_side));
  if (sides) rest = after_side;
  const std::optional<rt::Duration> period = period_at_end(rest);
  if (!part || !period) return std::nullopt;
  if (!sides) sides = Sides{true, true};
  if (sides->left) cable.device().set_load(Side::left, *part, *period);
  if (sides->right) cable.device().set_load(Side::right, *part, *period);
  return "";
}

std::optional<std::string> change_stuck(std::string_view rest, Cable& cable) {
  const std::string_view word = next_word(rest);
  if (word == "none" && no_more_words(rest)) {
    cable.device().set_stuck(Side::left, rt::Duration::zero());
    cable.device().set_stuck(Side::right, rt::Duration::zero());
    return "";
  }
  const std::optional<Sides> sides = sides_named(word);
  const std::optional<rt::Duration> period = period_at_end(rest);
  if (!sides || !period) return std::nullopt;
  if (sides->left) cable.device().set_stuck(Side::left, *period);
  if (sides->right) cable.device().set_stuck(Side::right, *period);
  return "";
}

}  // namespace cargobay::hal::sim
