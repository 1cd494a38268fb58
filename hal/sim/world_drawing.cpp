#include "hal/sim/world_drawing.hpp"

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

constexpr double kMarginMm = 250.0;
constexpr double kFewestMm = 500.0;  // the least that is shown, each way
constexpr double kPointApartMm = 5.0;
constexpr double kBeamMm = 2000.0;
constexpr double kBeamHalfDeg = 10.0;

// The corner points of what is drawn.
class Extent {
 public:
  void include(double x_mm, double y_mm, double around_mm = 0.0) {
    left_ = std::min(left_, x_mm - around_mm);
    right_ = std::max(right_, x_mm + around_mm);
    bottom_ = std::min(bottom_, y_mm - around_mm);
    top_ = std::max(top_, y_mm + around_mm);
  }
  double left() const { return left_ - kMarginMm; }
  double top() const { return top_ + kMarginMm; }
  double width() const { return std::max(right_ - left_, kFewestMm) + 2.0 * kMarginMm; }
  double height() const { return std::max(top_ - bottom_, kFewestMm) + 2.0 * kMarginMm; }

 private:
  double left_ = std::numeric_limits<double>::max();
  double right_ = std::numeric_limits<double>::lowest();
  double bottom_ = std::numeric_limits<double>::max();
  double top_ = std::numeric_limits<double>::lowest();
};

Extent extent_of(const World& world, std::span<const Pose> path) {
  Extent extent;
  extent.include(world.start.x_mm, world.start.y_mm, kRobotRadiusMm);
  for (const Pose& pose : path) extent.include(pose.x_mm, pose.y_mm, kRobotRadiusMm);
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

// Text with numbers in it. SVG counts y downward: every y is negated here and nowhere else.
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
        -(box.corner.y_mm + box.height_mm), box.width_mm, box.height_mm);
  }
  void beam(const Beam& beam, double half_deg, double range_mm, const char* name) {
    constexpr double kRadPerDeg = std::numbers::pi / 180.0;
    const double from = (beam.heading_deg - half_deg) * kRadPerDeg;
    const double to = (beam.heading_deg + half_deg) * kRadPerDeg;
    const double x = beam.origin.x_mm;
    const double y = beam.origin.y_mm;
    add("<path class='%s' d='M%.0f %.0f L%.0f %.0f L%.0f %.0f Z'/>\n", name, x, -y,
        x + range_mm * std::cos(from), -(y + range_mm * std::sin(from)),
        x + range_mm * std::cos(to), -(y + range_mm * std::sin(to)));
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void draw_world(const World& world, Drawing& drawing) {
  for (const Rectangle& cliff : world.cliffs) drawing.rectangle(cliff, "cliff");
  for (const Beam& beam : world.virtual_walls) drawing.beam(beam, kBeamHalfDeg, kBeamMm, "beam");
  if (world.home_base) drawing.beam(*world.home_base, 40.0, 600.0, "base");
  for (const Rectangle& box : world.boxes) drawing.rectangle(box, "solid");
  for (const Circle& post : world.posts) {
    drawing.add("<circle class='solid' cx='%.0f' cy='%.0f' r='%.0f'/>\n", post.centre.x_mm,
                -post.centre.y_mm, post.radius_mm);
  }
  for (const Segment& wall : world.walls) {
    drawing.add("<line class='wall' x1='%.0f' y1='%.0f' x2='%.0f' y2='%.0f'/>\n", wall.from.x_mm,
                -wall.from.y_mm, wall.to.x_mm, -wall.to.y_mm);
  }
}

void draw_path(std::span<const Pose> path, Drawing& drawing) {
  if (path.empty()) return;
  drawing.say("<polyline class='path' points='");
  Pose drawn = path.front();
  drawing.add("%.0f,%.0f", drawn.x_mm, -drawn.y_mm);
  for (const Pose& pose : path) {
    if (std::hypot(pose.x_mm - drawn.x_mm, pose.y_mm - drawn.y_mm) < kPointApartMm) continue;
    drawing.add(" %.0f,%.0f", pose.x_mm, -pose.y_mm);
    drawn = pose;
  }
  drawing.say("'/>\n");
}

void draw_robot(const Pose& pose, Drawing& drawing) {
  drawing.add("<circle class='robot' cx='%.0f' cy='%.0f' r='%.0f'/>\n", pose.x_mm, -pose.y_mm,
              kRobotRadiusMm);
  drawing.add("<line class='robot' x1='%.0f' y1='%.0f' x2='%.0f' y2='%.0f'/>\n", pose.x_mm,
              -pose.y_mm, pose.x_mm + kRobotRadiusMm * std::cos(pose.heading_rad),
              -(pose.y_mm + kRobotRadiusMm * std::sin(pose.heading_rad)));
}

}  // namespace

std::string draw(const World& world, std::span<const Pose> path) {
  const Extent extent = extent_of(world, path);
  Drawing drawing;
  drawing.add("<svg xmlns='http://www.w3.org/2000/svg' viewBox='%.0f %.0f %.0f %.0f'>\n",
              extent.left(), -extent.top(), extent.width(), extent.height());
  drawing.say(
      "<style>*{fill:none;stroke-width:12}.wall{stroke:#222;stroke-width:24}"
      ".solid{fill:#999;stroke:#222}.cliff{fill:#fdd;stroke:#c33;stroke-dasharray:40}"
      ".beam{fill:#cdf}.base{fill:#cfc}.path{stroke:#06c;stroke-width:16}"
      ".robot{stroke:#c60;stroke-width:20}</style>\n");
  draw_world(world, drawing);
  draw_path(path, drawing);
  draw_robot(path.empty() ? world.start : path.back(), drawing);
  drawing.say("</svg>\n");
  return drawing.take();
}

}  // namespace cargobay::hal::sim
