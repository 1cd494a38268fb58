// Whether the counters can be true, and the wheels can turn.
//
// For each wheel the watch knows between which bounds a healthy wheel with a gain of 1 has gone for
// the commands that were sent: the quickest and the slowest plant of the family, and the one that
// was learnt (rt/plant_bank.hpp), each with commands that may act in coarse steps. What was counted
// lies between bounds too, for a reading is an interval. A finding holds for every pair of values
// within those bounds, so a robot that is weak, loaded, slow or slips is not accused;
// docs/control.md has the bounds and what they cannot tell.
//
// Steps by the robot's tick. One thread; no allocation; nothing blocks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "rt/axes.hpp"
#include "rt/nonblocking.hpp"
#include "rt/plant_bank.hpp"
#include "rt/remainder.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

class WheelWatch {
 public:
  enum class Finding : std::uint8_t {
    nothing,
    still,     // it is driven, but does not count: a dead counter, or a wheel that is stuck
    reversed,  // it counts against the direction in which it is driven
    few,       // it counts much less than it must: beside the other wheel, or by itself
    jumps,     // the counters said again and again what no robot can drive
  };
  struct Wheels {
    bool left = false;
    bool right = false;
  };
  struct Evidence {
    Finding what = Finding::nothing;
    Wheels wheels{};  // that it concerns; both for `jumps`
    // Means of the time that led to it, in the direction that is driven; 0 for `jumps`. What a
    // wheel with a gain of 1 would have done, and what was counted.
    WheelSpeeds driven{};
    WheelSpeeds counted{};
  };
  struct Parameters {
    double wheel_base_mm = 258.0;   // above 0
    double tick_s = 0.015;          // above 0
    double input_delay_s = 0.0025;  // from the tick to the arrival of the command it caused
  };
  // What a frame said of the counters that it reads, and over how many ticks.
  struct Reading {
    std::optional<int> distance_mm{};
    std::optional<int> angle_deg{};
    int distance_ticks = 1;
    int turn_ticks = 1;
    constexpr Axes axes() const CARGOBAY_NONBLOCKING {
      return {.distance = distance_mm.has_value(), .turn = angle_deg.has_value()};
    }
  };

  explicit WheelWatch(const Parameters& parameters);

  // One tick of the robot, in which `command` was sent in answer to the frame before. `plant`: what
  // is known of the wheels by now.
  void step(const WheelSpeeds& command, const PlantEstimate& plant) CARGOBAY_NONBLOCKING;
  // Counters may be read apart: each is summed until both are read in one frame.
  void read(const Reading& reading, RemainderBelief remainder) CARGOBAY_NONBLOCKING;
  // These were read, but what they said is not known.
  void read_unseen(const Axes& axes) CARGOBAY_NONBLOCKING;
  // They were read, with all frames there, and said what no robot can drive. Readings of that kind
  // without another between are one jump that goes on: less than three jumps.
  void read_impossible(const Axes& axes) CARGOBAY_NONBLOCKING;

  // The first finding; it stays.
  const Evidence& evidence() const CARGOBAY_NONBLOCKING { return evidence_; }
  // Whether the last reading fell short of what it must be: then the next one should be a window,
  // and come soon.
  bool suspects() const CARGOBAY_NONBLOCKING { return wheels_[0].suspect || wheels_[1].suspect; }

 private:
  static constexpr std::size_t kHistory = 8;  // ticks of commands
  static constexpr std::size_t kPlants = 3;
  struct Plant {
    double delay_ticks = 0.0;
    double most_mm_s = 0.0;  // change of the drive in a tick
    double decay = 0.0;      // of the speed in a tick
    double lag_s = 0.0;
  };
  // A wheel with a gain of 1.
  struct Model {
    double ramped_mm_s = 0.0;
    double speed_mm_s = 0.0;
    double way_mm = 0.0;  // since both counters were read
  };
  // A counter since both were read.
  struct Counter {
    double steps = 0.0;
    double doubt = 0.0;  // steps, on either side
    bool known = true;   // all that was read of it
    void add(int count, int ticks, RemainderBelief remainder, double least_doubt)
        CARGOBAY_NONBLOCKING;
  };
  // Of a wheel, in the direction in which it is driven; older ones fade.
  struct Sums {
    double counted_mm = 0.0;
    double doubt_mm = 0.0;  // of that, on either side
    // How far a wheel with a gain of 1 has gone: at least, at most, as far as the plant is known,
    // and with the slowest plant.
    double least_mm = 0.0;
    double most_mm = 0.0;
    double likely_mm = 0.0;
    double slow_mm = 0.0;
    // By how much the likely way may be wrong, on either side: coarse steps, and another plant.
    double step_mm = 0.0;
    double unlike_mm = 0.0;
    double seconds = 0.0;
    void fade(double keep) CARGOBAY_NONBLOCKING;
    void add(const Sums& more, double fades_s) CARGOBAY_NONBLOCKING;
    double most_counted_mm(double ends_mm) const CARGOBAY_NONBLOCKING;
  };
  struct Wheel {
    std::array<Model, kPlants> models{};
    double step_mm = 0.0;       // since both counters were read, as in Sums
    bool turns_around = false;  // the same
    bool suspect = false;       // the last reading lacks more than it should
    int lacking = 0;            // windows in a row with next to nothing of what they must have
    Sums brief{};
    Sums lasting{};
  };
  struct Counted;

  double command_of(std::size_t which, double delay_ticks) const CARGOBAY_NONBLOCKING;
  void advance(Wheel& wheel, std::size_t which) CARGOBAY_NONBLOCKING;
  Sums since_reading(const Wheel& wheel, const Counted& counted, int ticks) const
      CARGOBAY_NONBLOCKING;
  void take(Wheel& wheel, const Counted& counted, int ticks) CARGOBAY_NONBLOCKING;
  bool turns_back(const Wheel& wheel) const CARGOBAY_NONBLOCKING;
  bool still(const Wheel& wheel, const Wheel& other) const CARGOBAY_NONBLOCKING;
  bool still_beside(const Sums& wheel, const Sums& other) const CARGOBAY_NONBLOCKING;
  bool both_still() const CARGOBAY_NONBLOCKING;
  bool fewer(const Wheel& one, const Wheel& another) const CARGOBAY_NONBLOCKING;
  void begin() CARGOBAY_NONBLOCKING;
  void compare() CARGOBAY_NONBLOCKING;
  void judge() CARGOBAY_NONBLOCKING;
  void find(Finding what, Wheels wheels, Sums Wheel::* sums) CARGOBAY_NONBLOCKING;

  Parameters parameters_;
  std::array<Plant, kPlants> plants_{};
  std::array<Wheel, 2> wheels_{};
  Counter distance_{};
  Counter turn_{};
  int ticks_ = 0;      // since both were read
  double ends_ = 1.0;  // 0: readings leave nothing for the next one
  std::array<std::array<double, 2>, kHistory> commands_{};
  std::size_t now_ = 0;  // the newest of them
  double jumps_ = 0.0;   // fading
  bool jumped_ = false;  // the last reading was one
  Evidence evidence_{};
};

}  // namespace cargobay::rt
