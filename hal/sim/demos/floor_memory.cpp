#include "hal/sim/demos/floor_memory.hpp"

#include <algorithm>
#include <cmath>

#include "hal/sim/safety.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kCellMm = 100.0;
constexpr double kMarksEveryMm = 40.0;
constexpr double kNearedMm = 500.0;
constexpr double kLookedMm = 300.0;
constexpr double kCoveredMm = 170.0;
constexpr double kRoomMm = 190.0;      // the centre comes no closer to a wall
constexpr double kHoleMm = 230.0;      // to a hole, which it must not touch
constexpr double kBeamRoomMm = 300.0;  // what it sees of a beam is some of it
constexpr double kClosedMm = 130.0;
constexpr double kBeamClosedMm = 130.0;
constexpr double kWallSensorMm = 120.0;  // how far it sees; its signal is 4095 at a distance of 0
constexpr double kBumpSideDeg = 45.0;
// A bumper that is pressed holds the robot, whatever its wheels do: how much of its way remains.
constexpr double kPartHeldBoth = 0.1;
constexpr double kPartHeldSide = 0.6;
// With one side it slides along what it touches: by so much of its way to the other side.
constexpr double kPartAside = 0.36;

constexpr double kMmPerDeg = 3.0;
constexpr std::size_t kEnclosed = 60;  // cells: too few to be all of the room
constexpr int kComparedPlaces = 40;

double apart_mm(FloorMemory::Place a, FloorMemory::Place b) {
  return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm);
}

}  // namespace

// The grid has the start in its middle.
namespace {
template <std::size_t kAcross>
struct Grid {
  static constexpr double kHalfMm = 0.5 * kCellMm * static_cast<double>(kAcross);
  static bool inside(FloorMemory::Place at) {
    return std::abs(at.x_mm) < kHalfMm && std::abs(at.y_mm) < kHalfMm;
  }
  static std::size_t index(FloorMemory::Place at) {
    const auto column = static_cast<std::size_t>((at.x_mm + kHalfMm) / kCellMm);
    const auto row = static_cast<std::size_t>((at.y_mm + kHalfMm) / kCellMm);
    return row * kAcross + column;
  }
  static FloorMemory::Place centre(std::size_t index) {
    const std::size_t row = index / kAcross;
    const std::size_t column = index % kAcross;
    return {.x_mm = (static_cast<double>(column) + 0.5) * kCellMm - kHalfMm,
            .y_mm = (static_cast<double>(row) + 0.5) * kCellMm - kHalfMm};
  }
};
}  // namespace

void FloorMemory::reset(const DemoView& view, Beams beams) {
  beams_ = beams;
  forget();
  here_ = {};
  last_travelled_mm_ = view.travelled_mm;
  last_turned_deg_ = view.turned_deg;
  marked_mm_ = way_mm_ - kMarksEveryMm;
  met_ = false;
}

void FloorMemory::watch(const DemoView& view) {
  reckon(view);
  look(view);
}

void FloorMemory::reckon(const DemoView& view) {
  double gone_mm = view.travelled_mm - last_travelled_mm_;
  double aside_mm = 0.0;
  if (gone_mm > 0.0 && bumped_both(*view.seen)) {
    gone_mm *= kPartHeldBoth;
  } else if (gone_mm > 0.0 && bumped(*view.seen)) {
    aside_mm = (view.seen->bump_left ? -kPartAside : kPartAside) * gone_mm;
    gone_mm *= kPartHeldSide;
  }
  const double heading_rad = radians(0.5 * (view.turned_deg + last_turned_deg_));
  here_.x_mm += gone_mm * std::cos(heading_rad) - aside_mm * std::sin(heading_rad);
  here_.y_mm += gone_mm * std::sin(heading_rad) + aside_mm * std::cos(heading_rad);
  way_mm_ += std::abs(view.travelled_mm - last_travelled_mm_);
  last_travelled_mm_ = view.travelled_mm;
  last_turned_deg_ = view.turned_deg;
}

void FloorMemory::look(const DemoView& view) {
  const Inputs& seen = *view.seen;
  const bool meets = bumped(seen) || seen.any_cliff() || seen.virtual_wall;
  if (way_mm_ - marked_mm_ < kMarksEveryMm && meets == met_) return;
  marked_mm_ = way_mm_;
  mark(here_, 0.0, passed);
  unmark(here_, 0.0, static_cast<Mark>(closed | solid));
  mark(here_, kCoveredMm, covered);
  mark(here_, kNearedMm, neared);
  mark(here_, kLookedMm, looked);
  if (bumped(seen)) {
    const double off_deg = bumped_both(seen) ? 0.0 : seen.bump_left ? kBumpSideDeg : -kBumpSideDeg;
    meet(view, kRobotRadiusMm, off_deg, kRoomMm);
  }
  if (seen.wall_signal > 0) {
    const double away_mm = kWallSensorMm * (1.0 - seen.wall_signal / 4095.0);
    meet(view, kRobotRadiusMm + away_mm, kWallSensorDeg, kRoomMm);
  }
  if (seen.cliff_left.cliff) meet(view, kCliffSideMm, kCliffSideDeg, kHoleMm);
  if (seen.cliff_front_left.cliff) meet(view, kCliffFrontMm, kCliffFrontDeg, kHoleMm);
  if (seen.cliff_front_right.cliff) meet(view, kCliffFrontMm, -kCliffFrontDeg, kHoleMm);
  if (seen.cliff_right.cliff) meet(view, kCliffSideMm, -kCliffSideDeg, kHoleMm);
  // The force field of a Home Base looks like one.
  if (beams_ == Beams::close && seen.virtual_wall &&
      !seen.beams().has(oi::HomeBaseBeam::force_field)) {
    mark(here_, 0.0, in_beam);
    mark(here_, kBeamRoomMm, tight);
    mark(here_, kBeamClosedMm, closed);
  }
  met_ = meets;
}

void FloorMemory::meet(const DemoView& view, double away_mm, double off_deg, double room_mm) {
  const double way_rad = radians(view.turned_deg + off_deg);
  const Place at{.x_mm = here_.x_mm + away_mm * std::cos(way_rad),
                 .y_mm = here_.y_mm + away_mm * std::sin(way_rad)};
  mark(at, room_mm, tight);
  mark(at, kClosedMm, closed);
  unmark(at, kClosedMm, passed);
  mark(at, 0.0, solid);
}

template <typename Visit>
void FloorMemory::visit(Place at, double radius_mm, Visit&& visit) {
  using G = Grid<kAcross>;
  if (radius_mm == 0.0) {
    if (G::inside(at)) visit(cells_[G::index(at)]);
    return;
  }
  const int cells = static_cast<int>(std::ceil(radius_mm / kCellMm));
  for (int row = -cells; row <= cells; ++row) {
    for (int column = -cells; column <= cells; ++column) {
      const Place near{.x_mm = at.x_mm + kCellMm * column, .y_mm = at.y_mm + kCellMm * row};
      if (!G::inside(near)) continue;
      const std::size_t cell = G::index(near);
      if (apart_mm(G::centre(cell), at) <= radius_mm) visit(cells_[cell]);
    }
  }
}

void FloorMemory::mark(Place at, double radius_mm, Mark as) {
  visit(at, radius_mm, [as](std::uint16_t& marks) { marks |= as; });
}

void FloorMemory::unmark(Place at, double radius_mm, Mark as) {
  visit(at, radius_mm, [as](std::uint16_t& marks) { marks &= static_cast<std::uint16_t>(~as); });
}

bool FloorMemory::followed(double ahead_mm) const {
  using G = Grid<kAcross>;
  const double heading_rad = radians(last_turned_deg_);
  const Place at{.x_mm = here_.x_mm + ahead_mm * std::cos(heading_rad),
                 .y_mm = here_.y_mm + ahead_mm * std::sin(heading_rad)};
  return G::inside(at) && (cells_[G::index(at)] & followed_wall) != 0;
}

bool FloorMemory::open(std::size_t cell, Care care) const {
  const std::uint16_t marks = cells_[cell];
  if ((marks & in_beam) != 0) return false;
  if ((marks & passed) != 0) return true;
  const Mark shut = care == Care::wide ? tight : care == Care::narrow ? closed : solid;
  return (marks & shut) == 0;
}

bool FloorMemory::open_line(Place from, Place to, Care care) const {
  using G = Grid<kAcross>;
  const double long_mm = apart_mm(from, to);
  const int steps = static_cast<int>(std::ceil(long_mm / (0.5 * kCellMm)));
  for (int i = 1; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    const Place at{.x_mm = from.x_mm + part * (to.x_mm - from.x_mm),
                   .y_mm = from.y_mm + part * (to.y_mm - from.y_mm)};
    if (apart_mm(at, from) < kCellMm) continue;
    if (!G::inside(at) || !open(G::index(at), care)) return false;
  }
  return true;
}

bool FloorMemory::roomy(double radius_mm) const {
  using G = Grid<kAcross>;
  for (int turn_deg = 0; turn_deg < 360; turn_deg += 30) {
    const Place at{.x_mm = here_.x_mm + radius_mm * std::cos(radians(turn_deg)),
                   .y_mm = here_.y_mm + radius_mm * std::sin(radians(turn_deg))};
    if (!G::inside(at) || (cells_[G::index(at)] & tight) != 0) return false;
  }
  return true;
}

template <typename Found>
void FloorMemory::with_less_care(Care least, Found&& found) {
  for (const Care care : {Care::wide, Care::narrow, Care::squeeze}) {
    care_ = care;
    if (care == Care::squeeze && spread_ >= kEnclosed) return;
    if (found() || care == least) return;
  }
}

template <typename Wanted>
bool FloorMemory::spread(Wanted&& wanted) {
  using G = Grid<kAcross>;
  constexpr std::uint16_t kUnseen = 0xffff;
  if (!G::inside(here_)) return false;
  from_.fill(kUnseen);
  std::size_t begin = 0;
  std::size_t end = 0;
  const std::size_t start = G::index(here_);
  from_[start] = static_cast<std::uint16_t>(start);
  edge_[end++] = static_cast<std::uint16_t>(start);
  const auto try_cell = [&](std::size_t cell, std::size_t from) {
    if (from_[cell] != kUnseen || !open(cell, care_)) return;
    from_[cell] = static_cast<std::uint16_t>(from);
    edge_[end++] = static_cast<std::uint16_t>(cell);
  };
  while (begin < end) {
    const std::size_t cell = edge_[begin++];
    if (wanted(cell)) return true;
    const std::size_t column = cell % kAcross;
    const std::size_t row = cell / kAcross;
    if (column > 0) try_cell(cell - 1, cell);
    if (column + 1 < kAcross) try_cell(cell + 1, cell);
    if (row > 0) try_cell(cell - kAcross, cell);
    if (row + 1 < kAcross) try_cell(cell + kAcross, cell);
  }
  spread_ = end;
  return false;
}

// The farthest place on the way found that a straight line leads to.
FloorMemory::Place FloorMemory::first_leg(std::size_t to) const {
  using G = Grid<kAcross>;
  std::size_t cell = to;
  while (from_[cell] != cell) {
    if (open_line(here_, G::centre(cell), care_)) return G::centre(cell);
    if (from_[from_[cell]] == from_[cell]) break;  // the first step
    cell = from_[cell];
  }
  return G::centre(cell);
}

std::uint16_t FloorMemory::old_marks(Fresh how) {
  const Mark been = how == Fresh::far ? neared : how == Fresh::near ? looked : covered;
  return static_cast<std::uint16_t>(been | tight);
}

bool FloorMemory::is_fresh(Place at, Fresh how) const {
  using G = Grid<kAcross>;
  return G::inside(at) && (cells_[G::index(at)] & old_marks(how)) == 0;
}

// Of the first places found, the one that costs least.
template <typename Cost>
std::optional<FloorMemory::Place> FloorMemory::toward_cheapest(Fresh how, Care least_care,
                                                               int compared, Cost&& cost) {
  using G = Grid<kAcross>;
  old_ = old_marks(how);
  goal_ = kCells;
  double least = 0.0;
  with_less_care(least_care, [&] {
    int found = 0;
    spread([&](std::size_t cell) {
      if ((cells_[cell] & old_) != 0) return false;
      const double now = cost(G::centre(cell));
      if (goal_ == kCells || now < least) {
        goal_ = cell;
        least = now;
      }
      return ++found == compared;
    });
    return found > 0;
  });
  if (goal_ == kCells) return std::nullopt;
  return first_leg(goal_);
}

// It also turns as little as it can.
std::optional<FloorMemory::Place> FloorMemory::toward_fresh(Fresh how) {
  return toward_cheapest(how, Care::squeeze, kComparedPlaces, [this](Place at) {
    const double way_deg =
        std::atan2(at.y_mm - here_.y_mm, at.x_mm - here_.x_mm) * 180.0 / std::numbers::pi;
    const double turn_deg = std::abs(std::remainder(way_deg - last_turned_deg_, 360.0));
    return apart_mm(at, here_) + kMmPerDeg * turn_deg;
  });
}

std::optional<FloorMemory::Place> FloorMemory::toward_fresh_around(Fresh how, Place middle,
                                                                   Care least) {
  return toward_cheapest(how, least, 4 * kComparedPlaces, [this, middle](Place at) {
    return 2.0 * apart_mm(at, middle) + apart_mm(at, here_);
  });
}

bool FloorMemory::is_old() const { return goal_ == kCells || (cells_[goal_] & old_) != 0; }

std::optional<FloorMemory::Place> FloorMemory::toward(Place to, Care least) {
  using G = Grid<kAcross>;
  if (!G::inside(to)) return std::nullopt;
  if (open_line(here_, to)) return to;
  const std::size_t goal = G::index(to);
  bool leads_there = false;
  with_less_care(least,
                 [&] { return leads_there = spread([&](std::size_t at) { return at == goal; }); });
  if (!leads_there) return std::nullopt;
  return first_leg(goal);
}

}  // namespace cargobay::hal::sim
