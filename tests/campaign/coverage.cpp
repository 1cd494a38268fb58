// coverage [--runs N] [--slices N] [--outside]: how often the intervals of `cargobay jitter` hold
// what they should, on synthetic latencies that depend on each other as those of a machine do.
// Prints the table of docs/statistics.md. Exits with 1 if an interval of 95 % holds in fewer than
// 93 or more than 97 % of the runs, or is missing in a tenth of those of 60 slices and more: so it
// does with --outside, and for a few ratios with 30 and 200 slices.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "hal/jitter/estimate.hpp"
#include "tests/campaign/number.hpp"

namespace {

using cargobay::hal::jitter::Estimate;
using cargobay::hal::jitter::Sample;
using cargobay::hal::jitter::Slice;

constexpr std::uint64_t kPeriodNs = 1'000'000;
constexpr double kTypicalNs = 20'000.0;

// splitmix64 and the polar method: the standard's normal distribution differs between libraries.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_{seed} {}
  double uniform() {
    state_ += 0x9e3779b97f4a7c15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27U)) * 0x94d049bb133111ebU;
    return static_cast<double>((z ^ (z >> 31U)) >> 11U) * 0x1p-53;
  }
  double normal() {
    if (spare_) {
      const double kept = *spare_;
      spare_.reset();
      return kept;
    }
    for (;;) {
      const double x = 2.0 * uniform() - 1.0;
      const double y = 2.0 * uniform() - 1.0;
      const double square = x * x + y * y;
      if (square >= 1.0 || square == 0.0) continue;
      const double scale = std::sqrt(-2.0 * std::log(square) / square);
      spare_ = y * scale;
      return x * scale;
    }
  }

 private:
  std::uint64_t state_;
  std::optional<double> spare_{};
};

// Log-normal around a mood that drifts (first-order autoregression), and what comes on top.
struct Model {
  const char* name;
  double noise;  // standard deviations of the logarithm
  double mood;
  double mood_frames;          // within which the mood forgets itself
  double burst_rate = 0.0;     // bursts of threefold latency a frame
  double spike_share = 0.0;    // of frames, multiplied by a Pareto variable of exponent 1.5
  double stall_rate = 0.0;     // stalls a frame, two periods long on average
  double burst_frames = 20.0;  // on average
};

constexpr std::array<Model, 7> kModels{{
    {"independent", 0.3, 0.0, 1.0},
    {"moods of 0.2 s", 0.2, 0.1, 200.0},
    {"moods of 1 s", 0.2, 0.1, 1000.0},
    {"bursts of 20 frames", 0.2, 0.05, 500.0, 0.002},
    {"spikes, heavy-tailed", 0.2, 0.1, 300.0, 0.0, 0.01},
    {"stalls over periods", 0.2, 0.1, 300.0, 0.0, 0.0, 0.001},
    {"all of these", 0.2, 0.1, 500.0, 0.001, 0.005, 0.0005},
}};

// What no interval can know: changes slower than the run, and bursts of which a run has few.
constexpr std::array<Model, 3> kOutside{{
    {"moods of 5 s", 0.2, 0.1, 5000.0},
    {"moods of 30 s", 0.2, 0.1, 30'000.0},
    {"a burst of 200 frames in 20 s", 0.2, 0.05, 500.0, 0.00005, 0.0, 0.0, 200.0},
}};

class Machine {
 public:
  Machine(const Model& model, std::uint64_t seed)
      : model_{model},
        random_{seed * 1'000'003},
        keep_{std::exp(-1.0 / model.mood_frames)},
        mood_{model_.mood * random_.normal()},
        burst_{random_.uniform() < burst_share()} {}
  float next() {
    if (model_.mood > 0.0) drift(keep_);
    const double change = burst_ ? 1.0 / model_.burst_frames : model_.burst_rate;
    if (change > 0.0 && random_.uniform() < change) burst_ = !burst_;
    if (model_.stall_rate > 0.0 && random_.uniform() < model_.stall_rate)
      return static_cast<float>(-2.0 * static_cast<double>(kPeriodNs) *
                                std::log(1.0 - random_.uniform()));
    double value = kTypicalNs * std::exp(mood_ + model_.noise * random_.normal());
    if (burst_) value *= 3.0;
    if (model_.spike_share > 0.0 && random_.uniform() < model_.spike_share)
      value *= std::pow(1.0 - random_.uniform(), -1.0 / 1.5);
    return static_cast<float>(std::floor(value));
  }
  // While other channels are measured.
  void pass(double frames) {
    drift(std::pow(keep_, frames));
    const double forgotten =
        1.0 - std::pow(1.0 - model_.burst_rate - 1.0 / model_.burst_frames, frames);
    if (random_.uniform() < forgotten) burst_ = random_.uniform() < burst_share();
  }
  Slice slice(std::size_t frames) {
    Slice slice;
    slice.headline_ns.reserve(frames);
    for (std::size_t i = 0; i < frames; ++i) slice.headline_ns.push_back(next());
    return slice;
  }

 private:
  double burst_share() const {
    return model_.burst_rate / (model_.burst_rate + 1.0 / model_.burst_frames);
  }
  void drift(double keep) {
    mood_ = keep * mood_ + model_.mood * std::sqrt(1.0 - keep * keep) * random_.normal();
  }

  const Model& model_;
  Random random_;
  double keep_;
  double mood_ = 0.0;
  bool burst_ = false;
};

constexpr std::size_t kFrames = 500;
constexpr std::size_t kPlentyOfSlices = 60;  // for intervals of every percentile
constexpr double kWarmUp = 50.0;
constexpr double kOtherChannels = 4.0;  // of six: another is measured here as well
constexpr std::array<double, 2> kPercents{50.0, 99.0};

// Two channels of one run, in turns.
struct Run {
  std::vector<Slice> first{};
  std::vector<Slice> second{};
};
Run run(const Model& model, std::size_t slices, std::uint64_t seed) {
  Machine machine{model, seed};
  Run run;
  for (std::size_t i = 0; i < slices; ++i) {
    run.first.push_back(machine.slice(kFrames));
    machine.pass(kWarmUp);
    run.second.push_back(machine.slice(kFrames));
    machine.pass(kOtherChannels * (static_cast<double>(kFrames) + kWarmUp) + kWarmUp);
  }
  return run;
}

std::array<double, 2> truth(const Model& model) {
  Machine machine{model, 999'983};
  std::vector<Slice> all;
  for (int i = 0; i < 60'000; ++i) {
    all.push_back(machine.slice(100));
    machine.pass(3000.0);
  }
  Sample sample{all, kPeriodNs};
  return {sample.percentile(kPercents[0]), sample.percentile(kPercents[1])};
}

struct Tally {
  int shown = 0;
  int held = 0;
  void take(const Estimate& estimate, double wanted) {
    if (!estimate.interval) return;
    ++shown;
    if (estimate.interval->low <= wanted && wanted <= estimate.interval->high) ++held;
  }
  double share() const { return shown == 0 ? 0.0 : 100.0 * held / shown; }
};

struct Tallies {
  std::array<Tally, 2> one{};    // a percentile of one run
  std::array<Tally, 2> pair{};   // the ratio of two runs of the same
  std::array<Tally, 2> turns{};  // the ratio of two channels of one run
};

Tallies measure(const Model& model, std::size_t slices, int runs) {
  const std::array<double, 2> wanted = truth(model);
  Tallies tallies;
  std::array<Estimate, 2> before{};
  for (int i = 0; i < runs; ++i) {
    const Run made = run(model, slices, static_cast<std::uint64_t>(i) + 1);
    Sample first{made.first, kPeriodNs};
    Sample second{made.second, kPeriodNs};
    for (std::size_t p = 0; p < kPercents.size(); ++p) {
      const Estimate a = first.estimate(kPercents[p]);
      const Estimate b = second.estimate(kPercents[p]);
      tallies.one[p].take(a, wanted[p]);
      tallies.turns[p].take(ratio(a, b, correlation(a, b)), 1.0);
      if (i > 0) tallies.pair[p].take(ratio(a, before[p]), 1.0);
      before[p] = a;
    }
  }
  return tallies;
}

// Prints "95.1" or, if not all runs had an interval, "95.1 (of 87)", or "none". Whether it is good,
// and is there, where `all` should have one.
bool print(const Tally& tally, int runs, bool all) {
  if (tally.shown * 100 < runs) {
    std::printf(" none |");
    return !all;
  }
  std::printf(" %.1f", tally.share());
  if (tally.shown < runs) std::printf(" (of %d)", tally.shown);
  std::printf(" |");
  const bool enough = !all || tally.shown * 10 >= runs * 9;
  return enough && tally.share() >= 93.0 && tally.share() <= 97.0;
}

bool print(const Model& model, std::size_t slices, int runs) {
  const Tallies tallies = measure(model, slices, runs);
  bool good = true;
  std::printf("| %s | %zu |", model.name, slices);
  for (const auto* columns : {&tallies.one, &tallies.pair, &tallies.turns}) {
    for (const Tally& tally : *columns) {
      const int possible = columns == &tallies.pair ? runs - 1 : runs;
      good = print(tally, possible, slices >= kPlentyOfSlices) && good;
    }
  }
  std::printf("\n");
  std::fflush(stdout);
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t runs = 1000;
  std::uint64_t only_slices = 0;
  std::span<const Model> models{kModels};
  for (int i = 1; i < argc; ++i) {
    const std::string_view option{argv[i]};
    if (option == "--outside") {
      models = kOutside;
      continue;
    }
    constexpr std::uint64_t kMost = 1'000'000;
    const char* const text = i + 1 < argc ? argv[i + 1] : "";
    const std::uint64_t value = cargobay::campaign::number(text).value_or(kMost + 1);
    std::uint64_t* const wanted = option == "--runs"     ? &runs
                                  : option == "--slices" ? &only_slices
                                                         : nullptr;
    if (wanted == nullptr || value > kMost) {
      std::fprintf(stderr, "usage: coverage [--runs N] [--slices N] [--outside]\n");
      return 2;
    }
    *wanted = value;
    ++i;
  }
  std::printf(
      "| latencies | slices | p50 | p99 | p50, two runs | p99, two runs | p50, in turns | "
      "p99, in turns |\n|---|---|---|---|---|---|---|---|\n");
  bool good = true;
  for (const Model& model : models) {
    for (const std::size_t slices : {30U, 60U, 200U}) {
      if (only_slices != 0 && slices != only_slices) continue;
      good = print(model, slices, static_cast<int>(runs)) && good;
    }
  }
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
