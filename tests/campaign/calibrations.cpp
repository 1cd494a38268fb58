// `cargobay calibrate` on random plants of random wheel base, in virtual time: how well it finds
// the base, and how the robot drives before and after. Prints a table. Exit status 1 if something
// that docs/control.md promises does not hold.
// usage: calibrations [N [SEED]]   N plants of each kind of remainder (200); seeds from SEED (1) on
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "hal/robot/calibration.hpp"
#include "tests/campaign/draws.hpp"
#include "tests/campaign/plant_drive.hpp"

namespace cargobay::campaign {
namespace {

constexpr double kBaseMm = 258.0;
constexpr double kLongestS = 60.0;

PlantValues any_robot(std::uint64_t seed, rt::Remainder remainder) {
  PlantValues plant = any_plant(seed, remainder);
  std::mt19937_64 random{seed + 13};
  plant.wheel_base_mm = kBaseMm * std::uniform_real_distribution<double>{0.98, 1.02}(random);
  plant.counts_by_command = seed % 2 == 0;
  return plant;
}

// Drives the pattern as the command does.
hal::Result<hal::CalibrationResult> calibrate(const PlantValues& plant, std::uint64_t seed) {
  constexpr double kSpeedMmS = 200.0;
  constexpr double kDelayS = 0.0025;  // PlantRobot's
  hal::Calibration calibration{kSpeedMmS};
  hal::CycleParameters parameters;
  hal::Calibration::prepare(parameters);
  PlantRobot robot{plant, seed};
  rt::WheelLoop loop{parameters.loop};
  rt::Axes reads = rt::kBothAxes;
  const int ticks = static_cast<int>(hal::Calibration::duration_s() / kTickS) + 1;
  for (int tick = 0; tick < ticks; ++tick) {
    robot.tick(loop.command());
    hal::CycleState state{.tick = tick};
    state.reading = robot.read(reads);
    loop.frame(state.reading);
    (void)loop.take_travels();
    state.command = loop.control(calibration.at(tick * kTickS));
    calibration.see(state);
    reads = loop.next_reads();
  }
  return calibration.result(kDelayS);
}

// Another target every 1.2 s: arcs and turns on the spot, where the wheel base counts.
Target about(const PlantValues& plant, std::uint64_t seed) {
  std::mt19937_64 random{seed + 7};
  const auto draw = [&random](double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random);
  };
  const double fastest = std::min(300.0, std::min(plant.gain_left, plant.gain_right) * kRoomMmS);
  std::vector<WheelSpeeds> targets;
  for (int i = 0; i < 40; ++i) {
    const double speed = draw(60.0, fastest) * (draw(0.0, 1.0) < 0.3 ? -1.0 : 1.0);
    targets.push_back(draw(0.0, 2.0) < 1.0 ? WheelSpeeds{-0.6 * speed, 0.6 * speed}
                                           : WheelSpeeds{draw(0.4, 1.0) * speed, speed});
  }
  return [targets](double seconds) {
    return targets[static_cast<std::size_t>(seconds / 1.2) % targets.size()];
  };
}

double tracking_mm_s(const PlantValues& plant, std::uint64_t seed, double wheel_base_mm) {
  constexpr double kFromS = 5.0;
  const Driven driven =
      drive(plant, seed, 35.0, about(plant, seed), {.wheel_base_mm = wheel_base_mm});
  double sum = 0.0;
  int count = 0;
  for (const State& state : driven.states) {
    if (state.time_s < kFromS) continue;
    sum += std::pow(state.truth.left_mm_s - state.set.left_mm_s, 2) +
           std::pow(state.truth.right_mm_s - state.set.right_mm_s, 2);
    count += 2;
  }
  return std::sqrt(sum / count);
}

struct Figures {
  std::vector<double> before_mm{};  // error of the wheel base
  std::vector<double> after_mm{};
  std::vector<double> tracking{};  // rms after, by that before
  std::vector<double> another{};   // the same where nothing but 0.1 mm of the base has changed
  int refused = 0;
};

double at(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(
      std::lround(share * static_cast<double>(values.size() - 1)))];
}

Figures survey(rt::Remainder remainder, std::uint64_t first, std::uint64_t count) {
  Figures figures;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const PlantValues plant = any_robot(seed, remainder);
    const auto result = calibrate(plant, seed);
    if (!result) {
      std::printf("plant %ju is refused: %s\n", static_cast<std::uintmax_t>(seed),
                  result.failure().message.c_str());
      ++figures.refused;
      continue;
    }
    const double before = tracking_mm_s(plant, seed, kBaseMm);
    const double after = tracking_mm_s(plant, seed, result->wheel_base_mm);
    const double another = tracking_mm_s(plant, seed, kBaseMm + 0.1);
    figures.before_mm.push_back(std::abs(kBaseMm - plant.wheel_base_mm));
    figures.after_mm.push_back(std::abs(result->wheel_base_mm - plant.wheel_base_mm));
    figures.tracking.push_back(after / before);
    figures.another.push_back(another / before);
  }
  return figures;
}

void print(Figures& carried, Figures& lost, std::uint64_t count) {
  const auto row = [&](const char* what, std::vector<double> Figures::* member) {
    std::printf("| %s", what);
    for (Figures* figures : {&carried, &lost}) {
      std::vector<double>& values = figures->*member;
      std::printf(" | %.2f, %.2f, %.2f", at(values, 0.5), at(values, 0.95), at(values, 1.0));
    }
    std::printf(" |\n");
  };
  std::printf("| p50, p95 and worst of %ju plants each | carried | lost |\n|---|---|---|\n",
              static_cast<std::uintmax_t>(count));
  row("error of the wheel base before, mm", &Figures::before_mm);
  row("error of the wheel base after, mm", &Figures::after_mm);
  row("tracking rms after, by that before", &Figures::tracking);
  row("the same for a drive that differs in 0.1 mm of the base", &Figures::another);
  std::printf("| refused | %d | %d |\n", carried.refused, lost.refused);
}

bool holds(Figures& figures, double most_mm) {
  constexpr double kAlike = 1.05;  // more than two drives of one robot differ by, at p95
  bool all = true;
  const auto at_most = [&all](const char* what, double value, double most) {
    if (value <= most) return;
    std::printf("does not hold: %s: %.2f, at most %.2f\n", what, value, most);
    all = false;
  };
  at_most("error of the wheel base, worst", at(figures.after_mm, 1.0), most_mm);
  at_most("tracking after, by that before", at(figures.tracking, 0.95), kAlike);
  at_most("refused", figures.refused, 0.0);
  at_most("duration, s", hal::Calibration::duration_s(), kLongestS);
  return all;
}

}  // namespace
}  // namespace cargobay::campaign

int main(int argc, char** argv) {
  namespace campaign = cargobay::campaign;
  using cargobay::rt::Remainder;
  const auto draws = campaign::draws_of(argc, argv, "calibrations", 200);
  if (!draws) return 2;
  campaign::Figures carried = campaign::survey(Remainder::carried, draws->first, draws->count);
  campaign::Figures lost = campaign::survey(Remainder::lost, draws->first, draws->count);
  campaign::print(carried, lost, draws->count);
  const bool carried_holds = campaign::holds(carried, 1.5);
  const bool lost_holds = campaign::holds(lost, 2.5);
  return carried_holds && lost_holds ? 0 : 1;
}
