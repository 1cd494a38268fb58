// The encoder of a wheel: a count each time it passes an edge.
#pragma once

#include <cstdint>

#include "hal/sim/wheel_parameters.hpp"

namespace cargobay::hal::sim {

class Encoder {
 public:
  // It misses that share of the edges, evenly: dirt is always in the same place. 1: it is dead.
  Encoder(double counts_per_mm, CounterSign sign, double missed);

  // Takes the new values, and keeps what it has counted.
  void set(double counts_per_mm, CounterSign sign, double missed);
  // The wheel has rolled from one place to another in one direction. `commanded_sign` is 1 or -1.
  void roll(double from_mm, double to_mm, std::int64_t commanded_sign);

  // With the sign of the command or, if the encoder sees the direction, with the true one.
  std::int64_t counts() const { return counts_; }
  // As the raw counters have them: up in both directions, unless the encoder sees the direction.
  std::int64_t edges() const { return edges_; }

 private:
  static constexpr std::int64_t kAll = 1'000'000;  // whole numbers, so that time can be cut anyhow

  double counts_per_mm_;
  CounterSign sign_;
  std::int64_t seen_of_all_;
  std::int64_t credit_ = 0;
  std::int64_t counts_ = 0;
  std::int64_t edges_ = 0;
};

}  // namespace cargobay::hal::sim
