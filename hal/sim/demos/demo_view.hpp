// What a demo sees and does, and the movements that demos are made of. Nothing here or in a demo
// knows more than the robot's own sensors tell.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "hal/sim/inputs.hpp"
#include "hal/sim/pose.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

struct DemoView {
  rt::Duration now{};
  const Inputs* seen = nullptr;
  double travelled_mm = 0.0;  // by the encoders, since power-on
  double turned_deg = 0.0;
};

struct DemoAction {
  WheelSpeeds wheels{};
  std::uint8_t note = 0;  // MIDI number that sounds; 0 for silence
  bool over = false;      // the demo has come to its end
};

constexpr WheelSpeeds straight(double mm_s) { return {mm_s, mm_s}; }
constexpr WheelSpeeds turn_left(double mm_s) { return {-mm_s, mm_s}; }

// Around a centre at that distance to the left, or to the right if it is negative.
constexpr WheelSpeeds arc(double mm_s, double radius_mm) {
  const double part = 0.5 * oi::kCreate.wheel_base_mm / radius_mm;
  return {mm_s * (1.0 - part), mm_s * (1.0 + part)};
}

// Straight on, and back to a heading that is so far to the left.
inline WheelSpeeds steer(double mm_s, double left_deg) {
  constexpr double kPartPerDeg = 0.02;
  const double part = std::clamp(kPartPerDeg * left_deg, -0.6, 0.6);
  return {mm_s * (1.0 - part), mm_s * (1.0 + part)};
}

// More than this a demo turns on the spot.
inline constexpr double kPivotDeg = 35.0;

inline double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

inline bool bumped(const Inputs& seen) { return seen.bump_left || seen.bump_right; }
inline bool bumped_both(const Inputs& seen) { return seen.bump_left && seen.bump_right; }
inline bool met_on_the_left(const Inputs& seen) {
  return seen.bump_left || seen.cliff_left.cliff || seen.cliff_front_left.cliff;
}
inline constexpr auto kRedBuoy = oi::HomeBaseBeams{}.with(oi::HomeBaseBeam::red_buoy);
inline constexpr auto kGreenBuoy = oi::HomeBaseBeams{}.with(oi::HomeBaseBeam::green_buoy);
inline constexpr auto kBothBuoys = kRedBuoy.with(oi::HomeBaseBeam::green_buoy);
inline bool sees_both_buoys(const Inputs& seen) {
  return (seen.beams() & kBothBuoys) == kBothBuoys;
}

// Back for so far, then around on the spot. Between these, and before the robot drives on, it lets
// the wheels come to rest: the encoders cannot see which way they coast, and each turn would put
// the reckoned heading off by degrees. A turn that meets a cliff goes the other way round.
class Evasion {
 public:
  Evasion() = default;
  // So fast it turns on the spot.
  explicit Evasion(double turn_mm_s) : turn_mm_s_{turn_mm_s} {}
  void start(const DemoView& view, double back_mm, double turn_deg);
  void stop() { *this = Evasion{turn_mm_s_}; }
  bool active() const { return phase_ != Phase::over; }
  // How far back it would go at most.
  double way_back_mm(const DemoView& view) const { return view.travelled_mm - turned_at_mm_; }
  // Once more; false if it has ended, and `wheels` is not set.
  bool step(const DemoView& view, WheelSpeeds& wheels);

 private:
  enum class Phase : std::uint8_t { over, brake, back, turn, rest };

  void brake(const DemoView& view);
  bool stands(const DemoView& view);
  bool cliff_ahead(const Inputs& seen) const;

  static constexpr double kTurnMmPerSec = 200.0;

  double turn_mm_s_ = kTurnMmPerSec;
  Phase phase_ = Phase::over;
  double back_mm_ = 0.0;
  double turn_deg_ = 0.0;  // positive to the left
  void begin_back(const DemoView& view);
  void retreat(const DemoView& view);
  void begin_turn(const DemoView& view);
  void turn(const DemoView& view);

  bool backs_ = false;      // once it stands
  bool other_way_ = false;  // round, because the shorter one leads onto a cliff
  bool undoes_ = false;     // a turn that led onto a cliff both ways
  bool at_cliff_ = false;   // at the last tick of the turn
  rt::Duration stands_since_{0};
  double cliff_mm_ = -std::numeric_limits<double>::infinity();  // where it saw one last
  double stood_mm_ = 0.0;
  double stood_deg_ = 0.0;
  double began_travelled_mm_ = 0.0;
  double began_turned_deg_ = 0.0;
  double from_deg_ = 0.0;                                           // its heading before the turn
  double turned_at_mm_ = -std::numeric_limits<double>::infinity();  // where it did so last
};

}  // namespace cargobay::hal::sim
