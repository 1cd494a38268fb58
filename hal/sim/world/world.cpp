#include "hal/sim/world/world.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "hal/sim/safety.hpp"
#include "oi/dialect.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kDegreesPerRad = 180.0 / std::numbers::pi;

// Parts of the robot, seen from its centre.
constexpr double kBumperHalfDeg = 90.0;  // the bumper is the front half
constexpr double kBumperBothDeg = 15.0;  // a contact this close to straight ahead pushes both sides
constexpr double kWallRangeMm = 120.0;
constexpr double kWallSeenMm = 60.0;

constexpr std::uint16_t kCliffSignal = 8;  // hardly any light comes back
constexpr double kWallSignal = 4095.0;

constexpr double kVirtualWallRangeMm = 2000.0;
constexpr double kVirtualWallHalfDeg = 10.0;
constexpr double kVirtualWallHaloMm = 100.0;  // around its housing
constexpr double kVirtualWallRadiusMm = 40.0;
constexpr double kBuoyRangeMm = 1500.0;
constexpr double kForceFieldMm = 500.0;
constexpr double kDockedMm = 40.0;
constexpr double kDockedDeg = 20.0;

constexpr int kContactRounds = 4;        // a corner takes two
constexpr double kBumperTravelMm = 1.0;  // of a robot that another one leans on
constexpr double kStartApartMm = 500.0;
constexpr double kInfraredRangeMm = 2000.0;  // of what a robot sends

// A world as one of its robots meets it.
struct Scene {
  const World& world;
  std::span<const Body> others;
};

Point operator+(Point a, Point b) { return {a.x_mm + b.x_mm, a.y_mm + b.y_mm}; }
Point operator-(Point a, Point b) { return {a.x_mm - b.x_mm, a.y_mm - b.y_mm}; }
Point operator*(double scale, Point a) { return {scale * a.x_mm, scale * a.y_mm}; }
double dot(Point a, Point b) { return a.x_mm * b.x_mm + a.y_mm * b.y_mm; }
double cross(Point a, Point b) { return a.x_mm * b.y_mm - a.y_mm * b.x_mm; }
double length(Point a) { return std::hypot(a.x_mm, a.y_mm); }
double angle_deg(Point a) { return std::atan2(a.y_mm, a.x_mm) * kDegreesPerRad; }
Point direction(double degrees) {
  return {std::cos(degrees / kDegreesPerRad), std::sin(degrees / kDegreesPerRad)};
}
// Wraps to -180 to 180.
double wrapped_deg(double degrees) { return std::remainder(degrees, 360.0); }

Point centre_of(const WorldPose& pose) { return {pose.x_mm, pose.y_mm}; }

// The point `distance_mm` from the robot's centre, at that angle from its heading.
Point place(const WorldPose& pose, double distance_mm, double off_heading_deg) {
  const double heading_deg = pose.heading_rad * kDegreesPerRad + off_heading_deg;
  return Point{pose.x_mm, pose.y_mm} + distance_mm * direction(heading_deg);
}

std::array<Segment, 4> edges(const Rectangle& box) {
  const Point a = box.corner;
  const Point b = a + Point{box.width_mm, 0.0};
  const Point c = a + Point{box.width_mm, box.height_mm};
  const Point d = a + Point{0.0, box.height_mm};
  return {{{a, b}, {b, c}, {c, d}, {d, a}}};
}

bool inside(const Rectangle& box, Point at) {
  return at.x_mm >= box.corner.x_mm && at.x_mm <= box.corner.x_mm + box.width_mm &&
         at.y_mm >= box.corner.y_mm && at.y_mm <= box.corner.y_mm + box.height_mm;
}

Point nearest(const Segment& segment, Point at) {
  const Point along = segment.to - segment.from;
  const double squared = dot(along, along);
  if (squared == 0.0) return segment.from;
  const double part = std::clamp(dot(at - segment.from, along) / squared, 0.0, 1.0);
  return segment.from + part * along;
}

// Calls visit(nearest point) for each obstacle.
template <typename Visit>
void visit_nearest(const Scene& scene, Point at, Visit&& visit) {
  const World& world = scene.world;
  const auto visit_circle = [&](Point centre, double radius_mm) {
    const Point away = at - centre;
    const double distance = length(away);
    visit(distance == 0.0 ? centre : centre + (radius_mm / distance) * away);
  };
  for (const Segment& wall : world.walls) visit(nearest(wall, at));
  for (const Rectangle& box : world.boxes) {
    for (const Segment& edge : edges(box)) visit(nearest(edge, at));
  }
  for (const Circle& post : world.posts) visit_circle(post.centre, post.radius_mm);
  for (const Beam& wall : world.virtual_walls) visit_circle(wall.origin, kVirtualWallRadiusMm);
  for (const Body& other : scene.others) visit_circle(centre_of(other.pose), kRobotRadiusMm);
}

// How far along the ray the segment is; infinite if the ray misses it.
double met_at(Point from, Point toward, const Segment& segment) {
  const Point along = segment.to - segment.from;
  const double parallel = cross(toward, along);
  if (parallel == 0.0) return std::numeric_limits<double>::infinity();
  const double distance = cross(segment.from - from, along) / parallel;
  const double part = cross(segment.from - from, toward) / parallel;
  const bool met = distance >= 0.0 && part >= 0.0 && part <= 1.0;
  return met ? distance : std::numeric_limits<double>::infinity();
}

double met_at(Point from, Point toward, const Circle& post) {
  const Point to_centre = post.centre - from;
  const double along = dot(to_centre, toward);
  const double aside = cross(toward, to_centre);
  const double half_chord = post.radius_mm * post.radius_mm - aside * aside;
  if (along < 0.0 || half_chord < 0.0) return std::numeric_limits<double>::infinity();
  return along - std::sqrt(half_chord);
}

// The distance to the first obstacle in that direction, a unit vector.
double free_way_mm(const Scene& scene, Point from, Point toward) {
  const World& world = scene.world;
  double distance = std::numeric_limits<double>::infinity();
  for (const Segment& wall : world.walls) distance = std::min(distance, met_at(from, toward, wall));
  for (const Rectangle& box : world.boxes) {
    for (const Segment& edge : edges(box))
      distance = std::min(distance, met_at(from, toward, edge));
  }
  for (const Circle& post : world.posts) distance = std::min(distance, met_at(from, toward, post));
  for (const Body& other : scene.others) {
    const Circle body{centre_of(other.pose), kRobotRadiusMm};
    distance = std::min(distance, met_at(from, toward, body));
  }
  return distance;
}

bool in_sight(const Scene& scene, Point from, Point to) {
  const double distance = length(to - from);
  if (distance == 0.0) return true;
  // What stands at either end, like the base at its own wall, hides nothing.
  constexpr double kSlackMm = 20.0;
  const Point toward = (1.0 / distance) * (to - from);
  return free_way_mm(scene, from + kSlackMm * toward, toward) >= distance - 2.0 * kSlackMm;
}

void sense_cliffs(const World& world, const WorldPose& pose, Inputs& inputs) {
  const auto over_cliff = [&world](Point at) {
    return std::any_of(world.cliffs.begin(), world.cliffs.end(),
                       [at](const Rectangle& cliff) { return inside(cliff, at); });
  };
  const auto look = [&](CliffSensor& sensor, double away_mm, double off_heading_deg) {
    if (over_cliff(place(pose, away_mm, off_heading_deg)))
      sensor = {.cliff = true, .signal = kCliffSignal};
  };
  look(inputs.cliff_left, kCliffSideMm, kCliffSideDeg);
  look(inputs.cliff_front_left, kCliffFrontMm, kCliffFrontDeg);
  look(inputs.cliff_front_right, kCliffFrontMm, -kCliffFrontDeg);
  look(inputs.cliff_right, kCliffSideMm, -kCliffSideDeg);
  const auto drop = [&](bool& dropped, double away_mm, double off_heading_deg) {
    const Point at = place(pose, away_mm, off_heading_deg);
    if (!over_cliff(at)) return;
    for (int turn_deg = 0; turn_deg < 360; turn_deg += 30) {
      if (!over_cliff(at + kWheelRestsMm * direction(turn_deg))) return;
    }
    dropped = true;
  };
  const double wheel_mm = 0.5 * oi::kCreate.wheel_base_mm;
  drop(inputs.wheel_drop_left, wheel_mm, 90.0);
  drop(inputs.wheel_drop_right, wheel_mm, -90.0);
  drop(inputs.wheel_drop_caster, kCasterMm, 0.0);
}

void sense_wall(const Scene& scene, const WorldPose& pose, Inputs& inputs) {
  const double heading_deg = pose.heading_rad * kDegreesPerRad + kWallSensorDeg;
  const double distance =
      free_way_mm(scene, place(pose, kRobotRadiusMm, kWallSensorDeg), direction(heading_deg));
  if (distance >= kWallRangeMm) return;
  inputs.wall_signal =
      std::max(inputs.wall_signal,
               static_cast<std::uint16_t>(kWallSignal * (1.0 - distance / kWallRangeMm)));
  if (distance < kWallSeenMm) inputs.wall = true;
}

// Whether light from there enters through the opening of the receiver.
bool comes_in(const WorldPose& pose, Point from, double opening_deg) {
  const double bearing_deg = angle_deg(from - Point{pose.x_mm, pose.y_mm});
  const double off_deg = wrapped_deg(bearing_deg - pose.heading_rad * kDegreesPerRad);
  return std::abs(off_deg) <= 0.5 * opening_deg;
}

void sense_virtual_walls(const Scene& scene, const WorldPose& pose, double opening_deg,
                         Inputs& inputs) {
  const Point at{pose.x_mm, pose.y_mm};
  for (const Beam& beam : scene.world.virtual_walls) {
    if (!comes_in(pose, beam.origin, opening_deg)) continue;
    const Point away = at - beam.origin;
    const double distance = length(away) - kRobotRadiusMm;
    const double off_deg = wrapped_deg(angle_deg(away) - beam.heading_deg);
    const bool in_beam = distance < kVirtualWallRangeMm &&
                         std::abs(off_deg) < kVirtualWallHalfDeg &&
                         in_sight(scene, beam.origin, at);
    if (in_beam || distance < kVirtualWallHaloMm) inputs.virtual_wall = true;
  }
}

// Which of the buoys and the force field light that place.
oi::HomeBaseBeams light_of_home_base(const Scene& scene, Point at) {
  const Beam& base = *scene.world.home_base;
  const Point away = at - base.origin;
  const double distance = length(away) - kRobotRadiusMm;
  if (distance >= std::max(kBuoyRangeMm, kForceFieldMm) || !in_sight(scene, base.origin, at)) {
    return {};
  }
  const double off_deg = wrapped_deg(angle_deg(away) - base.heading_deg);
  using enum oi::HomeBaseBeam;
  oi::HomeBaseBeams light;
  if (distance < kForceFieldMm) light = light.with(force_field);
  // Seen from the base, red is to its left and green to its right; both overlap in the middle.
  const bool lit = distance < kBuoyRangeMm;
  if (lit && off_deg > -kBuoyOverlapDeg && off_deg < kBuoyWideDeg) light = light.with(red_buoy);
  if (lit && off_deg < kBuoyOverlapDeg && off_deg > -kBuoyWideDeg) light = light.with(green_buoy);
  return light;
}

void sense_home_base(const Scene& scene, const WorldPose& pose, double opening_deg,
                     Inputs& inputs) {
  const World& world = scene.world;
  if (!world.home_base) return;
  const Point at{pose.x_mm, pose.y_mm};
  const bool open = comes_in(pose, world.home_base->origin, opening_deg);
  const oi::HomeBaseBeams seen = open ? light_of_home_base(scene, at) : oi::HomeBaseBeams{};
  if (seen.any() && inputs.infrared == kNoInfrared)
    inputs.infrared = static_cast<std::uint8_t>(oi::infrared_character(seen));
  if (seen.has(oi::HomeBaseBeam::force_field)) inputs.virtual_wall = true;
  const Point away = at - world.home_base->origin;
  const double distance = length(away) - kRobotRadiusMm;
  const double off_deg = wrapped_deg(angle_deg(away) - world.home_base->heading_deg);
  const double facing_deg =
      wrapped_deg(pose.heading_rad * kDegreesPerRad - (world.home_base->heading_deg + 180.0));
  if (distance < kDockedMm && std::abs(off_deg) < kDockedDeg && std::abs(facing_deg) < kDockedDeg) {
    inputs.home_base = true;
  }
}

// What other robots send, unless something of the world is seen already.
void sense_robots(const Scene& scene, const WorldPose& pose, double opening_deg, Inputs& inputs) {
  const Point at = centre_of(pose);
  for (std::size_t i = 0; i < scene.others.size(); ++i) {
    const Body& other = scene.others[i];
    const Point from = centre_of(other.pose);
    if (other.infrared == kNoInfrared || inputs.infrared != kNoInfrared) continue;
    if (length(at - from) > kInfraredRangeMm || !comes_in(pose, from, opening_deg)) continue;
    // The sender does not hide its own light.
    const bool hidden = std::ranges::any_of(scene.others, [&](const Body& third) {
      const Circle body{centre_of(third.pose), kRobotRadiusMm};
      const double distance = length(at - from);
      return &third != &other && distance > 0.0 &&
             met_at(from, (1.0 / distance) * (at - from), body) < distance;
    });
    if (!hidden && in_sight({.world = scene.world, .others = {}}, from, at))
      inputs.infrared = other.infrared;
  }
}

// The bumper is pushed from there.
void push_bumper(const WorldPose& pose, Point toward, Contact& contact) {
  const double off_deg = wrapped_deg(angle_deg(toward) - pose.heading_rad * kDegreesPerRad);
  if (std::abs(off_deg) > kBumperHalfDeg) return;
  contact.left = contact.left || off_deg > -kBumperBothDeg;
  contact.right = contact.right || off_deg < kBumperBothDeg;
}

}  // namespace

WorldPose World::start(std::size_t robot) const {
  if (robot < starts.size()) return starts[robot];
  WorldPose pose = starts.empty() ? WorldPose{} : starts.back();
  const double aside_mm =
      kStartApartMm * static_cast<double>(robot + 1 - std::max<std::size_t>(starts.size(), 1));
  pose.x_mm -= aside_mm * std::sin(pose.heading_rad);
  pose.y_mm += aside_mm * std::cos(pose.heading_rad);
  return pose;
}

std::optional<Contact> World::collide(const WorldPose& pose, std::span<const Body> others) const {
  Contact contact{.centre = centre_of(pose)};
  bool touched = false;
  for (int round = 0; round < kContactRounds; ++round) {
    double deepest_mm = kRobotRadiusMm;
    Point from{};
    visit_nearest({.world = *this, .others = others}, contact.centre, [&](Point point) {
      const double distance = length(point - contact.centre);
      if (distance >= deepest_mm) return;
      deepest_mm = distance;
      from = point;
    });
    if (deepest_mm >= kRobotRadiusMm) break;
    touched = true;
    const Point toward = from - contact.centre;
    push_bumper(pose, toward, contact);
    if (deepest_mm == 0.0) break;  // at its very centre: no way out
    contact.centre = from - (kRobotRadiusMm / deepest_mm) * toward;
  }
  // Of two robots that meet, the one that stands is pushed too.
  for (const Body& other : others) {
    const Point toward = centre_of(other.pose) - contact.centre;
    if (length(toward) > 2.0 * kRobotRadiusMm + kBumperTravelMm) continue;
    touched = true;
    push_bumper(pose, toward, contact);
  }
  if (!touched) return std::nullopt;
  return contact;
}

void World::sense(const WorldPose& pose, Inputs& inputs, double receiver_opening_deg,
                  std::span<const Body> others) const {
  const Scene scene{.world = *this, .others = others};
  sense_cliffs(*this, pose, inputs);
  sense_wall(scene, pose, inputs);
  sense_virtual_walls(scene, pose, receiver_opening_deg, inputs);
  sense_home_base(scene, pose, receiver_opening_deg, inputs);
  sense_robots(scene, pose, receiver_opening_deg, inputs);
}

}  // namespace cargobay::hal::sim
