// demo_rooms [--from SEED] [--to SEED] [--only cover_and_dock|cover|home|tag|mouse] [--draw
// FOLDER]: the demos that move, in a room of its own for each seed (1 to 20 unless told), in
// virtual time. Prints the table of docs/virtual-create.md. What does not hold goes to standard
// error, and the exit status is 1. --draw draws each run into FOLDER, as SVG.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string_view>
#include <vector>

#include "hal/sim/demos/demo_view.hpp"
#include "tests/campaign/demo_run.hpp"
#include "tests/campaign/floor_map.hpp"
#include "tests/campaign/number.hpp"

namespace cargobay::campaign {
namespace {

using hal::sim::Point;
using oi::DemoNumber;

// What is promised, each as a share.
constexpr double kDocks = 0.95;  // of those that can reach the base by any path, within 3 minutes
constexpr double kDocksInSight = 0.95;  // of those that see it from the start
constexpr double kCovers = 0.80;        // of the floor, on average, in 10 minutes

std::optional<Options> parse(int count, char** words) {
  Options options;
  for (int i = 1; i < count; i += 2) {
    if (i + 1 == count) return std::nullopt;
    const std::string_view option{words[i]};
    const std::string_view value{words[i + 1]};
    if (option == "--only") {
      options.only = value;
    } else if (option == "--draw") {
      options.folder = value;
    } else if (option == "--from" || option == "--to") {
      const auto seed = number(value);
      if (!seed) return std::nullopt;
      (option == "--from" ? options.from : options.to) = *seed;
    } else {
      return std::nullopt;
    }
  }
  return options.to >= options.from ? std::optional{options} : std::nullopt;
}

// Cover and Dock.

enum class Way : std::uint8_t {
  none,    // to the base, for a robot that keeps off stairs and out of virtual walls
  around,  // there is one, past what stands within 0.6 m in front of it
  free,    // nothing stands there
};

Way way_to_base(const RandomRoom& room, const FloorMap& floor) {
  const auto in_front = [&](int away_mm) { return ahead(*room.world.home_base, away_mm); };
  for (int away_mm = 175; away_mm < 250; away_mm += 25) {
    const Point at = in_front(away_mm);
    if (room.world.collide({at.x_mm, at.y_mm, 0.0})) return Way::none;
  }
  if (!floor.reaches(in_front(250))) return Way::none;
  for (int away_mm = 300; away_mm <= 600; away_mm += 50) {
    if (!floor.reaches(in_front(away_mm))) return Way::around;
  }
  return Way::free;
}

bool starts_in_sight(const RandomRoom& room) {
  hal::sim::Inputs inputs;
  room.world.sense(room.world.start(), inputs);
  return inputs.infrared != hal::sim::kNoInfrared;
}

constexpr double kMostS = 600.0;
constexpr double kSoonS = 180.0;

// Those with a way to the base. A time of kMostS is one that did not dock.
struct Docked {
  std::size_t rooms = 0;
  std::size_t around = 0;
  std::size_t around_soon = 0;
  std::size_t fell = 0;  // off stairs, and stopped
  std::vector<double> times_s{};
  std::vector<double> in_sight_s{};    // of those, the base was in sight from the start
  std::vector<double> from_sight_s{};  // since the base was seen first

  std::size_t any_path() const { return times_s.size() + around; }
  double soon_share() const;
};

// Of all that have a path.
double Docked::soon_share() const {
  const auto soon =
      std::count_if(times_s.begin(), times_s.end(), [](double time_s) { return time_s <= kSoonS; });
  return share(static_cast<std::size_t>(soon) + around_soon, any_path());
}

void dock(const Options& options, std::uint64_t seed, Docked& docked) {
  const RandomRoom room = random_room(seed, Furnished::for_cover);
  ++docked.rooms;
  const Way way = way_to_base(room, FloorMap{room});
  if (way == Way::none) return;
  Run run{room, DemoNumber::cover_and_dock, robot(seed, hal::sim::kAllAroundDeg)};
  double first_seen_s = kMostS;
  while (!run.over() && run.time_s() < kMostS) {
    run.step();
    if (run.device().seen().beams().any()) first_seen_s = std::min(first_seen_s, run.time_s());
  }
  run.draw(options, "cover_and_dock", seed);
  const bool docks = run.device().battery().charging();
  const double time_s = docks ? run.time_s() : kMostS;
  if (time_s > kSoonS) {
    std::fprintf(stderr, "cover_and_dock, seed %llu%s: %s at %.0f s, base in sight from %.0f s\n",
                 static_cast<unsigned long long>(seed), way == Way::around ? " (around)" : "",
                 docks ? "docks" : "not docked", run.time_s(), first_seen_s);
  }
  if (way == Way::around) {
    ++docked.around;
    if (time_s <= kSoonS) ++docked.around_soon;
    return;
  }
  if (run.over() && !docks) ++docked.fell;
  docked.times_s.push_back(time_s);
  docked.from_sight_s.push_back(docks ? time_s - first_seen_s : kMostS);
  if (starts_in_sight(room)) docked.in_sight_s.push_back(time_s);
}

void print_docked(const Docked& docked) {
  const auto percent = [](double part) { return 100.0 * part; };
  const std::size_t reachable = docked.times_s.size();
  std::printf("| Cover and Dock | %zu rooms; the base can be reached in %zu (%.1f %%)",
              docked.rooms, reachable, percent(share(reachable, docked.rooms)));
  std::printf(
      "; of these, docked within 1 min %.1f %%, 2 min %.1f %%, **3 min %.1f %%**, 5 min %.1f %%"
      ", 10 min %.1f %%; fallen off stairs: %zu",
      percent(within(docked.times_s, 60.0)), percent(within(docked.times_s, 120.0)),
      percent(within(docked.times_s, kSoonS)), percent(within(docked.times_s, 300.0)),
      percent(within(docked.times_s, kMostS - 1.0)), docked.fell);
  std::printf("; within 2 min since it saw the base first: %.1f %%",
              percent(within(docked.from_sight_s, 120.0)));
  std::printf("; of the %zu that see it from the start, within 3 min: %.1f %%",
              docked.in_sight_s.size(), percent(within(docked.in_sight_s, kSoonS)));
  std::printf("; in %zu more rooms something stands in front of the base: %.1f %% within 3 min",
              docked.around, percent(share(docked.around_soon, docked.around)));
  std::printf("; of these %zu together, **%.1f %%** |\n", docked.any_path(),
              percent(docked.soon_share()));
}

void run_docking(const Options& options, Promises& promises) {
  Docked docked;
  for (std::uint64_t seed = options.from; seed <= options.to; ++seed) dock(options, seed, docked);
  print_docked(docked);
  promises.expect("Cover and Dock", docked.soon_share(), kDocks);
  promises.expect("Cover and Dock, base in sight", within(docked.in_sight_s, kSoonS),
                  kDocksInSight);
}

// Cover.

constexpr std::array<int, 4> kMinutes{1, 2, 5, 10};

void run_cover(const Options& options, Promises& promises) {
  std::array<std::vector<double>, kMinutes.size()> shares{};
  for (std::uint64_t seed = options.from; seed <= options.to; ++seed) {
    RandomRoom room = random_room(seed, Furnished::for_cover);
    room.world.home_base.reset();
    FloorMap floor{room};
    if (!floor.reaches({room.world.start().x_mm, room.world.start().y_mm})) continue;
    Run run{room, DemoNumber::cover, robot(seed, hal::sim::kAllAroundDeg)};
    for (std::size_t i = 0; i < kMinutes.size(); ++i) {
      while (!run.over() && run.time_s() < 60.0 * kMinutes[i]) {
        run.step();
        floor.pass(run.pose());
      }
      shares[i].push_back(floor.covered_share());
    }
    run.draw(options, "cover", seed);
    if (run.over() || shares.back().back() < 0.5) {
      std::fprintf(stderr, "cover, seed %llu: %.2f covered%s at %.0f s\n",
                   static_cast<unsigned long long>(seed), shares.back().back(),
                   run.over() ? ", ends" : "", run.time_s());
    }
  }
  std::printf("| Cover | %zu rooms; of the floor that can be reached, covered (mean, worst tenth)",
              shares[0].size());
  for (std::size_t i = 0; i < kMinutes.size(); ++i) {
    std::sort(shares[i].begin(), shares[i].end());
    double sum = 0.0;
    for (const double each : shares[i]) sum += each;
    const double mean = sum / static_cast<double>(shares[i].size());
    std::printf("%s %d min: %.0f %%, %.0f %%", i == 0 ? "" : ";", kMinutes[i], 100.0 * mean,
                100.0 * shares[i][shares[i].size() / 10]);
    if (i + 1 == kMinutes.size()) promises.expect("Cover", mean, kCovers);
  }
  std::printf(" |\n");
}

// Whether all holds.
bool run(const Options& options) {
  Promises promises;
  const auto wanted = [&](std::string_view name) {
    return options.only.empty() || options.only == name;
  };
  std::printf("| demo | in rooms %llu to %llu |\n|---|---|\n",
              static_cast<unsigned long long>(options.from),
              static_cast<unsigned long long>(options.to));
  if (wanted("cover_and_dock")) run_docking(options, promises);
  if (wanted("cover")) run_cover(options, promises);
  if (wanted("home")) run_homing(options, DemoNumber::home, "home", promises);
  if (wanted("tag")) run_homing(options, DemoNumber::tag, "tag", promises);
  if (wanted("mouse")) run_mouse(options, promises);
  return !promises.broken();
}

}  // namespace
}  // namespace cargobay::campaign

int main(int argc, char** argv) {
  const auto options = cargobay::campaign::parse(argc, argv);
  if (!options) {
    std::fprintf(stderr,
                 "usage: demo_rooms [--from SEED] [--to SEED] "
                 "[--only cover_and_dock|cover|home|tag|mouse] [--draw FOLDER]\n");
    return 2;
  }
  return cargobay::campaign::run(*options) ? 0 : 1;
}
