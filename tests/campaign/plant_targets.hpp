// What the robots of the campaign over plants are asked to do.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "tests/campaign/plant_drive.hpp"

namespace cargobay::campaign {

// What a drive may ask for so that no command has to be beyond the robot's range.
inline double fastest(const PlantValues& plant) {
  return std::min(plant.gain_left, plant.gain_right) * kRoomMmS;
}

// Another target every 1.2 s: straight, on the spot, in an arc.
inline Target about(const PlantValues& plant, std::uint64_t seed) {
  std::mt19937_64 random{seed + 7};
  const auto draw = [&random](double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random);
  };
  std::vector<WheelSpeeds> targets;
  for (int i = 0; i < 40; ++i) {
    const double speed = draw(30.0, std::min(400.0, fastest(plant))) * (draw(0, 1) < 0.3 ? -1 : 1);
    const double shape = draw(0.0, 3.0);
    targets.push_back(shape < 1.0   ? WheelSpeeds{speed, speed}
                      : shape < 2.0 ? WheelSpeeds{-0.6 * speed, 0.6 * speed}
                                    : WheelSpeeds{draw(0.4, 1.0) * speed, speed});
  }
  return [targets](double seconds) {
    return targets[static_cast<std::size_t>(seconds / 1.2) % targets.size()];
  };
}

// As a person steers: a little different every 105 ms.
inline Target steered(std::uint64_t seed) {
  std::mt19937_64 random{seed + 11};
  const auto draw = [&random](double most) {
    return std::uniform_real_distribution<double>{-most, most}(random);
  };
  std::vector<WheelSpeeds> targets;
  double speed = 0.0;
  double turn = 0.0;
  for (int i = 0; i < 400; ++i) {
    speed = std::clamp(speed + draw(40.0), -250.0, 250.0);
    turn = std::clamp(turn + draw(30.0), -80.0, 80.0);
    targets.push_back({speed - turn, speed + turn});
  }
  return [targets](double seconds) {
    return targets[static_cast<std::size_t>(seconds / 0.105) % targets.size()];
  };
}

// Sides of 2.5 s, corners of 1.2 s, a stop before and behind each.
inline WheelSpeeds square(double seconds) {
  const double part = std::fmod(seconds, 4.5);
  if (part < 2.5) return {150.0, 150.0};
  return part >= 3.0 && part < 4.2 ? WheelSpeeds{-100.0, 100.0} : WheelSpeeds{};
}

// Two circles of 16.2 s.
inline WheelSpeeds eight(double seconds) {
  return std::fmod(seconds, 32.4) < 16.2 ? WheelSpeeds{100.0, 200.0} : WheelSpeeds{200.0, 100.0};
}

inline WheelSpeeds stop_and_go(double seconds) {
  return std::fmod(seconds, 2.0) < 1.2 ? WheelSpeeds{200.0, 200.0} : WheelSpeeds{};
}

inline Target then_stand(Target target, double seconds) {
  return [target = std::move(target), seconds](double time_s) {
    return time_s < seconds ? target(time_s) : WheelSpeeds{};
  };
}

}  // namespace cargobay::campaign
