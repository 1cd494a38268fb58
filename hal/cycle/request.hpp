// What other threads ask of the control cycle, besides wheel speeds: it waits in a ring, and the
// cycle does it in one of its next frames.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/sensing/frame_lists.hpp"
#include "oi/limits.hpp"
#include "rt/odometry.hpp"
#include "rt/ring.hpp"

namespace cargobay::hal {

struct Request {
  enum class Kind : std::uint8_t {
    command,  // `bytes`: one whole command that leaves the loop alone
    stream,   // `extras`: these from now on, no others
    look,     // `extras`: one frame of each
    pose,     // `pose`: where the odometry continues from
  };
  // A script is the longest command.
  static constexpr std::size_t kMostBytes = 2 + oi::kMaxScriptBytes;

  Kind kind = Kind::command;
  // What to do with a command too long to go out besides the loop's own while the wheels turn.
  enum class WhenLong : std::uint8_t {
    wait,   // until they stand
    pause,  // the loop's commands are left out meanwhile: the wheels keep turning as they are
  };
  WhenLong when_long = WhenLong::wait;
  ExtraLists extras{};
  std::uint8_t size = 0;
  std::array<std::uint8_t, kMostBytes> bytes{};
  rt::OdometryPose pose{};

  std::span<const std::uint8_t> command() const { return std::span{bytes}.first(size); }
};

// From where the odometry can go on: at these distances a millimetre and a millirad still count.
// False for what is not a number.
inline bool is_possible(const rt::OdometryPose& pose) {
  constexpr double kFarthestMm = 1e9;
  constexpr double kMostRad = 1e6;
  return std::abs(pose.x_mm) <= kFarthestMm && std::abs(pose.y_mm) <= kFarthestMm &&
         std::abs(pose.heading_rad) <= kMostRad;
}
inline constexpr const char* kPossiblePoses =
    "`x_mm` and `y_mm` must be -1e9 to 1e9, `heading_rad` -1e6 to 1e6";

inline constexpr std::size_t kMostRequests = 32;
using RequestRing = rt::SpscRing<Request, kMostRequests>;

}  // namespace cargobay::hal
