// What a demo remembers of the floor by its own reckoning: where the robot has been, and where it
// met a wall, a cliff or the beam of a virtual wall. And the ways that this leaves open.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/sim/demos/demo_view.hpp"

namespace cargobay::hal::sim {

class FloorMemory {
 public:
  struct Place {
    double x_mm = 0.0;
    double y_mm = 0.0;
  };
  // How new a place is.
  enum class Fresh : std::uint8_t {
    far,        // the robot has not been within half a metre
    near,       // nor within 300 mm
    uncovered,  // it has not passed over it
  };

  // What the beam of a virtual wall is.
  enum class Beams : std::uint8_t {
    close,  // the end of a way
    lead,   // what the robot is after
  };

  // How far its ways keep off what it met.
  enum class Care : std::uint8_t { wide, narrow, squeeze };

  // A demo begins, and nothing is known.
  void reset(const DemoView& view, Beams beams);
  // Forgets the floor, but not where the robot is.
  void forget() { cells_ = {}; }
  // At each tick.
  void watch(const DemoView& view);

  // Where the robot is: from where the demo began, x ahead, angles as `turned_deg` counts.
  Place here() const { return here_; }
  // All the way that it came, to and fro.
  double way_mm() const { return way_mm_; }

  // Where to drive straight on the shortest way known to be open, or not known to be closed: to the
  // nearest place so new, or to this one. Nothing if no way leads there.
  std::optional<Place> toward_fresh(Fresh how);
  // The same, rather close to a place than to the robot.
  std::optional<Place> toward_fresh_around(Fresh how, Place middle, Care least = Care::squeeze);
  // With that much care at least.
  std::optional<Place> toward(Place to, Care least = Care::squeeze);
  // Whether nothing was met on the straight way between two places.
  bool open_line(Place from, Place to) const { return open_line(from, to, Care::wide); }
  // Whether it met nothing that close to where it is.
  bool roomy(double radius_mm) const;
  bool is_fresh(Place at, Fresh how) const;
  // Whether that fresh place is one no longer.
  bool is_old() const;
  // It follows a wall here. Whether it has done so so far ahead of where it is now.
  void follow_here() { mark(here_, kFollowedMm, followed_wall); }
  bool followed(double ahead_mm) const;

 private:
  static constexpr std::size_t kAcross = 128;  // cells
  static constexpr std::size_t kCells = kAcross * kAcross;
  static constexpr double kFollowedMm = 120.0;
  enum Mark : std::uint16_t {
    passed = 1,          // the robot's centre was here
    covered = 2,         // its body was
    neared = 4,          // it was within half a metre
    tight = 8,           // so close to what it met that its centre cannot be here
    in_beam = 16,        // its centre was in the beam of a virtual wall
    solid = 128,         // what it met is here
    looked = 64,         // it was within 300 mm
    followed_wall = 32,  // along a wall
    closed = 256,        // closer than tight: what it met would have to be elsewhere
  };

  void reckon(const DemoView& view);
  void look(const DemoView& view);
  void meet(const DemoView& view, double away_mm, double off_deg, double room_mm);
  // Calls visit(marks) for each cell whose centre is that close; with 0 for the one around it.
  template <typename Visit>
  void visit(Place at, double radius_mm, Visit&& visit);
  void mark(Place at, double radius_mm, Mark as);
  void unmark(Place at, double radius_mm, Mark as);
  bool open(std::size_t cell, Care care) const;
  bool open_line(Place from, Place to, Care care) const;
  // Calls found() with ever less care, until it returns true or the least was not enough.
  template <typename Found>
  void with_less_care(Care least, Found&& found);
  // Outward from the robot, until wanted(cell) returns true; false if it never does.
  template <typename Wanted>
  bool spread(Wanted&& wanted);
  static std::uint16_t old_marks(Fresh how);
  template <typename Cost>
  std::optional<Place> toward_cheapest(Fresh how, Care least_care, int compared, Cost&& cost);
  Place first_leg(std::size_t to) const;

  std::array<std::uint16_t, kCells> cells_{};
  std::array<std::uint16_t, kCells> from_{};  // of a search: where it came from
  std::array<std::uint16_t, kCells> edge_{};
  Care care_ = Care::wide;
  std::size_t spread_ = 0;  // cells that a search got to
  std::size_t goal_ = 0;
  std::uint16_t old_ = 0;  // what makes it an old one
  Beams beams_ = Beams::close;
  Place here_{};
  double way_mm_ = 0.0;
  double last_travelled_mm_ = 0.0;
  double last_turned_deg_ = 0.0;
  double marked_mm_ = 0.0;  // of its way, when it marked the floor last
  bool met_ = false;        // at the last tick
};

// Of places, one by one.
struct MeanPlace {
  double count = 0.0;
  FloorMemory::Place at{};

  void add(FloorMemory::Place place) {
    count += 1.0;
    at.x_mm += (place.x_mm - at.x_mm) / count;
    at.y_mm += (place.y_mm - at.y_mm) / count;
  }
};

}  // namespace cargobay::hal::sim
