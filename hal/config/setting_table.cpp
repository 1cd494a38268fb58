#include "hal/config/setting_table.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace cargobay::hal {
namespace {

constexpr std::string_view kTrueOfReported = "1 if what the robot reports is true";
constexpr std::string_view kPartNotPercent = "not per cent";

constexpr std::array kSettings{
    Setting{.table = "",
            .key = "port",
            .member = &Config::port,
            .meaning =
                "Serial port of the robot; `cargobay ports` lists those available. The links in "
                "/dev/serial/by-id stay the same however adapters are plugged in",
            .left_out = "the robot is a virtual Create",
            .example = "\"/dev/ttyAMA0\""},
    Setting{.table = "",
            .key = "baud",
            .member = &Config::baud,
            .meaning =
                "Baud rate, 300 to 115200. The robot is found at any of its rates, and brought "
                "to this one",
            .left_out = "57600",
            .example = "57600"},
    Setting{.table = "robot",
            .key = "wheel_base_mm",
            .member = &Config::wheel_base_mm,
            .range = kWheelBaseMm,
            .unit = "mm",
            .not_unit = "not metres",
            .mistakes = kNotMm,
            .meaning = "Distance between the wheels",
            .left_out = "258",
            .example = "258",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.loop.estimator.wheel_base_mm = *config.wheel_base_mm;
                  parameters.odometry.wheel_base_mm = *config.wheel_base_mm;
                }},
    Setting{.table = "robot",
            .key = "distance_scale",
            .member = &Config::distance_scale,
            .range = kScale,
            .not_unit = kTrueOfReported,
            .mistakes = kNotPart,
            .meaning = "True distance for each millimetre that the robot reports",
            .left_out = "1",
            .example = "1.0",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.odometry.distance_scale = *config.distance_scale;
                }},
    Setting{.table = "robot",
            .key = "turn_scale",
            .member = &Config::turn_scale,
            .range = kScale,
            .not_unit = kTrueOfReported,
            .mistakes = kNotPart,
            .meaning = "True turn for each degree that the robot reports",
            .left_out = "1",
            .example = "1.0",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.odometry.turn_scale = *config.turn_scale;
                }},
    Setting{.table = "robot",
            .key = "lag_s",
            .member = &Config::lag_s,
            .range = kLagS,
            .unit = "seconds",
            .not_unit = "not ms",
            .mistakes = kNotSeconds,
            .meaning =
                "Time a wheel takes to come within 37 % of a new speed, as far as is known; the "
                "loop finds out",
            .left_out = "0.1",
            .example = "0.1",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.loop.estimator.likely_lag_s = *config.lag_s;
                }},
    Setting{.table = "robot",
            .key = "acceleration_mm_s2",
            .member = &Config::acceleration_mm_s2,
            .range = kAccelerationMmS2,
            .unit = "mm/s^2",
            .not_unit = "not m/s^2",
            .mistakes = kNotMmS2,
            .meaning = "Maximum acceleration of a wheel",
            .left_out = "1000",
            .example = "1000",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.loop.limits.acceleration_mm_s2 = *config.acceleration_mm_s2;
                }},
    Setting{.table = "robot",
            .key = "jerk_mm_s3",
            .member = &Config::jerk_mm_s3,
            .range = kJerkMmS3,
            .unit = "mm/s^3",
            .not_unit = "not m/s^3",
            .mistakes = kNotMmS3,
            .meaning = "How fast the acceleration may grow",
            .left_out = "at once",
            .example = "10000",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.loop.limits.jerk_mm_s3 = *config.jerk_mm_s3;
                }},
    Setting{.table = "robot",
            .key = "remainder",
            .member = &Config::remainder,
            .meaning = "What reading distance and angle does to the fraction of a millimetre or "
                       "degree that it leaves: \"carried\" or \"lost\"",
            .left_out = "found out while the robot drives",
            .example = "\"carried\"",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.loop.estimator.remainder = config.remainder;
                }},
    Setting{.table = "robot",
            .key = "learnt",
            .member = &Config::learnt,
            .meaning = "File that keeps what a drive learns of the wheels, for the next one to "
                       "begin from; \"none\": neither kept nor used",
            .left_out = "one for each serial port, in the folder for state; none for a "
                        "pseudo-terminal",
            .example = "\"none\""},
    Setting{.table = "robot",
            .key = "hold_heading",
            .member = &Config::hold_heading,
            .meaning = "The heading follows what the wheels were asked for so far, also across "
                       "stops and other curves; otherwise only the present curve is kept",
            .left_out = "false",
            .example = "false",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.loop.course.hold_heading = config.hold_heading;
                }},
    Setting{.table = "robot",
            .key = "wheel_error",
            .member = &Config::wheel_error,
            .range = kErrorPart,
            .not_unit = kPartNotPercent,
            .mistakes = kNotPart,
            .meaning = "Part of its way that a wheel may be wrong by all the time, by slip, tyres "
                       "or missed counts: the covariance of the pose grows by it",
            .left_out = "0.02",
            .example = "0.02",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.odometry.wheel_error = *config.wheel_error;
                }},
    Setting{.table = "robot",
            .key = "wheel_base_error",
            .member = &Config::wheel_base_error,
            .range = kErrorPart,
            .not_unit = kPartNotPercent,
            .mistakes = kNotPart,
            .meaning = "Part by which the wheel base may be wrong: the covariance of the pose "
                       "grows by it",
            .left_out = "0.02",
            .example = "0.02",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.odometry.base_error = *config.wheel_base_error;
                }},
    Setting{.table = "robot",
            .key = "stop_if_implausible",
            .member = &Config::stop_if_implausible,
            .meaning =
                "Stop the robot and end the drive if a wheel is stuck, or distance and angle "
                "cannot be true; if false, only report it",
            .left_out = "true",
            .example = "true",
            .apply =
                [](const Config& config, CycleParameters& parameters) {
                  parameters.on_implausible =
                      config.stop_if_implausible ? OnImplausible::end : OnImplausible::report;
                }},
    Setting{.table = "realtime",
            .key = "priority",
            .member = &Config::priority,
            .range = kPriority,
            .meaning = "SCHED_FIFO priority of the loop",
            .left_out = "80. Its guard has 10 more, at most 98",
            .example = "80"},
    Setting{.table = "realtime",
            .key = "cpu",
            .member = &Config::cpu,
            .range = kCpu,
            .meaning = "The loop runs on this CPU only",
            .left_out = "on any",
            .example = "3"},
    Setting{.table = "realtime",
            .key = "require",
            .member = &Config::require_realtime,
            .meaning = "Do not drive without SCHED_FIFO and locked memory",
            .left_out = "false",
            .example = "false"},
};

}  // namespace

std::span<const Setting> settings() { return kSettings; }

const Setting& setting_named(std::string_view key) {
  const auto* const found = std::ranges::find(kSettings, key, &Setting::key);
  assert(found != kSettings.end());
  return *found;
}

}  // namespace cargobay::hal
