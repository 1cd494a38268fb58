// A flat world for the virtual Create: what it runs into, falls off, sees, and is seen by. Lengths
// in millimetres, angles in degrees, counter-clockwise.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/result.hpp"
#include "hal/sim/inputs.hpp"
#include "hal/sim/pose.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/sim/world/bodies.hpp"

namespace cargobay::hal::sim {

// How far the light of each of a home base's two buoys reaches.
inline constexpr double kBuoyWideDeg = 40.0;    // to its own side
inline constexpr double kBuoyOverlapDeg = 5.0;  // across the middle

struct Point {
  double x_mm = 0.0;
  double y_mm = 0.0;
};
struct Segment {
  Point from{};
  Point to{};
};
struct Rectangle {  // lower left corner and size
  Point corner{};
  double width_mm = 0.0;
  double height_mm = 0.0;
};
struct Circle {
  Point centre{};
  double radius_mm = 0.0;
};
struct Beam {
  Point origin{};
  double heading_deg = 0.0;
};

// Where the robot stands after an obstacle held it, and where it was touched.
struct Contact {
  Point centre{};
  bool left = false;  // of its bumper
  bool right = false;
};

struct World {
  std::vector<Segment> walls{};
  std::vector<Rectangle> boxes{};
  std::vector<Circle> posts{};
  std::vector<Rectangle> cliffs{};  // no floor here
  std::vector<Beam> virtual_walls{};
  std::optional<Beam> home_base{};  // the heading is the way it faces
  std::vector<WorldPose> starts{};  // of the first robot, the second, ...

  // One item per line:
  //   wall X1 Y1 X2 Y2 · box X Y WIDTH HEIGHT · post X Y RADIUS · cliff X Y WIDTH HEIGHT
  //   virtual-wall X Y HEADING · home-base X Y HEADING · start X Y HEADING
  // A # begins a comment. Each start is that of one more robot. A failure names the line.
  static Result<World> parse(std::string_view text);
  static Result<World> load(const std::string& path);

  // Where the robot with that number, from 0 on, begins. One that no line is for begins half a
  // metre to the left of the one before; the first where x, y and heading are 0.
  WorldPose start(std::size_t robot = 0) const;

  // `others` are the other robots in the world. Nothing if the robot touches nothing.
  std::optional<Contact> collide(const WorldPose& pose, std::span<const Body> others = {}) const;
  // Adds what a robot in that place would see, except bumps, which are collide()'s. Its infrared
  // receiver sees as wide as `receiver_opening_deg`, centred on the front.
  void sense(const WorldPose& pose, Inputs& inputs, double receiver_opening_deg = kAllAroundDeg,
             std::span<const Body> others = {}) const;
};

// Puts the device at the start of the world and lets it live there. The world outlives the device.
void inhabit(Device& device, const World& world);
// The same for one of several robots, with a number of its own. `bodies` outlives the device too.
void inhabit(Device& device, const World& world, Bodies& bodies, std::size_t number);

}  // namespace cargobay::hal::sim
