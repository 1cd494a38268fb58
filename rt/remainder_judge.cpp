#include "rt/remainder_judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace cargobay::rt {
namespace {

constexpr int kLeastSingle = 6;
constexpr int kMostSingle = 15;
constexpr int kLeastWindow = 6;        // ticks: shorter ones lose nearly as much as a single tick
constexpr int kLeastCount = 2;         // steps in a window; below, both kinds read nothing
constexpr double kMostEvidence = 4.0;  // of one axis: no single event may decide
constexpr double kWorstMiss = 4.0;     // standard deviations: fits neither kind
constexpr double kWindowSd = 0.29;     // of a window whose remainder is lost
constexpr double kCutSd = 0.39;        // steps: a tick now and then is cut to the next step
constexpr double kWanderSd = 0.3;      // steps: the speed is never quite steady
constexpr double kBend = 0.4;          // steps a tick, for each that the windows differ by
constexpr double kUnsteady = 0.5;      // of the speed: a greater difference tells nothing
constexpr double kBothFit = 1.2;       // standard deviations
// A robot that carries the remainder at a whole number of steps a tick and a little more seems to
// lose it, as long as it is not seen to fall short by more than its ends explain.
constexpr double kSurelyShort = 2.2;  // standard deviations

struct Expectation {
  double mean;
  double sd;
};

// What one sum leaves over counts in the next, so that the sum between the windows is wrong by
// (1 + a) times the fraction at one end, less (1 + b) times that at the other, if the windows are
// weighed by a and b; and by a and b times those at the outer ends. Each is uniform within a step.
double carried_variance(double a, double b) CARGOBAY_NONBLOCKING {
  return ((1.0 + a) * (1.0 + a) + (1.0 + b) * (1.0 + b) + a * a + b * b) / 12.0;
}

double miss(const Expectation& expected, double seen) CARGOBAY_NONBLOCKING {
  return (seen - expected.mean) / expected.sd;
}

}  // namespace

void RemainderJudge::Sum::add(int more_ticks, const Counts& more) CARGOBAY_NONBLOCKING {
  ticks += more_ticks;
  counts.distance += more.distance;
  counts.turn += more.turn;
}

double RemainderJudge::read(int ticks, const Counts& counts, bool steady) CARGOBAY_NONBLOCKING {
  if (ticks == 1) {
    if (before_.ticks > 0) single_.add(ticks, counts);
    // So far behind the window, the robot may have stopped in between.
    if (single_.ticks > kMostSingle && !steady) doubt();
    return 0.0;
  }
  const Sum before = before_;
  const Sum single = single_;
  before_ = {.ticks = ticks, .counts = counts};
  single_ = {};
  if (single.ticks < kLeastSingle || std::min(before.ticks, ticks) < kLeastWindow) return 0.0;
  return judge(before, single, before_, &Counts::distance) +
         judge(before, single, before_, &Counts::turn);
}

double RemainderJudge::judge(const Sum& before, const Sum& single, const Sum& after,
                             int Counts::* axis) CARGOBAY_NONBLOCKING {
  const int former = before.counts.*axis;
  const int latter = after.counts.*axis;
  if (std::min(std::abs(former), std::abs(latter)) < kLeastCount) return 0.0;
  if ((former > 0) != (latter > 0)) return 0.0;
  const double sign = former > 0 ? 1.0 : -1.0;
  // The speed in the middle of the single ticks, in steps a tick, on a line between the windows.
  const double by_former = static_cast<double>(single.ticks + after.ticks) /
                           static_cast<double>(before.ticks + 2 * single.ticks + after.ticks) /
                           before.ticks;
  const double by_latter = static_cast<double>(single.ticks + before.ticks) /
                           static_cast<double>(before.ticks + 2 * single.ticks + after.ticks) /
                           after.ticks;
  const double rate = sign * (by_former * former + by_latter * latter);
  const double seen = sign * (single.counts.*axis);
  const double spread = std::sqrt(by_former * by_former + by_latter * by_latter);
  const double difference = std::abs(static_cast<double>(former) / before.ticks -
                                     static_cast<double>(latter) / after.ticks);
  if (difference > kUnsteady * rate) return 0.0;
  const double bend = kBend * difference;
  const double wander = kWanderSd * kWanderSd + std::pow(bend * single.ticks, 2);

  const Expectation carried{
      .mean = rate * single.ticks,
      .sd =
          std::sqrt(carried_variance(by_former * single.ticks, by_latter * single.ticks) + wander)};

  // A window that loses its remainder lacks half a step; each single tick is cut to whole steps.
  const double true_rate = rate + 0.5 * (by_former + by_latter);
  const double doubt = kWindowSd * spread + 0.02 + bend;
  double mean = 0.0;
  double square = 0.0;
  constexpr std::array kOffsets{-1.5, -0.75, 0.0, 0.75, 1.5};
  for (const double offset : kOffsets) {
    const double cut = std::floor(std::max(0.0, true_rate + offset * doubt)) * single.ticks;
    mean += cut / kOffsets.size();
    square += cut * cut / kOffsets.size();
  }
  const Expectation lost{.mean = mean,
                         .sd = std::sqrt(std::max(0.0, square - mean * mean) + kCutSd * kCutSd +
                                         std::pow(bend * single.ticks, 2))};

  const double as_carried = miss(carried, seen);
  const double as_lost = miss(lost, seen);
  if (std::min(std::abs(as_carried), std::abs(as_lost)) > kWorstMiss) return 0.0;
  // What both expected tells nothing; it would add up over a long steady drive.
  if (std::max(std::abs(as_carried), std::abs(as_lost)) < kBothFit) return 0.0;
  const double evidence =
      0.5 * (as_lost * as_lost - as_carried * as_carried) + std::log(lost.sd / carried.sd);
  if (evidence < 0.0 && std::abs(as_carried) < kSurelyShort) return 0.0;
  return std::clamp(evidence, -kMostEvidence, kMostEvidence);
}

}  // namespace cargobay::rt
