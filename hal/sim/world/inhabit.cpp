// How robots live in a world, tick by tick: inhabit().
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "hal/sim/robot/actuators.hpp"
#include "hal/sim/world/world.hpp"
#include "rt/clock.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr rt::Duration kInfraredSeen = std::chrono::milliseconds{100};  // of one Send IR

void live(Device& robot, Inputs& seen, const World& world, std::span<const Body> others) {
  WorldPose pose = robot.truth().pose;
  if (const auto contact = world.collide(pose, others)) {
    // Held, its wheels slip: the encoders keep counting, but the robot does not move.
    pose.x_mm = contact->centre.x_mm;
    pose.y_mm = contact->centre.y_mm;
    robot.place(pose);
    seen.bump_left = seen.bump_left || contact->left;
    seen.bump_right = seen.bump_right || contact->right;
  }
  world.sense(pose, seen, robot.parameters().receiver_opening_deg, others);
}

// One of several robots, at each of its ticks.
struct Inhabitant {
  const World& world;
  Bodies& bodies;
  std::size_t number = 0;
  std::vector<Body> others{};
  std::uint64_t infrared_count = 0;  // that have been seen
  rt::Duration infrared_until{0};

  void operator()(Device& robot, Inputs& seen) {
    // A lock held for a copy; in virtual time nobody else wants it.
    rt::unchecked([this] { bodies.look(number, others); });
    live(robot, seen, world, others);
    const Actuators& actuators = robot.actuators();
    if (infrared_count != actuators.infrared_count) infrared_until = robot.now() + kInfraredSeen;
    infrared_count = actuators.infrared_count;
    const bool sends = robot.now() < infrared_until;
    const Body body{
        .pose = robot.truth().pose,
        .infrared = sends ? actuators.infrared_sent.value_or(kNoInfrared) : kNoInfrared};
    rt::unchecked([this, &body] { bodies.tell(number, body); });
  }
};

}  // namespace

void inhabit(Device& device, const World& world) {
  device.place(world.start());
  device.surroundings = [&world](Device& robot, Inputs& seen) { live(robot, seen, world, {}); };
}

void inhabit(Device& device, const World& world, Bodies& bodies, std::size_t number) {
  const WorldPose start = world.start(number);
  bodies.tell(number, {.pose = start});
  device.place(start);
  device.surroundings = Inhabitant{.world = world,
                                   .bodies = bodies,
                                   .number = number,
                                   .infrared_count = device.actuators().infrared_count};
}

}  // namespace cargobay::hal::sim
