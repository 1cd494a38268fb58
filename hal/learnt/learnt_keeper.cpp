#include "hal/learnt/learnt_keeper.hpp"

#include <cmath>

#include "hal/learnt/learnt_file.hpp"

namespace cargobay::hal {

std::optional<rt::LearntPlant> LearntKeeper::begin() {
  if (place_.file.empty()) return std::nullopt;
  is_anothers_ = is_of_another_kind(place_.file);
  if (is_anothers_) {
    remark_ = "what is learnt of this robot is not kept: " + place_.file +
              " holds something else; name another file, or remove it";
  }
  if (is_anothers_ || place_.forget) return std::nullopt;
  const auto loaded = load_learnt(place_.file, place_.port);
  if (loaded) {
    former_ = *loaded;
  } else if (loaded.failure().code != std::errc::no_such_file_or_directory) {
    remark_ = "what was learnt of this robot cannot be used, and is learnt again: " + place_.file +
              ": " + loaded.failure().message;
  }
  return former_;
}

std::optional<rt::LearntPlant> LearntKeeper::result(
    const std::optional<rt::LearntPlant>& learnt) const {
  constexpr double kSure = 10.0;  // log odds
  if (!learnt || !worth_keeping(*learnt)) return std::nullopt;
  rt::LearntPlant plant = *learnt;
  if (std::abs(plant.log_odds_carried) < kSure)
    plant.remainder = former_ ? former_->remainder : rt::RemainderBelief::unknown;
  return plant;
}

void LearntKeeper::now_and_then(const std::optional<rt::LearntPlant>& learnt, rt::TimePoint now) {
  if (!written_) written_ = now;
  if (now - *written_ < kPeriod) return;
  written_ = now;
  keep(learnt);
}

void LearntKeeper::keep(const std::optional<rt::LearntPlant>& learnt) {
  if (place_.file.empty() || is_anothers_) return;
  const auto plant = result(learnt);
  if (!plant) return;
  const auto saved = save_learnt(place_.file, {.port = place_.port, .plant = *plant});
  remark_ = saved ? "" : "what was learnt of this robot is not kept: " + saved.failure().message;
}

}  // namespace cargobay::hal
