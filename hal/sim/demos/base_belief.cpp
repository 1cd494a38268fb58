#include "hal/sim/demos/base_belief.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/sim/safety.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr double kBeliefRadPerDeg = std::numbers::pi / 180.0;

constexpr double kLitWideRad = 40.0 * kBeliefRadPerDeg;
constexpr double kLitOverlapRad = 5.0 * kBeliefRadPerDeg;

constexpr double kRememberedMm = 60.0;   // what it sees is remembered at places so far apart
constexpr double kCostPerMm = 0.02;      // beyond the edge of a light
constexpr double kMostCost = 4.0;        // of a sighting: reckoning may be wrong
constexpr double kMostHiddenCost = 0.3;  // the same where it sees nothing
constexpr double kNotInBaseMm = 180.0;
constexpr double kBesideWallMm = 600.0;  // the wall goes on for so long beside the base
constexpr double kIntoWallMm = 80.0;
constexpr int kTriesPerSighting = 210;
constexpr double kAgreesCost = 2.0;  // this much worse than the best guess
constexpr double kFewestAgree = 0.25;
constexpr double kMostSpreadMm = 120.0;
constexpr double kMostSpreadRad = 15.0 * kBeliefRadPerDeg;

double wrapped_rad(double angle_rad) { return std::remainder(angle_rad, 2.0 * std::numbers::pi); }

}  // namespace

// How far the sighting lies on the wrong side of the edge of each light.
double BaseBelief::cost(const Place& place, const Sighting& sighting) {
  const double x_mm = sighting.x_mm - place.x_mm;
  const double y_mm = sighting.y_mm - place.y_mm;
  const double away_mm = std::hypot(x_mm, y_mm);
  const double off_rad = wrapped_rad(std::atan2(y_mm, x_mm) - place.heading_rad);
  const double reach_mm = kBaseLitMm - away_mm;
  // Positive within the light. Red is to the left of the base, as it looks into the room.
  const auto inside_mm = [&](double side) {
    const double off = side * off_rad;
    return std::min(reach_mm, away_mm * std::min(off + kLitOverlapRad, kLitWideRad - off));
  };
  double wrong_mm = 0.0;
  const auto compare = [&](oi::HomeBaseBeam beam, double depth_mm) {
    wrong_mm += std::max(sighting.light.has(beam) ? -depth_mm : depth_mm, 0.0);
  };
  compare(oi::HomeBaseBeam::red_buoy, inside_mm(1.0));
  compare(oi::HomeBaseBeam::green_buoy, inside_mm(-1.0));
  compare(oi::HomeBaseBeam::force_field, kBaseFieldMm - away_mm);
  const double light =
      std::min(kCostPerMm * wrong_mm, sighting.light.any() ? kMostCost : kMostHiddenCost);
  // The robot was not in the base, nor in the wall that the base stands at.
  const double inside = std::max(kNotInBaseMm - away_mm, 0.0);
  const double behind = away_mm < kBesideWallMm ? std::max(-away_mm * std::cos(off_rad), 0.0) : 0.0;
  return light + std::min(kCostPerMm * std::max(inside, behind - kIntoWallMm), kMostCost);
}

double BaseBelief::cost(const Place& place) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < std::min(seen_, kSightings); ++i) sum += cost(place, sightings_[i]);
  return sum;
}

void BaseBelief::see(double x_mm, double y_mm, oi::HomeBaseBeams light) {
  if (seen_ == 0 && !light.any()) return;
  const Sighting sighting{.x_mm = x_mm, .y_mm = y_mm, .light = light};
  if (seen_ == 0) {
    remember(sighting);
    guess_around(sighting);
    return;
  }
  const Sighting& last = sightings_[(seen_ - 1) % kSightings];
  if (light == last.light && std::hypot(x_mm - last.x_mm, y_mm - last.y_mm) < kRememberedMm) return;
  remember(sighting);
  improve();
}

void BaseBelief::remember(const Sighting& sighting) {
  Sighting& oldest = sightings_[seen_ % kSightings];
  const bool replaces = seen_ >= kSightings;
  for (Guess& guess : guesses_) {
    guess.cost += cost(guess.place, sighting) - (replaces ? cost(guess.place, oldest) : 0.0);
  }
  oldest = sighting;
  ++seen_;
}

void BaseBelief::guess_around(const Sighting& sighting) {
  for (Guess& guess : guesses_) {
    guess.place = {.x_mm = sighting.x_mm + either_way(kBaseLitMm),
                   .y_mm = sighting.y_mm + either_way(kBaseLitMm),
                   .heading_rad = either_way(std::numbers::pi)};
    guess.cost = cost(guess.place);
  }
}

// Anywhere from where a base would throw this light here.
BaseBelief::Place BaseBelief::guess_from(const Sighting& sighting) {
  using enum oi::HomeBaseBeam;
  const bool red = sighting.light.has(red_buoy);
  const bool green = sighting.light.has(green_buoy);
  const double most_mm = sighting.light.has(force_field) ? kBaseFieldMm : kBaseLitMm;
  const double away_mm = kNotInBaseMm + (most_mm - kNotInBaseMm) * random_.uniform();
  const double way_rad = either_way(std::numbers::pi);
  double off_rad = either_way(0.5 * std::numbers::pi);
  if (red && green) off_rad = either_way(kLitOverlapRad);
  if (red != green) {
    const double wide_rad = kLitWideRad - kLitOverlapRad;
    off_rad = (red ? 1.0 : -1.0) * (kLitOverlapRad + wide_rad * random_.uniform());
  }
  return {.x_mm = sighting.x_mm - away_mm * std::cos(way_rad),
          .y_mm = sighting.y_mm - away_mm * std::sin(way_rad),
          .heading_rad = way_rad - off_rad};
}

// A step from one guess, near or far, or a new one by what it saw, in place of another that is
// worse.
void BaseBelief::improve() {
  const auto known = static_cast<std::uint32_t>(std::min(seen_, kSightings));
  for (int i = 0; i < kTriesPerSighting; ++i) {
    const Sighting& sighting = sightings_[random_.below(known)];
    const bool fresh = i % 3 == 0 && sighting.light.any();
    const Guess& one = guesses_[random_.below(kGuesses)];
    const Guess& other = guesses_[random_.below(kGuesses)];
    const Guess& from = one.cost < other.cost ? one : other;
    Guess& worse = guesses_[random_.below(kGuesses)];
    const double scale = std::pow(0.5, random_.below(7));
    Guess tried{
        .place = {.x_mm = from.place.x_mm + either_way(scale * kBaseLitMm),
                  .y_mm = from.place.y_mm + either_way(scale * kBaseLitMm),
                  .heading_rad = from.place.heading_rad + either_way(scale * std::numbers::pi)}};
    if (fresh) tried.place = guess_from(sighting);
    tried.cost = cost(tried.place);
    if (tried.cost <= worse.cost) worse = tried;
  }
}

const BaseBelief::Guess& BaseBelief::best() const {
  return *std::min_element(guesses_.begin(), guesses_.end(),
                           [](const Guess& a, const Guess& b) { return a.cost < b.cost; });
}

BaseBelief::Place BaseBelief::any() {
  const Guess& best = this->best();
  constexpr int kGuessTries = 20;
  for (int i = 0; i < kGuessTries; ++i) {
    const Guess& guess = guesses_[random_.below(kGuesses)];
    if (guess.cost <= best.cost + kAgreesCost) return guess.place;
  }
  return best.place;
}

// The mean of the guesses that agree about as well as the best, if these are close to each other.
std::optional<BaseBelief::Place> BaseBelief::estimate() const {
  if (seen_ == 0) return std::nullopt;
  const Guess& best = this->best();
  const Place& middle = best.place;
  double count = 0.0;
  Place off{};
  double squared_mm2 = 0.0;
  double squared_rad2 = 0.0;
  for (const Guess& guess : guesses_) {
    if (guess.cost > best.cost + kAgreesCost) continue;
    const double x_mm = guess.place.x_mm - middle.x_mm;
    const double y_mm = guess.place.y_mm - middle.y_mm;
    const double turn_rad = wrapped_rad(guess.place.heading_rad - middle.heading_rad);
    count += 1.0;
    off.x_mm += x_mm;
    off.y_mm += y_mm;
    off.heading_rad += turn_rad;
    squared_mm2 += x_mm * x_mm + y_mm * y_mm;
    squared_rad2 += turn_rad * turn_rad;
  }
  if (count < kFewestAgree * kGuesses || squared_mm2 > count * kMostSpreadMm * kMostSpreadMm ||
      squared_rad2 > count * kMostSpreadRad * kMostSpreadRad) {
    return std::nullopt;
  }
  return Place{.x_mm = middle.x_mm + off.x_mm / count,
               .y_mm = middle.y_mm + off.y_mm / count,
               .heading_rad = middle.heading_rad + off.heading_rad / count};
}

}  // namespace cargobay::hal::sim
