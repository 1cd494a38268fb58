#include "hal/sim/drive_train/encoder.hpp"

#include <cmath>
#include <cstdlib>

namespace cargobay::hal::sim {

Encoder::Encoder(double counts_per_mm, CounterSign sign, double missed)
    : counts_per_mm_{counts_per_mm},
      sign_{sign},
      seen_of_all_{kAll - std::llround(missed * static_cast<double>(kAll))} {}

void Encoder::set(double counts_per_mm, CounterSign sign, double missed) {
  const Encoder fresh{counts_per_mm, sign, missed};
  counts_per_mm_ = fresh.counts_per_mm_;
  sign_ = fresh.sign_;
  seen_of_all_ = fresh.seen_of_all_;
}

void Encoder::roll(double from_mm, double to_mm, std::int64_t commanded_sign) {
  const auto passed = static_cast<std::int64_t>(std::floor(to_mm * counts_per_mm_) -
                                                std::floor(from_mm * counts_per_mm_));
  credit_ += std::abs(passed) * seen_of_all_;
  const std::int64_t seen = credit_ / kAll;
  credit_ %= kAll;
  const std::int64_t true_sign = passed < 0 ? -1 : 1;
  const bool commanded = sign_ == CounterSign::commanded;
  counts_ += (commanded ? commanded_sign : true_sign) * seen;
  edges_ += (commanded ? 1 : true_sign) * seen;
}

}  // namespace cargobay::hal::sim
