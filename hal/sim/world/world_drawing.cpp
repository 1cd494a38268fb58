#include "hal/sim/world/world_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/sim/safety.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kMarginMm = 200.0;
constexpr double kMmPerPixel = 6.0;
constexpr double kFewestMm = 800.0;  // the least that is shown, in each direction
constexpr double kGridMm = 500.0;
constexpr double kPointApartMm = 5.0;
constexpr double kBeamMm = 2000.0;
constexpr double kBeamHalfDeg = 10.0;
constexpr double kBuoyMm = 700.0;  // a longer one would hide the room
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

constexpr double kMostPixels = 1200.0;

// Fills and colours, and the widths of lines in units; the floor is under everything, so that the
// drawing reads on dark pages too.
struct Style {
  const char* names;
  const char* look;
  double stroke_mm;  // 0: none
};
constexpr std::array<Style, 15> kStyles{{{"floor", "fill:#fff", 0},
                                         {"grid", "stroke:#e6e6e6", 4},
                                         {"cliff", "fill:url(#hatch);stroke:#c33", 10},
                                         {"beam", "fill:#36c;fill-opacity:.13", 0},
                                         {"lamp", "fill:#36c", 0},
                                         {"red", "fill:#d33;fill-opacity:.18", 0},
                                         {"green", "fill:#2a2;fill-opacity:.18", 0},
                                         {"base", "fill:#333", 0},
                                         {"solid", "fill:#cfc6b8;stroke:#7a6f60", 10},
                                         {"wall", "stroke:#222;stroke-linecap:round", 30},
                                         {"path",
                                          "stroke:#06c;stroke-linejoin:round;"
                                          "stroke-linecap:round",
                                          14},
                                         {"begin", "fill:#fff;stroke:#06c", 14},
                                         {"bump", "fill:#e50", 0},
                                         {"robot", "fill:#fff;fill-opacity:.8;stroke:#444", 14},
                                         {"bumper", "stroke:#e50", 30}}};

// The bounding box of the drawing.
class Extent {
 public:
  void include(double x_mm, double y_mm, double around_mm = 0.0) {
    left_ = std::min(left_, x_mm - around_mm);
    right_ = std::max(right_, x_mm + around_mm);
    bottom_ = std::min(bottom_, y_mm - around_mm);
    top_ = std::max(top_, y_mm + around_mm);
  }
  // How many millimetres an element of one millimetre is drawn for: a large world is drawn smaller,
  // and what is written in it is not.
  double unit() const {
    const double longest = std::max(right_ - left_, top_ - bottom_) + 2.0 * kMarginMm;
    return std::max(1.0, longest / (kMostPixels * kMmPerPixel));
  }
  double left() const { return 0.5 * (left_ + right_ - width()); }
  double right() const { return left() + width(); }
  double bottom() const { return 0.5 * (bottom_ + top_ - height()); }
  double top() const { return bottom() + height(); }
  double width() const { return shown(right_ - left_); }
  double height() const { return shown(top_ - bottom_); }

 private:
  double shown(double size_mm) const {
    return std::max(size_mm, kFewestMm) + 2.0 * kMarginMm * unit();
  }

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

void write_style(double unit, Drawing& drawing) {
  drawing.say("<style>*{fill:none}");
  drawing.add("text{font:%.0fpx sans-serif;fill:#666}.ahead{stroke:#444;stroke-width:%.0f}",
              70.0 * unit, 14.0 * unit);
  for (const Style& style : kStyles) {
    drawing.add(".%s{%s;stroke-width:%.0f}", style.names, style.look, style.stroke_mm * unit);
  }
  drawing.say("</style>\n");
  drawing.say(
      "<pattern id='hatch' width='60' height='60' patternUnits='userSpaceOnUse' "
      "patternTransform='rotate(45)'><rect width='60' height='60' style='fill:#fee'/>"
      "<rect width='12' height='60' style='fill:#e99'/></pattern>\n");
}

// Half a metre or, so that not more than 16 lines cross a drawing, 1, 2, 5, 10 ...
double grid_of(double longest_mm) {
  const double rough = longest_mm / 16.0;
  if (rough <= kGridMm) return kGridMm;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double times : {1.0, 2.0, 5.0}) {
    if (rough <= times * power) return times * power;
  }
  return 10.0 * power;
}

// A grid with its coordinates in metres at the left and at the bottom.
void draw_floor(const Extent& extent, double legend_mm, Drawing& drawing) {
  const double unit = extent.unit();
  drawing.rectangle(
      {{extent.left(), extent.bottom() - legend_mm}, extent.width(), extent.height() + legend_mm},
      "floor");
  const double grid_mm = grid_of(std::max(extent.width(), extent.height()));
  const auto multiples = [grid_mm](double from, double to) {
    return std::pair{std::lround(std::ceil(from / grid_mm)), std::lround(std::floor(to / grid_mm))};
  };
  const auto [first_x, last_x] = multiples(extent.left() + 190.0 * unit, extent.right());
  const auto [first_y, last_y] = multiples(extent.bottom() + 100.0 * unit, extent.top());
  drawing.say("<path class='grid' d='");
  for (long i = first_x; i <= last_x; ++i) {
    drawing.add("M%.0f %.0f V%.0f ", static_cast<double>(i) * grid_mm, down(extent.top()),
                down(extent.bottom() + 80.0 * unit));
  }
  for (long i = first_y; i <= last_y; ++i) {
    drawing.add("M%.0f %.0f H%.0f ", extent.left() + 185.0 * unit,
                down(static_cast<double>(i) * grid_mm), extent.right());
  }
  drawing.say("'/>\n");
  for (long i = first_x; i <= last_x; ++i) {
    drawing.add("<text x='%.0f' y='%.0f' text-anchor='middle'>%g</text>\n",
                static_cast<double>(i) * grid_mm, down(extent.bottom() + 10.0 * unit),
                static_cast<double>(i) * grid_mm / 1000.0);
  }
  for (long i = first_y; i <= last_y; ++i) {
    drawing.add("<text x='%.0f' y='%.0f' text-anchor='end'>%g</text>\n",
                extent.left() + 175.0 * unit, down(static_cast<double>(i) * grid_mm) + 25.0 * unit,
                static_cast<double>(i) * grid_mm / 1000.0);
  }
  drawing.add(
      "<text x='%.0f' y='%.0f'>%.1f by %.1f m; grid every %g m, x to the right, y up</text>\n",
      extent.left() + 60.0 * unit, down(extent.bottom() - 80.0 * unit),
      (extent.width() - 2.0 * kMarginMm * unit) / 1000.0,
      (extent.height() - 2.0 * kMarginMm * unit) / 1000.0, grid_mm / 1000.0);
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

void draw_path(std::span<const Waypoint> path, double unit, Drawing& drawing) {
  if (path.empty()) return;
  drawing.say("<path class='path' d='");
  WorldPose drawn{};
  for (std::size_t i = 0; i < path.size(); ++i) {
    const WorldPose& pose = path[i].pose;
    const bool begins = i == 0 || path[i].placed;
    // The last waypoint before a leap is always drawn, however close.
    const bool ends = i + 1 == path.size() || path[i + 1].placed;
    const bool far =
        std::hypot(pose.x_mm - drawn.x_mm, pose.y_mm - drawn.y_mm) >= kPointApartMm * unit;
    if (!begins && !ends && !far) continue;
    drawing.add(begins ? "M%.0f %.0f" : " %.0f %.0f", pose.x_mm, down(pose.y_mm));
    drawn = pose;
  }
  drawing.say("'/>\n");
  for (const Waypoint& waypoint : path) {
    if (!waypoint.bumped) continue;
    const WorldPose& pose = waypoint.pose;
    drawing.circle({pose.x_mm, pose.y_mm}, 28.0 * unit, "bump");
  }
  drawing.circle({path.front().pose.x_mm, path.front().pose.y_mm}, 35.0 * unit, "begin");
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

// Below the floor: the size, and what is what in as many columns as fit.
class Legend {
 public:
  Legend(const World& world, std::span<const Waypoint> path) {
    if (!path.empty()) {
      line("path", "way of the robot");
      dot("begin", "its beginning");
      if (std::ranges::any_of(path, &Waypoint::bumped)) dot("bump", "bump");
    }
    dot("robot", "robot");
    if (!world.walls.empty()) line("wall", "wall");
    if (!world.boxes.empty() || !world.posts.empty()) dot("solid", "furniture");
    if (world.home_base) dot("base", "Home Base");
    if (!world.virtual_walls.empty()) dot("lamp", "virtual wall");
    if (!world.cliffs.empty()) dot("cliff", "no floor");
  }

  double height_mm(const Extent& extent) const {
    const std::size_t rows = (entries_.size() + columns(extent) - 1) / columns(extent);
    return (kSizeMm + kRowMm * static_cast<double>(rows)) * extent.unit();
  }

  void draw(const Extent& extent, Drawing& drawing) const {
    const double unit = extent.unit();
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const std::size_t rows_above = i / columns(extent);
      const auto row = static_cast<double>(rows_above);
      const auto column = static_cast<double>(i % columns(extent));
      const double x = extent.left() + (60.0 + column * kColumnMm) * unit;
      const double y = extent.bottom() - (kSizeMm + (row + 0.4) * kRowMm) * unit;
      if (entries_[i].line) {
        drawing.line({x, y}, {x + 90.0 * unit, y}, entries_[i].name);
      } else {
        drawing.circle({x + 45.0 * unit, y}, 28.0 * unit, entries_[i].name);
      }
      drawing.add("<text x='%.0f' y='%.0f'>%s</text>\n", x + 120.0 * unit, down(y) + 25.0 * unit,
                  entries_[i].text);
    }
  }

 private:
  struct Entry {
    const char* name;
    const char* text;
    bool line;
  };
  void line(const char* name, const char* text) { entries_.push_back({name, text, true}); }
  void dot(const char* name, const char* text) { entries_.push_back({name, text, false}); }
  static std::size_t columns(const Extent& extent) {
    return static_cast<std::size_t>(
        std::max(1.0, (extent.width() / extent.unit() - 60.0) / kColumnMm));
  }

  static constexpr double kSizeMm = 110.0;  // the line that says how large it is
  static constexpr double kRowMm = 100.0;
  static constexpr double kColumnMm = 800.0;
  std::vector<Entry> entries_;
};

}  // namespace

std::string draw(const World& world, std::span<const Waypoint> path) {
  const Extent extent = extent_of(world, path);
  Drawing drawing;
  const double unit = extent.unit();
  const Legend legend{world, path};
  const double legend_mm = legend.height_mm(extent);
  const double height_mm = extent.height() + legend_mm;
  drawing.add(
      "<svg xmlns='http://www.w3.org/2000/svg' width='%.0f' height='%.0f' "
      "viewBox='%.0f %.0f %.0f %.0f'>\n",
      extent.width() / kMmPerPixel / unit, height_mm / kMmPerPixel / unit, extent.left(),
      -extent.top(), extent.width(), height_mm);
  write_style(unit, drawing);
  draw_floor(extent, legend_mm, drawing);
  draw_world(world, drawing);
  draw_path(path, unit, drawing);
  draw_robot(path.empty() ? world.start() : path.back().pose, drawing);
  legend.draw(extent, drawing);
  drawing.say("</svg>\n");
  return drawing.take();
}

}  // namespace cargobay::hal::sim
