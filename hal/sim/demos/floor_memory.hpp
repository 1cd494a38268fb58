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
  std::optional<Place> toward_fresh_around(Fresh how, Place middle);
  std::optional<Place> toward(Place to);
  // Whether nothing was met on the straight way between two places.
  bool open_line(Place from, Place to) const;
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
  enum Mark : std::uint8_t {
    passed = 1,          // the robot's centre was here
    covered = 2,         // its body was
    neared = 4,          // it was within half a metre
    tight = 8,           // so close to what it met that its centre cannot be here
    in_beam = 16,        // its centre was in the beam of a virtual wall
    solid = 128,         // what it met is here
    looked = 64,         // it was within 300 mm
    followed_wall = 32,  // along a wall
  };

  void reckon(const DemoView& view);
  void look(const DemoView& view);
  void meet(const DemoView& view, double away_mm, double off_deg, double room_mm);
  void mark(Place at, double radius_mm, Mark as);
  bool open(std::size_t cell) const;
  // From the robot outward to the first cell that is `wanted`; kCells if there is none.
  template <typename Wanted>
  std::size_t search(Wanted&& wanted);
  template <typename Wanted>
  std::size_t spread(Wanted&& wanted);
  static std::uint8_t old_marks(Fresh how);
  template <typename Cost>
  std::optional<Place> toward_cheapest(Fresh how, int compared, Cost&& cost);
  Place first_leg(std::size_t to) const;

  std::array<std::uint8_t, kCells> cells_{};
  std::array<std::uint16_t, kCells> from_{};  // of a search: where it came from
  std::array<std::uint16_t, kCells> edge_{};
  bool squeezes_ = false;   // through what may be too tight
  std::size_t spread_ = 0;  // cells that a search got to
  std::size_t goal_ = 0;
  std::uint8_t old_ = 0;  // what makes it an old one
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
