#include "hal/sim/world/world_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "hal/sim/safety.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kMarginMm = 200.0;
constexpr double kMmPerPixel = 6.0;
constexpr double kLegendMm = 260.0;  // two rows of it, below the floor
constexpr double kFewestMm = 800.0;  // the least that is shown, in each direction
constexpr double kGridMm = 500.0;
constexpr double kPointApartMm = 5.0;
constexpr double kBeamMm = 2000.0;
constexpr double kBeamHalfDeg = 10.0;
constexpr double kBuoyMm = 700.0;  // a longer one would hide the room
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Widths, sizes and colours.
constexpr std::string_view kStyle =
    "<style>*{fill:none}text{font:70px sans-serif;fill:#666}"
    ".floor{fill:#fff}.grid{stroke:#e6e6e6;stroke-width:4}"
    ".cliff{fill:url(#hatch);stroke:#c33;stroke-width:10}"
    ".beam{fill:#36c;fill-opacity:.13}.lamp{fill:#36c}"
    ".red{fill:#d33;fill-opacity:.18}.green{fill:#2a2;fill-opacity:.18}.base{fill:#333}"
    ".solid{fill:#cfc6b8;stroke:#7a6f60;stroke-width:10}"
    ".wall{stroke:#222;stroke-width:30;stroke-linecap:round}"
    ".path{stroke:#06c;stroke-width:14;stroke-linejoin:round;stroke-linecap:round}"
    ".begin{fill:#fff;stroke:#06c;stroke-width:14}.bump{fill:#e50}"
    ".robot{fill:#fff;fill-opacity:.8;stroke:#444;stroke-width:14}"
    ".bumper{stroke:#e50;stroke-width:30}.ahead{stroke:#444;stroke-width:14}</style>\n"
    "<pattern id='hatch' width='60' height='60' patternUnits='userSpaceOnUse' "
    "patternTransform='rotate(45)'><rect width='60' height='60' style='fill:#fee'/>"
    "<rect width='12' height='60' style='fill:#e99'/></pattern>\n";

// The bounding box of the drawing.
class Extent {
 public:
  void include(double x_mm, double y_mm, double around_mm = 0.0) {
    left_ = std::min(left_, x_mm - around_mm);
    right_ = std::max(right_, x_mm + around_mm);
    bottom_ = std::min(bottom_, y_mm - around_mm);
    top_ = std::max(top_, y_mm + around_mm);
  }
  double left() const { return 0.5 * (left_ + right_ - width()); }
  double right() const { return left() + width(); }
  double bottom() const { return 0.5 * (bottom_ + top_ - height()); }
  double top() const { return bottom() + height(); }
  double width() const { return shown(right_ - left_); }
  double height() const { return shown(top_ - bottom_); }

 private:
  static double shown(double size_mm) { return std::max(size_mm, kFewestMm) + 2.0 * kMarginMm; }

  double left_ = std::numeric_limits<double>::max();
  double right_ = std::numeric_limits<double>::lowest();
  double bottom_ = std::numeric_limits<double>::max();
  double top_ = std::numeric_limits<double>::lowest();
};

Extent extent_of(const World& world, std::span<const Waypoint> path) {
  Extent extent;
  extent.include(world.start().x_mm, world.start().y_mm, kRobotRadiusMm);
  for (const Waypoint& waypoint : path)
    extent.include(waypoint.pose.x_mm, waypoint.pose.y_mm, kRobotRadiusMm);
  for (const Segment& wall : world.walls) {
    extent.include(wall.from.x_mm, wall.from.y_mm);
    extent.include(wall.to.x_mm, wall.to.y_mm);
  }
  for (const auto* boxes : {&world.boxes, &world.cliffs}) {
    for (const Rectangle& box : *boxes) {
      extent.include(box.corner.x_mm, box.corner.y_mm);
      extent.include(box.corner.x_mm + box.width_mm, box.corner.y_mm + box.height_mm);
    }
  }
  for (const Circle& post : world.posts) {
    extent.include(post.centre.x_mm, post.centre.y_mm, post.radius_mm);
  }
  for (const Beam& beam : world.virtual_walls) extent.include(beam.origin.x_mm, beam.origin.y_mm);
  if (world.home_base) extent.include(world.home_base->origin.x_mm, world.home_base->origin.y_mm);
  return extent;
}

// SVG counts y downward. Never -0.
double down(double y_mm) { return std::round(-y_mm) + 0.0; }

// Builds text with numbers in it.
class Drawing {
 public:
  void say(std::string_view text) { text_ += text; }
  template <typename... Numbers>
  void add(const char* format, Numbers... numbers) {
    std::array<char, 512> piece{};
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg): formats are the literals below
    const int length = std::snprintf(piece.data(), piece.size(), format, numbers...);
    text_.append(piece.data(), static_cast<std::size_t>(length));
  }
  void rectangle(const Rectangle& box, const char* name) {
    add("<rect class='%s' x='%.0f' y='%.0f' width='%.0f' height='%.0f'/>\n", name, box.corner.x_mm,
        down(box.corner.y_mm + box.height_mm), box.width_mm, box.height_mm);
  }
  void circle(Point centre, double radius_mm, const char* name) {
    add("<circle class='%s' cx='%.0f' cy='%.0f' r='%.0f'/>\n", name, centre.x_mm, down(centre.y_mm),
        radius_mm);
  }
  void line(Point from, Point to, const char* name) {
    add("<line class='%s' x1='%.0f' y1='%.0f' x2='%.0f' y2='%.0f'/>\n", name, from.x_mm,
        down(from.y_mm), to.x_mm, down(to.y_mm));
  }
  // What a lamp lights, between two angles relative to where it points.
  void cone(const Beam& lamp, double from_deg, double to_deg, double range_mm, const char* name) {
    const Point from = on_circle(lamp.origin, range_mm, lamp.heading_deg + from_deg);
    const Point to = on_circle(lamp.origin, range_mm, lamp.heading_deg + to_deg);
    add("<path class='%s' d='M%.0f %.0f L%.0f %.0f A%.0f %.0f 0 0 0 %.0f %.0f Z'/>\n", name,
        lamp.origin.x_mm, down(lamp.origin.y_mm), from.x_mm, down(from.y_mm), range_mm, range_mm,
        to.x_mm, down(to.y_mm));
  }
  void arc(Point from, Point to, double radius_mm, const char* name) {
    add("<path class='%s' d='M%.0f %.0f A%.0f %.0f 0 0 0 %.0f %.0f'/>\n", name, from.x_mm,
        down(from.y_mm), radius_mm, radius_mm, to.x_mm, down(to.y_mm));
  }
  static Point on_circle(Point centre, double radius_mm, double angle_deg) {
    return {centre.x_mm + radius_mm * std::cos(angle_deg * kRadPerDeg),
            centre.y_mm + radius_mm * std::sin(angle_deg * kRadPerDeg)};
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void draw_floor(const Extent& extent, Drawing& drawing) {
  drawing.rectangle(
      {{extent.left(), extent.bottom() - kLegendMm}, extent.width(), extent.height() + kLegendMm},
      "floor");
  // A world of kilometres gets no more lines than the eye can separate.
  const double longest_mm = std::max(extent.width(), extent.height());
  const double grid_mm = kGridMm * std::ceil(longest_mm / (40.0 * kGridMm));
  const auto multiples = [grid_mm](double from, double to) {
    return std::pair{std::lround(std::ceil(from / grid_mm)), std::lround(std::floor(to / grid_mm))};
  };
  drawing.say("<path class='grid' d='");
  const auto [first_x, last_x] = multiples(extent.left(), extent.right());
  for (long i = first_x; i <= last_x; ++i) {
    drawing.add("M%.0f %.0f V%.0f ", static_cast<double>(i) * grid_mm, down(extent.top()),
                down(extent.bottom()));
  }
  const auto [first_y, last_y] = multiples(extent.bottom(), extent.top());
  for (long i = first_y; i <= last_y; ++i) {
    drawing.add("M%.0f %.0f H%.0f ", extent.left(), down(static_cast<double>(i) * grid_mm),
                extent.right());
  }
  drawing.say("'/>\n");
  drawing.add("<text x='%.0f' y='%.0f'>%.1f by %.1f m, grid %g m</text>\n", extent.left() + 30.0,
              -extent.bottom() - 30.0, (extent.width() - 2.0 * kMarginMm) / 1000.0,
              (extent.height() - 2.0 * kMarginMm) / 1000.0, grid_mm / 1000.0);
}

void draw_home_base(const Beam& base, Drawing& drawing) {
  drawing.cone(base, -kBuoyOverlapDeg, kBuoyWideDeg, kBuoyMm, "red");
  drawing.cone(base, -kBuoyWideDeg, kBuoyOverlapDeg, kBuoyMm, "green");
  // 300 mm wide, and low enough for the robot to drive over.
  const Point back = Drawing::on_circle(base.origin, 20.0, base.heading_deg + 180.0);
  drawing.add(
      "<rect class='base' x='-20' y='-150' width='60' height='300' "
      "transform='translate(%.0f %.0f) rotate(%.1f)'/>\n",
      back.x_mm, down(back.y_mm), -base.heading_deg);
}

void draw_world(const World& world, Drawing& drawing) {
  for (const Rectangle& cliff : world.cliffs) drawing.rectangle(cliff, "cliff");
  for (const Beam& beam : world.virtual_walls) {
    drawing.cone(beam, -kBeamHalfDeg, kBeamHalfDeg, kBeamMm, "beam");
    drawing.circle(beam.origin, 50.0, "lamp");
  }
  if (world.home_base) draw_home_base(*world.home_base, drawing);
  for (const Rectangle& box : world.boxes) drawing.rectangle(box, "solid");
  for (const Circle& post : world.posts) drawing.circle(post.centre, post.radius_mm, "solid");
  for (const Segment& wall : world.walls) drawing.line(wall.from, wall.to, "wall");
}

void draw_path(std::span<const Waypoint> path, Drawing& drawing) {
  if (path.empty()) return;
  drawing.say("<path class='path' d='");
  WorldPose drawn{};
  for (std::size_t i = 0; i < path.size(); ++i) {
    const WorldPose& pose = path[i].pose;
    const bool begins = i == 0 || path[i].placed;
    // The last waypoint before a leap is always drawn, however close.
    const bool ends = i + 1 == path.size() || path[i + 1].placed;
    const bool far = std::hypot(pose.x_mm - drawn.x_mm, pose.y_mm - drawn.y_mm) >= kPointApartMm;
    if (!begins && !ends && !far) continue;
    drawing.add(begins ? "M%.0f %.0f" : " %.0f %.0f", pose.x_mm, down(pose.y_mm));
    drawn = pose;
  }
  drawing.say("'/>\n");
  for (const Waypoint& waypoint : path) {
    if (!waypoint.bumped) continue;
    const WorldPose& pose = waypoint.pose;
    drawing.circle({pose.x_mm, pose.y_mm}, 28.0, "bump");
  }
  drawing.circle({path.front().pose.x_mm, path.front().pose.y_mm}, 35.0, "begin");
}

void draw_robot(const WorldPose& pose, Drawing& drawing) {
  const Point centre{pose.x_mm, pose.y_mm};
  const double heading_deg = pose.heading_rad / kRadPerDeg;
  const auto rim = [&](double off_deg) {
    return Drawing::on_circle(centre, kRobotRadiusMm, heading_deg + off_deg);
  };
  drawing.circle(centre, kRobotRadiusMm, "robot");
  drawing.arc(rim(-70.0), rim(70.0), kRobotRadiusMm, "bumper");
  drawing.line(centre, rim(0.0), "ahead");
}

// The legend of this drawing, in as many columns as fit.
void draw_legend(const World& world, std::span<const Waypoint> path, const Extent& extent,
                 Drawing& drawing) {
  constexpr double kColumnMm = 800.0;
  double x_mm = extent.left() + 60.0;
  double y_mm = extent.bottom() - 50.0;
  const auto say = [&](const char* name, const char* text) {
    if (x_mm + kColumnMm > extent.right() && y_mm > extent.bottom() - 100.0) {
      x_mm = extent.left() + 60.0;
      y_mm -= 110.0;
    }
    drawing.line({x_mm, y_mm}, {x_mm + 90.0, y_mm}, name);
    drawing.circle({x_mm + 45.0, y_mm}, 28.0, name);
    drawing.add("<text x='%.0f' y='%.0f'>%s</text>\n", x_mm + 120.0, down(y_mm) + 25.0, text);
    x_mm += kColumnMm;
  };
  if (!path.empty()) {
    say("path", "way of the robot");
    say("bump", "bump");
  }
  if (!world.walls.empty()) say("wall", "wall");
  if (world.home_base) say("base", "Home Base");
  if (!world.virtual_walls.empty()) say("lamp", "virtual wall");
  if (!world.cliffs.empty()) say("cliff", "no floor");
}

}  // namespace

std::string draw(const World& world, std::span<const Waypoint> path) {
  const Extent extent = extent_of(world, path);
  Drawing drawing;
  const double height_mm = extent.height() + kLegendMm;
  drawing.add(
      "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' "
      "viewBox='%.0f %.0f %.0f %.0f'>\n",
      extent.width() / kMmPerPixel, height_mm / kMmPerPixel, extent.left(), -extent.top(),
      extent.width(), height_mm);
  drawing.say(kStyle);
  draw_floor(extent, drawing);
  draw_world(world, drawing);
  draw_path(path, drawing);
  draw_robot(path.empty() ? world.start() : path.back().pose, drawing);
  draw_legend(world, path, extent, drawing);
  drawing.say("</svg>\n");
  return drawing.take();
}

}  // namespace cargobay::hal::sim
