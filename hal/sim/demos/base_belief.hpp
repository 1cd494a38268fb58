// Where a Home Base may stand, by all that the robot has seen of it and by where it was then:
// places and headings that agree with what it remembers, in a frame of its own reckoning.
//
// A place is as good as the light that a base there would throw onto each sighting. What is seen
// without a buoy tells as much as what is seen with one: then nothing hides the base. Where it sees
// nothing at all, furniture may hide it, and that tells little.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/sim/random.hpp"
#include "hal/sim/safety.hpp"
#include "oi/sensors.hpp"

namespace cargobay::hal::sim {

// How far its light reaches, from its lamps to the centre of the robot.
inline constexpr double kBaseLitMm = 1500.0 + kRobotRadiusMm;   // of a buoy
inline constexpr double kBaseFieldMm = 500.0 + kRobotRadiusMm;  // of the force field

class BaseBelief {
 public:
  struct Place {
    double x_mm = 0.0;
    double y_mm = 0.0;
    double heading_rad = 0.0;  // the way it faces
  };

  void forget() { *this = {}; }
  // Light, or none, where the robot is now. Nothing is remembered before the first light.
  void see(double x_mm, double y_mm, oi::HomeBaseBeams light);
  // Nothing while places far from each other agree with it as well.
  std::optional<Place> estimate() const;
  // One that agrees with it, of many. Only after the first light.
  Place any();

 private:
  struct Sighting {
    double x_mm = 0.0;
    double y_mm = 0.0;
    oi::HomeBaseBeams light{};
  };
  struct Guess {
    Place place{};
    double cost = 0.0;  // 0 if all that it saw agrees
  };

  static constexpr std::size_t kGuesses = 160;
  static constexpr std::size_t kSightings = 96;
  static constexpr std::uint64_t kSeed = 0x62617365;

  static double cost(const Place& place, const Sighting& sighting);
  double cost(const Place& place) const;
  const Guess& best() const;
  void remember(const Sighting& sighting);
  void guess_around(const Sighting& sighting);
  Place guess_from(const Sighting& sighting);
  void improve();
  double either_way(double most) { return most * (2.0 * random_.uniform() - 1.0); }

  std::array<Sighting, kSightings> sightings_{};  // the latest ones, in no order
  std::size_t seen_ = 0;                          // ever
  std::array<Guess, kGuesses> guesses_{};
  Random random_{kSeed};
};

}  // namespace cargobay::hal::sim
