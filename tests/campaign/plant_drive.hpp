// A drive of the campaign over plants: the loop, its odometry and a robot, in virtual time.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "rt/both_odometries.hpp"
#include "rt/wheel_loop.hpp"
#include "tests/campaign/plant_robot.hpp"

namespace cargobay::campaign {

using rt::WheelSpeeds;
using Target = std::function<WheelSpeeds(double seconds)>;

inline constexpr int kRestTicks = 10;
constexpr double kRoomMmS = 460.0;  // commands of an unloaded robot stay below

struct State {
  double time_s = 0.0;
  WheelSpeeds target{};
  WheelSpeeds set{};
  WheelSpeeds truth{};
  rt::RemainderBelief belief = rt::RemainderBelief::unknown;
};
struct Driven {
  std::vector<State> states{};
  TruePose truth{};
  rt::OdometryPose pose{};
  rt::PoseCovariance covariance{};
  rt::LearntPlant learnt{};
  rt::WheelWatch::Evidence evidence{};
  double found_s = 0.0;  // when, if there is any
};
struct How {
  bool told = false;  // the loop knows plant and kind
  std::optional<double> load_at_s{};
  std::optional<rt::LearntPlant> prior{};  // of an earlier drive
  std::optional<double> wheel_base_mm{};   // as the loop has it; none: its default
  rt::WheelLoop::Feedback feedback = rt::WheelLoop::Feedback::closed;
  bool holds_heading = false;
  std::optional<double> until_x_mm{};  // ends there, at the latest after its time
  std::optional<double> fault_at_s{};
  WheelFault left{};  // from then on
  WheelFault right{};
};

inline rt::WheelLoop::Parameters told(const PlantValues& plant) {
  rt::WheelLoop::Parameters parameters;
  parameters.estimator.remainder = plant.remainder;
  parameters.estimator.told =
      rt::PlantEstimate{.lag_s = plant.lag_s,
                        .dead_time_s = plant.dead_time_s,
                        .ramp_s2_mm = plant.ramp_mm_s2 ? 1.0 / *plant.ramp_mm_s2 : 0.0,
                        .gain_left = plant.gain_left,
                        .gain_right = plant.gain_right};
  return parameters;
}

inline Driven drive(const PlantValues& plant, std::uint64_t seed, double seconds,
                    const Target& target, const How& how = {}) {
  PlantRobot robot{plant, seed};
  rt::WheelLoop::Parameters parameters = how.told ? told(plant) : rt::WheelLoop::Parameters{};
  parameters.estimator.prior = how.prior;
  if (how.wheel_base_mm) parameters.estimator.wheel_base_mm = *how.wheel_base_mm;
  parameters.feedback = how.feedback;
  parameters.course.hold_heading = how.holds_heading;
  rt::WheelLoop loop{parameters};
  rt::BothOdometries odometry{{}};
  Driven driven;
  rt::Axes reads = rt::kBothAxes;
  const int ticks = static_cast<int>(seconds / kTickS);
  for (int tick = -kRestTicks; tick < ticks; ++tick) {
    const double time_s = tick * kTickS;
    if (how.until_x_mm && robot.pose().x_mm >= *how.until_x_mm) break;
    if (how.load_at_s && time_s >= *how.load_at_s) robot.load(0.75);
    if (how.fault_at_s && time_s >= *how.fault_at_s) robot.fail(how.left, how.right);
    robot.tick(loop.command());
    loop.frame(robot.read(reads));
    odometry.step(loop.take_travels(), loop.belief(), loop.sure());
    const WheelSpeeds wanted = tick < 0 ? WheelSpeeds{} : target(time_s);
    loop.control(wanted);
    reads = loop.next_reads();
    if (tick < 0) continue;
    if (loop.evidence().what == rt::WheelWatch::Finding::nothing) driven.found_s = time_s;
    driven.states.push_back({.time_s = time_s,
                             .target = wanted,
                             .set = loop.set(),
                             .truth = robot.speeds(),
                             .belief = loop.belief()});
  }
  driven.learnt = loop.learnt();
  driven.evidence = loop.evidence();
  driven.truth = robot.pose();
  driven.pose = odometry.now().pose();
  driven.covariance = odometry.now().covariance();
  return driven;
}

}  // namespace cargobay::campaign
