#include "tests/campaign/floor_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hal/sim/safety.hpp"

namespace cargobay::campaign {

using hal::sim::kRobotRadiusMm;
using hal::sim::Point;
using hal::sim::Rectangle;
using hal::sim::WorldPose;

namespace {

constexpr double kCellMm = 50.0;

bool near(const Rectangle& cliff, Point at, double distance_mm) {
  const double x = std::clamp(at.x_mm, cliff.corner.x_mm, cliff.corner.x_mm + cliff.width_mm);
  const double y = std::clamp(at.y_mm, cliff.corner.y_mm, cliff.corner.y_mm + cliff.height_mm);
  return std::hypot(at.x_mm - x, at.y_mm - y) < distance_mm;
}

// `world` has no home base: its force field looks like a virtual wall.
bool free(const RandomRoom& room, const hal::sim::World& world, Point at) {
  if (!room.contains(at) || world.collide({at.x_mm, at.y_mm, 0.0})) return false;
  for (const Rectangle& cliff : world.cliffs) {
    if (near(cliff, at, kRobotRadiusMm)) return false;
  }
  hal::sim::Inputs inputs;
  world.sense({at.x_mm, at.y_mm, 0.0}, inputs);
  return !inputs.virtual_wall;
}

}  // namespace

FloorMap::FloorMap(const RandomRoom& room) {
  Point low = room.outline.front();
  Point high = low;
  for (const Point corner : room.outline) {
    low = {std::min(low.x_mm, corner.x_mm), std::min(low.y_mm, corner.y_mm)};
    high = {std::max(high.x_mm, corner.x_mm), std::max(high.y_mm, corner.y_mm)};
  }
  corner_ = low;
  columns_ = static_cast<std::size_t>(std::ceil((high.x_mm - low.x_mm) / kCellMm));
  rows_ = static_cast<std::size_t>(std::ceil((high.y_mm - low.y_mm) / kCellMm));
  cells_.resize(columns_ * rows_);
  look_at(room);
  spread({room.world.start().x_mm, room.world.start().y_mm});
  widen();
}

Point FloorMap::centre(std::size_t index) const {
  const std::size_t column = index % columns_;
  const std::size_t row = index / columns_;
  return {corner_.x_mm + (static_cast<double>(column) + 0.5) * kCellMm,
          corner_.y_mm + (static_cast<double>(row) + 0.5) * kCellMm};
}

std::size_t FloorMap::index_of(Point at) const {
  const double column = std::floor((at.x_mm - corner_.x_mm) / kCellMm);
  const double row = std::floor((at.y_mm - corner_.y_mm) / kCellMm);
  if (column < 0.0 || row < 0.0 || column >= static_cast<double>(columns_) ||
      row >= static_cast<double>(rows_)) {
    return cells_.size();
  }
  return static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column);
}

template <typename Visit>
void FloorMap::visit_around(Point at, double radius_mm, Visit&& visit) const {
  const auto cells = static_cast<int>(std::ceil(radius_mm / kCellMm));
  for (int row = -cells; row <= cells; ++row) {
    for (int column = -cells; column <= cells; ++column) {
      const double x = at.x_mm + column * kCellMm;
      const double y = at.y_mm + row * kCellMm;
      const std::size_t index = index_of({x, y});
      if (index == cells_.size()) continue;
      const Point cell = centre(index);
      if (std::hypot(cell.x_mm - at.x_mm, cell.y_mm - at.y_mm) <= radius_mm) visit(index);
    }
  }
}

void FloorMap::look_at(const RandomRoom& room) {
  hal::sim::World world = room.world;
  world.home_base.reset();
  for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i].free = free(room, world, centre(i));
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    cells_[i].roomy = cells_[i].free;
    visit_around(centre(i), kPassageSlackMm, [&](std::size_t near) {
      if (!cells_[near].free) cells_[i].roomy = false;
    });
  }
}

void FloorMap::spread(Point start) {
  std::vector<std::size_t> edge;
  const auto reach = [&](std::size_t index) {
    if (index >= cells_.size() || cells_[index].reached || !cells_[index].roomy) return;
    cells_[index].reached = true;
    edge.push_back(index);
  };
  // The start may be too close to something to be roomy.
  visit_around(start, 2.0 * kCellMm, reach);
  while (!edge.empty()) {
    const std::size_t index = edge.back();
    edge.pop_back();
    if (index % columns_ > 0) reach(index - 1);
    if (index % columns_ + 1 < columns_) reach(index + 1);
    if (index >= columns_) reach(index - columns_);
    reach(index + columns_);
  }
}

// Free cells beside reached ones are reached too; everything the robot covers there is floor.
void FloorMap::widen() {
  std::vector<std::size_t> beside;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (!cells_[i].reached) continue;
    visit_around(centre(i), kPassageSlackMm, [&](std::size_t near) {
      if (cells_[near].free && !cells_[near].reached) beside.push_back(near);
    });
  }
  for (const std::size_t index : beside) cells_[index].reached = true;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    if (!cells_[i].reached) continue;
    visit_around(centre(i), kRobotRadiusMm, [&](std::size_t below) { cells_[below].floor = true; });
  }
}

bool FloorMap::reaches(Point at) const {
  const std::size_t index = index_of(at);
  return index < cells_.size() && cells_[index].reached;
}

void FloorMap::pass(const WorldPose& pose) {
  visit_around({pose.x_mm, pose.y_mm}, kRobotRadiusMm,
               [&](std::size_t index) { cells_[index].covered = true; });
}

double FloorMap::covered_share() const {
  std::size_t floor = 0;
  std::size_t covered = 0;
  for (const Cell& cell : cells_) {
    if (!cell.floor) continue;
    ++floor;
    if (cell.covered) ++covered;
  }
  return floor == 0 ? 1.0 : static_cast<double>(covered) / static_cast<double>(floor);
}

}  // namespace cargobay::campaign
