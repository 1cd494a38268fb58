// The kinds of wheels and their values.
#include <array>

#include "hal/sim/drive_train/plants.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr Unit kSeconds{.words = "in seconds", .mistakes = kNotSeconds};
constexpr Unit kMmPerSec{.words = "in mm/s", .mistakes = kNotMmS};
constexpr Unit kMmPerSec2{.words = "in mm/s^2", .mistakes = kNotMmS2};
constexpr Unit kPart{.words = "a part of 1", .mistakes = kNotPart};
constexpr Range kSpeedMmS{0.0, 500.0};
constexpr Range kFraction{0.0, 1.0};

using W = WheelParameters;

constexpr std::array kValues{
    PlantValue{
        "response", &W::response,
        "first-order: a lag; counting: a motor and a controller inside the robot that counts "
        "encoder steps"},
    PlantValue{"lag", &W::lag_s, "Seconds a wheel takes to come within 37 % of a new speed", kLagS,
               kSeconds},
    PlantValue{"dead-time", &W::dead_time_s, "Seconds until a command begins to act",
               Range{0.0, 0.5}, kSeconds},
    PlantValue{"ramp", &W::ramp_mm_s2,
               "Acceleration in mm/s^2 by which the robot approaches a command; 0: at once",
               Range{10.0, 100'000.0}, kMmPerSec2, true},
    PlantValue{"gain-left", &W::gain_left, "Part of its command that the left wheel reaches", kGain,
               kPart},
    PlantValue{"gain-right", &W::gain_right, "The same for the right wheel", kGain, kPart},
    PlantValue{"dead-band", &W::dead_band_mm_s,
               "Set speeds below this, in mm/s, do not turn a wheel", kSpeedMmS, kMmPerSec},
    PlantValue{"step", &W::step_mm_s,
               "Set speeds act in steps of this many mm/s, from the dead band on; 0: in none",
               Range{0.1, 250.0}, kMmPerSec, true},
    PlantValue{"stiction", &W::stiction_mm_s,
               "Set speeds below this, in mm/s, do not turn a wheel that stands", kSpeedMmS,
               kMmPerSec},
    PlantValue{"slip-left", &W::slip_left,
               "Part of its turning by which the left wheel does not move over the floor",
               kFraction, kPart},
    PlantValue{"slip-right", &W::slip_right, "The same for the right wheel", kFraction, kPart},
    PlantValue{"missed-left", &W::missed_left,
               "Part of its steps that the left encoder misses; 1: it is dead", kFraction, kPart},
    PlantValue{"missed-right", &W::missed_right, "The same for the right encoder", kFraction,
               kPart},
    PlantValue{"sign", &W::sign,
               "Sign of the counts: commanded, as encoders with one channel have it, or true"},
    PlantValue{"noise", &W::noise_mm_s,
               "Standard deviation in mm/s by which a wheel's speed wanders", kNoiseMmS, kMmPerSec},
    PlantValue{"counts-per-mm", &W::counts_per_mm, "Resolution of the encoders",
               Range{0.01, 1000.0}, Unit{.words = "per mm"}},
    PlantValue{"wheel-base", &W::wheel_base_mm, "Distance between its wheels, in mm", kWheelBaseMm,
               Unit{.words = "in mm", .mistakes = kNotMm}},
    PlantValue{"inner-period", &W::inner_period_s,
               "Seconds between the ticks of the controller that counts", Range{0.001, 0.1},
               kSeconds},
    PlantValue{"inner-p", &W::inner_p, "Its proportional gain", Range{0.0, 10.0},
               Unit{.words = "in mm/s per mm/s"}},
    PlantValue{"inner-i", &W::inner_i_per_s, "Its integral gain, in 1/s", Range{0.0, 200.0},
               Unit{.words = "in 1/s"}},
};

constexpr std::array kPlants{
    Plant{"default", "as owners describe theirs, with a lag that is assumed", {}},
    Plant{"ideal",
          "does at once and exactly what it is told",
          {.lag_s = 0.001,
           .gain_left = 1.0,
           .gain_right = 1.0,
           .dead_band_mm_s = 0.0,
           .sign = CounterSign::true_one,
           .noise_mm_s = 0.0}},
    Plant{"quick", "a third of the lag", {.lag_s = 0.030}},
    Plant{"slow", "two and a half times the lag", {.lag_s = 0.250}},
    Plant{"heavy", "five times the lag, as with a heavy load", {.lag_s = 0.500}},
    Plant{"dead-time", "a command begins to act after 60 ms", {.dead_time_s = 0.060}},
    Plant{"ramp", "the robot ramps each command by itself: soft starts", {.ramp_mm_s2 = 300.0}},
    Plant{"coarse",
          "11, 40, 68, 97 mm/s and nothing between: one encoder step per 15 ms, as an owner of a "
          "later model measured",
          {.dead_band_mm_s = 11.0, .step_mm_s = 28.5}},
    Plant{"fine-steps", "the same with the finer encoder of a Create", {.step_mm_s = 8.5}},
    Plant{"weak", "an empty battery or worn motors", {.gain_left = 0.60, .gain_right = 0.65}},
    Plant{"strong", "faster than it is told", {.gain_left = 1.15, .gain_right = 1.15}},
    Plant{"carpet",
          "on deep carpet: starts that take a second, and wheels that slip",
          {.lag_s = 0.150,
           .ramp_mm_s2 = 250.0,
           .gain_left = 0.80,
           .gain_right = 0.76,
           .stiction_mm_s = 35.0,
           .slip_left = 0.03,
           .slip_right = 0.03}},
    Plant{"sticky", "gears that stick: it does not start slowly", {.stiction_mm_s = 40.0}},
    Plant{"counting",
          "of second order: a motor with a lag, and a controller in the robot that counts encoder "
          "steps every 15 ms",
          {.response = Response::counting, .lag_s = 0.150, .gain_left = 1.0, .gain_right = 1.0}},
    Plant{"quadrature", "encoders that see the direction", {.sign = CounterSign::true_one}},
};

}  // namespace

std::span<const PlantValue> plant_values() { return kValues; }

std::span<const Plant> plants() { return kPlants; }

}  // namespace cargobay::hal::sim
