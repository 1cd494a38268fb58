#include "tests/campaign/random_room.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "hal/sim/random.hpp"
#include "hal/sim/safety.hpp"

namespace cargobay::campaign {

using hal::sim::Beam;
using hal::sim::Inputs;
using hal::sim::Point;
using hal::sim::Random;
using hal::sim::Rectangle;
using hal::sim::Segment;
using hal::sim::World;
using hal::sim::WorldPose;

namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kBaseDepthMm = 20.0;    // from the wall to where its lamps are
constexpr double kLampDepthMm = 45.0;    // the same for a virtual wall
constexpr double kFromCornerMm = 250.0;  // nothing is put closer to the corner of a room
constexpr double kFromLampMm = 400.0;    // its centre, where Home and Tag start
constexpr int kTries = 400;
constexpr double kTagLeastMm = 900.0;  // between the two walls of Tag
constexpr double kTagMostMm = 1900.0;

double between(Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}

Point rotated(Point at, double degrees) {
  const double c = std::cos(degrees * kRadPerDeg);
  const double s = std::sin(degrees * kRadPerDeg);
  return {c * at.x_mm - s * at.y_mm, s * at.x_mm + c * at.y_mm};
}
Point moved(Point at, double heading_deg, double distance_mm) {
  return {at.x_mm + distance_mm * std::cos(heading_deg * kRadPerDeg),
          at.y_mm + distance_mm * std::sin(heading_deg * kRadPerDeg)};
}
double length(const Segment& edge) {
  return std::hypot(edge.to.x_mm - edge.from.x_mm, edge.to.y_mm - edge.from.y_mm);
}
double direction_deg(const Segment& edge) {
  return std::atan2(edge.to.y_mm - edge.from.y_mm, edge.to.x_mm - edge.from.x_mm) / kRadPerDeg;
}

// A rectangle, an L, or five to seven corners around an oval; turned by any angle.
std::vector<Point> outline(Random& random) {
  const double width = between(random, 2200.0, 5500.0);
  const double height = between(random, 2000.0, 4500.0);
  std::vector<Point> corners{{0.0, 0.0}, {width, 0.0}, {width, height}, {0.0, height}};
  const double kind = random.uniform();
  if (kind < 0.3) {
    const double in_x = width * between(random, 0.4, 0.7);
    const double in_y = height * between(random, 0.4, 0.7);
    corners = {{0.0, 0.0},   {width, 0.0},   {width, in_y},
               {in_x, in_y}, {in_x, height}, {0.0, height}};
  } else if (kind < 0.6) {
    corners.clear();
    const std::uint32_t count = 5 + random.below(3);
    for (std::uint32_t i = 0; i < count; ++i) {
      const double turn_deg = (i + between(random, -0.2, 0.2)) * 360.0 / count;
      const double part = between(random, 0.75, 1.0);
      corners.push_back({0.5 * width * part * std::cos(turn_deg * kRadPerDeg),
                         0.5 * height * part * std::sin(turn_deg * kRadPerDeg)});
    }
  }
  const double turn_deg = random.uniform() < 0.5 ? 0.0 : between(random, 0.0, 360.0);
  for (Point& corner : corners) corner = rotated(corner, turn_deg);
  return corners;
}

Point anywhere_in(const RandomRoom& room, Random& random) {
  const auto by_x = [](Point a, Point b) { return a.x_mm < b.x_mm; };
  const auto by_y = [](Point a, Point b) { return a.y_mm < b.y_mm; };
  const auto [left, right] = std::minmax_element(room.outline.begin(), room.outline.end(), by_x);
  const auto [low, high] = std::minmax_element(room.outline.begin(), room.outline.end(), by_y);
  Point at{};
  for (int i = 0; i < kTries; ++i) {
    at = {between(random, left->x_mm, right->x_mm), between(random, low->y_mm, high->y_mm)};
    if (room.contains(at)) break;
  }
  return at;
}

// A random place along the walls, this far into the room, facing straight into it.
Beam anywhere_at_a_wall(const RandomRoom& room, Random& random, double depth_mm) {
  Segment edge{};
  for (int i = 0; i < kTries; ++i) {
    edge = room.world.walls[random.below(static_cast<std::uint32_t>(room.outline.size()))];
    if (length(edge) > 2.0 * kFromCornerMm) break;
  }
  const double along_mm = between(random, kFromCornerMm, length(edge) - kFromCornerMm);
  const double inward_deg = direction_deg(edge) + 90.0;
  return {moved(moved(edge.from, direction_deg(edge), along_mm), inward_deg, depth_mm), inward_deg};
}

void add_walls(World& world, const std::vector<Point>& corners) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    world.walls.push_back({corners[i], corners[(i + 1) % corners.size()]});
}

std::vector<Point> rectangle(Point centre, double width, double height, double turn_deg) {
  const double x = 0.5 * width;
  const double y = 0.5 * height;
  std::vector<Point> corners{{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  for (Point& corner : corners) {
    corner = rotated(corner, turn_deg);
    corner = {corner.x_mm + centre.x_mm, corner.y_mm + centre.y_mm};
  }
  return corners;
}

bool is_left_of(Point at, Point from, Point to) {
  return (to.x_mm - from.x_mm) * (at.y_mm - from.y_mm) >
         (to.y_mm - from.y_mm) * (at.x_mm - from.x_mm);
}
bool cross(Point a, Point b, Point from, Point to) {
  return is_left_of(a, from, to) != is_left_of(b, from, to) &&
         is_left_of(from, a, b) != is_left_of(to, a, b);
}

// Whether all of it is within the walls.
bool fits(const RandomRoom& room, const std::vector<Point>& corners) {
  if (!room.contains(corners.front())) return false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t k = 0; k < room.outline.size(); ++k) {
      if (cross(corners[i], corners[(i + 1) % corners.size()], room.outline[k],
                room.outline[(k + 1) % room.outline.size()]))
        return false;
    }
  }
  return true;
}

enum class Piece : std::uint32_t { box, turned_box, post, table, count };

// A piece of furniture of any kind at any place, all of it in the room.
void add_piece(RandomRoom& room, Random& random) {
  const auto kind = static_cast<Piece>(random.below(static_cast<std::uint32_t>(Piece::count)));
  double width = between(random, 150.0, 900.0);
  double height = between(random, 150.0, 600.0);
  double turn_deg = 0.0;
  double post_mm = 0.0;  // the radius of a post, or of a table's legs
  switch (kind) {
    case Piece::turned_box: turn_deg = between(random, 0.0, 90.0); break;
    case Piece::post:
      width = height = 0.0;
      post_mm = between(random, 20.0, 200.0);
      break;
    case Piece::table:
      width = between(random, 500.0, 1100.0);
      height = between(random, 500.0, 800.0);
      post_mm = between(random, 15.0, 40.0);
      break;
    default: break;
  }
  for (int i = 0; i < kTries; ++i) {
    const Point at = anywhere_in(room, random);
    if (!fits(room, rectangle(at, width + 2.0 * post_mm, height + 2.0 * post_mm, turn_deg)))
      continue;
    const auto corners = rectangle(at, width, height, turn_deg);
    World& world = room.world;
    if (kind == Piece::box) world.boxes.push_back({corners.front(), width, height});
    if (kind == Piece::turned_box) add_walls(world, corners);
    if (kind == Piece::post) world.posts.push_back({at, post_mm});
    if (kind == Piece::table) {
      for (const Point leg : corners) world.posts.push_back({leg, post_mm});
    }
    return;
  }
}

void furnish(RandomRoom& room, Random& random, std::uint32_t pieces) {
  for (std::uint32_t i = 0; i < pieces; ++i) add_piece(room, random);
}

bool has_floor(const World& world, const WorldPose& pose) {
  return std::none_of(world.cliffs.begin(), world.cliffs.end(), [&pose](const Rectangle& cliff) {
    const double x = std::clamp(pose.x_mm, cliff.corner.x_mm, cliff.corner.x_mm + cliff.width_mm);
    const double y = std::clamp(pose.y_mm, cliff.corner.y_mm, cliff.corner.y_mm + cliff.height_mm);
    return std::hypot(pose.x_mm - x, pose.y_mm - y) < hal::sim::kRobotRadiusMm;
  });
}

// In a beam, but not already at the lamp.
bool sees_virtual_wall(const World& world, const WorldPose& pose) {
  for (const Beam& lamp : world.virtual_walls) {
    if (std::hypot(pose.x_mm - lamp.origin.x_mm, pose.y_mm - lamp.origin.y_mm) < kFromLampMm)
      return false;
  }
  Inputs inputs;
  world.sense(pose, inputs);
  return inputs.virtual_wall;
}

bool put_start(RandomRoom& room, Random& random, bool in_beam) {
  for (int i = 0; i < kTries; ++i) {
    const Point at = anywhere_in(room, random);
    const WorldPose pose{at.x_mm, at.y_mm, between(random, 0.0, 360.0) * kRadPerDeg};
    if (!room.contains(at) || room.world.collide(pose) || !has_floor(room.world, pose)) continue;
    if (in_beam && !sees_virtual_wall(room.world, pose)) continue;
    room.world.starts = {pose};
    return true;
  }
  return false;
}

void add_for_cover(RandomRoom& room, Random& random) {
  room.world.home_base = anywhere_at_a_wall(room, random, kBaseDepthMm);
  furnish(room, random, random.below(7));
  if (random.uniform() < 0.2) {
    room.world.cliffs.push_back(
        {anywhere_in(room, random), between(random, 300.0, 900.0), between(random, 300.0, 900.0)});
  }
  const double chance = random.uniform();
  for (int i = 0; i < (chance < 0.6 ? 0 : chance < 0.9 ? 1 : 2); ++i) {
    Beam beam = anywhere_at_a_wall(room, random, kLampDepthMm);
    beam.heading_deg += between(random, -80.0, 80.0);
    room.world.virtual_walls.push_back(beam);
  }
}

void add_for_home(RandomRoom& room, Random& random) {
  Beam beam = anywhere_at_a_wall(room, random, kLampDepthMm);
  beam.heading_deg += between(random, -45.0, 45.0);
  room.world.virtual_walls.push_back(beam);
  furnish(room, random, random.below(5));
}

void add_for_tag(RandomRoom& room, Random& random) {
  Beam one{};
  Point other{};
  double heading_deg = 0.0;
  for (int i = 0; i < kTries; ++i) {
    one = anywhere_at_a_wall(room, random, kLampDepthMm);
    heading_deg = one.heading_deg + between(random, -40.0, 40.0);
    other = moved(one.origin, heading_deg, between(random, kTagLeastMm, kTagMostMm));
    if (room.contains(other)) break;
  }
  furnish(room, random, random.below(4));
  // Slightly off, but each in the other's beam.
  room.world.virtual_walls.push_back({one.origin, heading_deg + between(random, -5.0, 5.0)});
  room.world.virtual_walls.push_back({other, heading_deg + 180.0 + between(random, -5.0, 5.0)});
}

}  // namespace

bool RandomRoom::contains(Point at) const {
  bool inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Point a = outline[i];
    const Point b = outline[(i + 1) % outline.size()];
    if ((a.y_mm > at.y_mm) == (b.y_mm > at.y_mm)) continue;
    const double x = a.x_mm + (at.y_mm - a.y_mm) * (b.x_mm - a.x_mm) / (b.y_mm - a.y_mm);
    if (at.x_mm < x) inside = !inside;
  }
  return inside;
}

RandomRoom random_room(std::uint64_t seed, Furnished furnished) {
  Random random{seed * 3 + static_cast<std::uint64_t>(furnished)};
  while (true) {  // most rooms work at the first try; a start exists in some room
    RandomRoom room;
    room.outline = outline(random);
    add_walls(room.world, room.outline);
    switch (furnished) {
      case Furnished::for_cover: add_for_cover(room, random); break;
      case Furnished::for_home: add_for_home(room, random); break;
      case Furnished::for_tag: add_for_tag(room, random); break;
    }
    if (put_start(room, random, furnished != Furnished::for_cover)) return room;
  }
}

}  // namespace cargobay::campaign
