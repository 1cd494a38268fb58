// What it is worth to begin from what an earlier drive learnt, and what it costs if that was
// another robot: the first step of random plants, in virtual time. Prints a table. Exit status 1 if
// something that docs/control.md promises does not hold.
// usage: priors [N [SEED]]   N plants of each kind of remainder (1000); seeds from SEED (1) on
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "tests/campaign/draws.hpp"
#include "tests/campaign/plant_drive.hpp"

namespace cargobay::campaign {
namespace {

constexpr double kFirstDriveS = 24.0;
constexpr double kStepS = 4.5;
constexpr std::uint64_t kAnother = 1'000'000;  // seeds of the robot that was there before

double draw(std::mt19937_64& random, double least, double most) {
  return std::uniform_real_distribution<double>{least, most}(random);
}

// Straight, on the spot, in an arc; no faster than the plant can go.
WheelSpeeds any_target(const PlantValues& plant, std::mt19937_64& random) {
  const double fastest = std::min({450.0, std::min(plant.gain_left, plant.gain_right) * kRoomMmS});
  const double speed = draw(random, 20.0, fastest);
  const double shape = draw(random, 0.0, 3.0);
  return {shape < 1.0 ? speed : shape < 2.0 ? -speed : draw(random, 0.4, 0.9) * speed, speed};
}

// What a drive with another target every 1.2 s learns of the plant.
rt::LearntPlant learnt_of(const PlantValues& plant, std::uint64_t seed) {
  std::mt19937_64 random{seed + 7};
  std::vector<WheelSpeeds> targets(20);
  for (WheelSpeeds& target : targets) target = any_target(plant, random);
  return drive(plant, seed + 1, kFirstDriveS,
               [&targets](double seconds) {
                 return targets[static_cast<std::size_t>(seconds / 1.2) % targets.size()];
               })
      .learnt;
}

struct Figures {
  std::vector<double> overshoot{};  // part of the larger of 6 % and 10 mm/s, and a step
  std::vector<double> settled_s{};
  std::vector<double> known_s{};  // until the kind of remainder is, for good
};

void first_step(const PlantValues& plant, std::uint64_t seed, const WheelSpeeds& target,
                const std::optional<rt::LearntPlant>& prior, Figures& figures) {
  const Driven driven =
      drive(plant, seed, kStepS, [&](double) { return target; }, {.prior = prior});
  const auto right = plant.remainder == rt::Remainder::carried ? rt::RemainderBelief::carried
                                                               : rt::RemainderBelief::lost;
  double overshoot_mm_s = 0.0;
  double settled_s = 0.0;
  double known_s = 0.0;
  for (const State& state : driven.states) {
    for (const auto wheel : {&WheelSpeeds::left_mm_s, &WheelSpeeds::right_mm_s}) {
      const double wanted = target.*wheel;
      const double off = (state.truth.*wheel - wanted) * (wanted > 0.0 ? 1.0 : -1.0);
      overshoot_mm_s = std::max(overshoot_mm_s, off);
      if (std::abs(off) > std::max(0.05 * std::abs(wanted), 4.0) + plant.step_mm_s)
        settled_s = state.time_s;
    }
    if (state.belief != right) known_s = state.time_s;
  }
  const double fast = std::max(std::abs(target.left_mm_s), std::abs(target.right_mm_s));
  figures.overshoot.push_back(overshoot_mm_s / (std::max(0.06 * fast, 10.0) + plant.step_mm_s));
  figures.settled_s.push_back(settled_s);
  figures.known_s.push_back(known_s);
}

double at(std::vector<double>& values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(
      std::lround(share * static_cast<double>(values.size() - 1)))];
}

enum Begun : std::uint8_t { from_nothing, from_itself, from_another };
using Compared = std::array<Figures, 3>;

Compared survey(rt::Remainder remainder, std::uint64_t first, std::uint64_t count) {
  const auto other =
      remainder == rt::Remainder::carried ? rt::Remainder::lost : rt::Remainder::carried;
  Compared compared;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const PlantValues plant = any_plant(seed, remainder);
    const PlantValues former = any_plant(seed + kAnother, other);
    std::mt19937_64 random{seed + 3};
    const WheelSpeeds target = any_target(plant, random);
    first_step(plant, seed, target, std::nullopt, compared[from_nothing]);
    first_step(plant, seed, target, learnt_of(plant, seed), compared[from_itself]);
    first_step(plant, seed, target, learnt_of(former, seed), compared[from_another]);
  }
  return compared;
}

void print(Compared& carried, Compared& lost, std::uint64_t count) {
  std::printf(
      "| p50, p95, p99 of %ju first steps each | from nothing | from itself | from another |\n",
      static_cast<std::uintmax_t>(count));
  std::printf("|---|---|---|---|\n");
  const auto row = [](const char* what, Compared& compared, std::vector<double> Figures::* member) {
    std::printf("| %s", what);
    for (Figures& figures : compared) {
      std::vector<double>& values = figures.*member;
      std::printf(" | %.2f, %.2f, %.2f", at(values, 0.5), at(values, 0.95), at(values, 0.99));
    }
    std::printf(" |\n");
  };
  row("carried: overshoot, part of what is allowed", carried, &Figures::overshoot);
  row("carried: settled after, s", carried, &Figures::settled_s);
  row("carried: kind known after, s", carried, &Figures::known_s);
  row("lost: overshoot, part of what is allowed", lost, &Figures::overshoot);
  row("lost: settled after, s", lost, &Figures::settled_s);
  row("lost: kind known after, s", lost, &Figures::known_s);
}

// What was learnt of the robot itself helps; what was learnt of another costs next to nothing.
bool holds(Compared& compared) {
  bool all = true;
  const auto at_most = [&all](const char* what, double value, double most) {
    if (value <= most) return;
    std::printf("does not hold: %s: %.2f, at most %.2f\n", what, value, most);
    all = false;
  };
  constexpr double kSlack = 1.4;  // the 95th of a hundred is not sharp
  const auto compare = [&](const char* what, std::vector<double> Figures::* member, double slack) {
    at_most(what, at(compared[from_another].*member, 0.95),
            kSlack * at(compared[from_nothing].*member, 0.95) + slack);
  };
  compare("overshoot after another robot", &Figures::overshoot, 0.1);
  compare("settling after another robot, s", &Figures::settled_s, 0.0);
  compare("kind of remainder after another robot, s", &Figures::known_s, 0.1);
  at_most("settling after itself, s", at(compared[from_itself].settled_s, 0.5),
          0.9 * at(compared[from_nothing].settled_s, 0.5));
  at_most("overshoot after itself", at(compared[from_itself].overshoot, 0.95), 1.0);
  return all;
}

}  // namespace
}  // namespace cargobay::campaign

int main(int argc, char** argv) {
  namespace campaign = cargobay::campaign;
  using cargobay::rt::Remainder;
  const auto draws = campaign::draws_of(argc, argv, "priors", 1000);
  if (!draws) return 2;
  campaign::Compared carried = campaign::survey(Remainder::carried, draws->first, draws->count);
  campaign::Compared lost = campaign::survey(Remainder::lost, draws->first, draws->count);
  campaign::print(carried, lost, draws->count);
  const bool carried_holds = campaign::holds(carried);
  const bool lost_holds = campaign::holds(lost);
  return carried_holds && lost_holds ? 0 : 1;
}
