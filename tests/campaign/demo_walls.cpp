// The demos that go to virtual walls and along walls: Home, Tag and Mouse.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/campaign/demo_run.hpp"
#include "tests/campaign/floor_map.hpp"

namespace cargobay::campaign {

using hal::sim::Beam;
using hal::sim::Point;
using hal::sim::WorldPose;
using oi::DemoNumber;

namespace {

constexpr double kReaches = 0.95;  // of the starts that can: see run_homing()
constexpr double kLongestS = 600.0;
constexpr double kNever = 2.0 * kLongestS;
constexpr double kFollows = 0.95;  // of the circumference, on average

constexpr double kTouchesMm = 165.0 + 40.0 + 60.0;  // from the robot to the lamp, 60 mm between

// Nothing that a robot would run into on its way straight to the lamp.
bool way_is_free(const RandomRoom& room, Point from, Point lamp, double begin_mm) {
  const WorldPose start{from.x_mm, from.y_mm, 0.0};
  const double whole_mm = distance_mm(start, lamp);
  constexpr double kStepMm = 25.0;
  const auto steps = static_cast<int>(std::ceil((whole_mm - kTouchesMm - begin_mm) / kStepMm)) - 1;
  for (int i = 0; i < steps; ++i) {
    const double part = (begin_mm + i * kStepMm) / whole_mm;
    const WorldPose pose{start.x_mm + part * (lamp.x_mm - start.x_mm),
                         start.y_mm + part * (lamp.y_mm - start.y_mm), 0.0};
    if (room.world.collide(pose)) return false;
  }
  return true;
}

// From the start to each wall, and from one wall to the other.
bool ways_are_free(const RandomRoom& room) {
  const auto& lamps = room.world.virtual_walls;
  const Point start{room.world.start().x_mm, room.world.start().y_mm};
  return std::all_of(lamps.begin(), lamps.end(), [&](const Beam& lamp) {
    return way_is_free(room, start, lamp.origin, 0.0) &&
           std::all_of(lamps.begin(), lamps.end(), [&](const Beam& other) {
             return way_is_free(room, other.origin, lamp.origin, kTouchesMm);
           });
  });
}

// A path leads from the start to a place beside each lamp, with the slack of FloorMap.
bool paths_lead_there(const RandomRoom& room) {
  RandomRoom without_lamps = room;
  without_lamps.world.virtual_walls.clear();
  const FloorMap floor{without_lamps};
  constexpr double kBesideMm = kTouchesMm - 15.0;
  const auto& lamps = room.world.virtual_walls;
  return std::all_of(lamps.begin(), lamps.end(), [&](Beam lamp) {
    for (int turn_deg = 0; turn_deg < 360; turn_deg += 10) {
      lamp.heading_deg = turn_deg;
      if (floor.reaches(ahead(lamp, kBesideMm))) return true;
    }
    return false;
  });
}

struct Reached {
  // All walls, since the start; kNever if it did not.
  std::vector<double> times_s{};            // of all starts
  std::vector<double> times_with_path_s{};  // of those from which a path leads to all of the walls
  std::vector<double> times_with_free_s{};  // of those with nothing in the way to any of the walls
  std::size_t stopped = 0;                  // at what was in the way
};

void reach(const Options& options, DemoNumber demo, std::string_view name, std::uint64_t seed,
           Reached& reached) {
  const RandomRoom room =
      random_room(seed, demo == DemoNumber::home ? Furnished::for_home : Furnished::for_tag);
  const auto& lamps = room.world.virtual_walls;
  const bool free = ways_are_free(room);
  const bool path = paths_lead_there(room);
  Run run{room, demo, robot(seed, 30.0)};
  std::vector<bool> touched(lamps.size(), false);
  const auto all = [&] { return std::count(touched.begin(), touched.end(), false) == 0; };
  while (!all() && !run.over() && run.time_s() < kLongestS) {
    run.step();
    for (std::size_t i = 0; i < lamps.size(); ++i) {
      if (distance_mm(run.pose(), lamps[i].origin) < kTouchesMm) touched[i] = true;
    }
  }
  run.draw(options, name, seed);
  const double time_s = all() ? run.time_s() : kNever;
  reached.times_s.push_back(time_s);
  if (path) reached.times_with_path_s.push_back(time_s);
  if (free) reached.times_with_free_s.push_back(time_s);
  if (!free && (all() || run.over())) ++reached.stopped;
  if (all() || !path) return;
  std::fprintf(stderr, "%s, seed %llu%s: not reached, %.0f s\n", std::string{name}.c_str(),
               static_cast<unsigned long long>(seed), free ? "" : " (around)", run.time_s());
}

double percent(double share) { return 100.0 * share; }

void print_minutes(const std::vector<double>& times_s) {
  for (const int minutes : {1, 2, 3, 5})
    std::printf("%.1f %% within %d min, ", percent(within(times_s, 60.0 * minutes)), minutes);
  std::printf("**%.1f %%** within 10", percent(within(times_s, kLongestS)));
}

void print_home(const Reached& reached) {
  const std::size_t starts = reached.times_s.size();
  const std::size_t free = reached.times_with_free_s.size();
  const std::size_t others = starts - free;
  const double ended = within(reached.times_with_free_s, kLongestS) * static_cast<double>(free) +
                       static_cast<double>(reached.stopped);
  std::printf("| Home | %zu starts that see a beam; from %zu the way is free, and of these ",
              starts, free);
  print_minutes(reached.times_with_free_s);
  std::printf(
      " reach the wall; of the %zu others, %.1f %% reach it or stop at what is in the way; of all, "
      "**%.1f %%** end as the manual says, and %.1f %% reach the wall |\n",
      others, percent(share(reached.stopped, others)), percent(ended / static_cast<double>(starts)),
      percent(within(reached.times_s, kLongestS)));
}

void print_tag(const Reached& reached) {
  std::printf("| Tag | %zu starts that see a beam; of all, ", reached.times_s.size());
  print_minutes(reached.times_s);
  std::printf(" reach both walls; of the %zu from which a path leads to both, ",
              reached.times_with_path_s.size());
  print_minutes(reached.times_with_path_s);
  std::printf("; of the %zu from which the way is free, %.1f %% |\n",
              reached.times_with_free_s.size(),
              percent(within(reached.times_with_free_s, kLongestS)));
}

}  // namespace

// Home can reach the wall where the way is free, because it ends at what is in its way (OI p. 8).
// Tag goes around that.
void run_homing(const Options& options, DemoNumber demo, const char* name, Promises& promises) {
  const bool home = demo == DemoNumber::home;
  Reached reached;
  for (std::uint64_t seed = options.from; seed <= options.to; ++seed)
    reach(options, demo, name, seed, reached);
  (home ? print_home : print_tag)(reached);
  promises.expect(name,
                  within(home ? reached.times_with_free_s : reached.times_with_path_s, kLongestS),
                  kReaches);
}

namespace {

// Of the walls of the room, how much the robot has come along within 5 minutes; a room without
// furniture, so that they are what it finds.
double followed_share(const Options& options, std::uint64_t seed) {
  RandomRoom room = random_room(seed, Furnished::for_home);
  room.world.virtual_walls.clear();
  room.world.boxes.clear();
  room.world.posts.clear();
  room.world.walls.resize(room.outline.size());
  std::vector<Point> along;
  for (const auto& wall : room.world.walls) {
    for (int i = 0; i < 50; ++i) {
      const double part = 0.02 * i;
      along.push_back({wall.from.x_mm + part * (wall.to.x_mm - wall.from.x_mm),
                       wall.from.y_mm + part * (wall.to.y_mm - wall.from.y_mm)});
    }
  }
  const std::size_t whole = along.size();
  Run run{room, DemoNumber::mouse, robot(seed, hal::sim::kAllAroundDeg)};
  while (!run.over() && run.time_s() < 300.0) {
    run.step();
    const WorldPose pose = run.pose();
    // A corner is passed at 1.4 times the robot's radius, and sharp ones farther.
    along.erase(std::remove_if(along.begin(), along.end(),
                               [&](Point each) { return distance_mm(pose, each) < 300.0; }),
                along.end());
  }
  run.draw(options, "mouse", seed);
  const double followed = 1.0 - share(along.size(), whole);
  if (followed < 0.8) {
    std::fprintf(stderr, "mouse, seed %llu: %.2f followed\n", static_cast<unsigned long long>(seed),
                 followed);
  }
  return followed;
}

}  // namespace

void run_mouse(const Options& options, Promises& promises) {
  double sum = 0.0;
  double least = 1.0;
  for (std::uint64_t seed = options.from; seed <= options.to; ++seed) {
    const double followed = followed_share(options, seed);
    sum += followed;
    least = std::min(least, followed);
  }
  const double mean = sum / static_cast<double>(options.to - options.from + 1);
  std::printf(
      "| Mouse | %.0f %% of the walls followed within 5 minutes, %.0f %% in the worst room |\n",
      100.0 * mean, 100.0 * least);
  promises.expect("Mouse", mean, kFollows);
}

}  // namespace cargobay::campaign
