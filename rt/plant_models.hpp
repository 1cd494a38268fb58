// Wheels as each plant of a grid would turn them: one model for each lag, dead time and ramp, with
// a gain of 1. A first-order lag behind a ramp behind a dead time (docs/control.md).
//
// The drive (command after dead time and ramp) does not depend on the lag, so there are few of
// them; and the models of one drive lie side by side, to be taken four at a time.
//
// One thread; no allocation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "rt/lanes.hpp"
#include "rt/nonblocking.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::rt {

// What the robot counts.
enum class Axis : std::uint8_t { distance, turn };

class PlantModels {
 public:
  static constexpr std::size_t kLags = 8;
  static constexpr std::size_t kRamps = 4;
  static constexpr std::size_t kDeadTimes = 3;
  static constexpr std::size_t kDrives = kRamps * kDeadTimes;
  static constexpr std::size_t kCount = kDrives * kLags;
  static constexpr std::size_t kParts = kLags / kLanes;  // of the lags, each of four
  using Lags = std::array<Lanes, kParts>;
  using Models = std::array<Lags, kDrives>;
  using Drives = std::array<Lanes, kDeadTimes>;  // one part a dead time, of all ramps
  static_assert(kRamps == kLanes && kLags % kLanes == 0);

  // One model of them, by number: those of one drive in a row.
  static float of(const Models& models, std::size_t model) CARGOBAY_NONBLOCKING {
    return models[model / kLags][model % kLags / kLanes][model % kLanes];
  }
  static void set(Models& models, std::size_t model, double value) CARGOBAY_NONBLOCKING {
    models[model / kLags][model % kLags / kLanes][model % kLanes] = static_cast<float>(value);
  }

  static float sum(const Lags& lags) CARGOBAY_NONBLOCKING {
    Lanes all{};
    for (const Lanes& part : lags) all += part;
    return rt::sum(all);
  }

  // Ways are remembered twice: since the axis was last read, and for longer, fading.
  enum class Memory : std::uint8_t { last_reading, longer };

  struct Grid {
    std::array<double, kLags> lag_s{};  // above 0
    std::array<double, kDeadTimes> dead_time_s{};
    std::array<double, kRamps> ramp_s2_mm{};  // 1 / ramp; 0: none
    double tick_s = 0.015;
    double input_delay_s = 0.0025;  // from the tick to the arrival of the command it caused

    double lag_of(std::size_t model) const CARGOBAY_NONBLOCKING { return lag_s[model % kLags]; }
    double dead_time_of(std::size_t model) const CARGOBAY_NONBLOCKING {
      return dead_time_s[model / kLags / kRamps];
    }
    double ramp_of(std::size_t model) const CARGOBAY_NONBLOCKING {
      return ramp_s2_mm[model / kLags % kRamps];
    }
  };

  explicit PlantModels(const Grid& grid);

  // Standing, all that was commanded forgotten.
  void reset() CARGOBAY_NONBLOCKING;

  // One tick of the robot, in which `command` was sent in answer to the frame before.
  void step(const WheelSpeeds& command) CARGOBAY_NONBLOCKING;

  // From now on the wheels answer by other gains, and what they do already fades: they roll at
  // `speeds`. No axis remembers a way.
  void begin_again(const WheelSpeeds& speeds) CARGOBAY_NONBLOCKING;

  // Of what the axis remembers, only this part is kept.
  void remember(Axis axis, Memory memory, float part) CARGOBAY_NONBLOCKING;
  // Where in Wheel::way_at an axis has its memory.
  static constexpr std::size_t at(Axis axis, Memory memory) {
    return 2 * static_cast<std::size_t>(memory) + static_cast<std::size_t>(axis);
  }

  // Of a wheel, 0 is the left one.
  struct Wheel {
    Drives ramped{};                 // mm/s
    Drives input{};                  // mm/s, what the lag follows: mean of the last tick
    Models speed{};                  // mm/s
    Models way{};                    // mm, since any time
    std::array<Models, 4> way_at{};  // mm: where what is remembered begins
    // What began before begin_again(), at its true speed.
    Lags rolls{};   // mm/s
    Lags rolled{};  // mm
    std::array<Lags, 4> rolled_at{};
  };
  const Wheel& wheel(std::size_t which) const CARGOBAY_NONBLOCKING { return wheels_[which]; }

  // The newest command, and the former one.
  const std::array<float, 2>& command() const CARGOBAY_NONBLOCKING { return commands_[now_]; }
  const std::array<float, 2>& former_command() const CARGOBAY_NONBLOCKING {
    return commands_[(now_ + kHistory - 1) % kHistory];
  }

 private:
  static constexpr std::size_t kHistory = 8;  // ticks of commands
  void drive(Wheel& wheel, std::size_t which) CARGOBAY_NONBLOCKING;
  Lanes ramp(const Lanes& wanted_mm_s, float part) const CARGOBAY_NONBLOCKING;
  void follow(Wheel& wheel) const CARGOBAY_NONBLOCKING;
  void roll(Wheel& wheel) const CARGOBAY_NONBLOCKING;
  static void keep_small(Wheel& wheel) CARGOBAY_NONBLOCKING;

  float tick_s_;
  Lags decay_{};                                       // of the speed in a tick
  Lags way_by_speed_s_{};                              // mm for each mm/s at the begin of a tick
  std::array<std::size_t, kDeadTimes> whole_ticks_{};  // of delay, and ...
  std::array<float, kDeadTimes> part_tick_{};          // ... the rest
  Lanes most_mm_s_{};  // by which the ramp lets the drive change in a tick
  Lanes reached_{};    // of such a change, in the mean of its time
  std::array<Wheel, 2> wheels_{};
  std::array<std::array<float, 2>, kHistory> commands_{};
  std::size_t now_ = 0;  // the newest of them
  bool rolls_ = false;
};

}  // namespace cargobay::rt
