// Messages for Foxglove's panels that only the server makes: the virtual world, and words.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "hal/feed/message/reading.hpp"
#include "rt/odometry.hpp"

namespace cargobay::web {

struct Pose {
  double x_m = 0.0;
  double y_m = 0.0;
  double heading_rad = 0.0;
};
Pose in_metres(const rt::OdometryPose& pose);
rt::OdometryPose in_millimetres(const Pose& pose);

// A pose seen from another frame, which is `frame` in the frame of `pose`.
Pose seen_from(const Pose& frame, const Pose& pose);
// The pose that is `relative` in the frame `frame`.
Pose placed_in(const Pose& frame, const Pose& relative);

// foxglove.SceneUpdate: solids of the world in the frame of the odometry, in which the origin of
// the world is `origin`.
std::string scene_update(std::int64_t unix_ns, const hal::heard::World& world, const Pose& origin);

// foxglove.Log, level info, or warning if `is_warning`.
std::string log_message(std::int64_t unix_ns, std::string_view name, std::string_view text,
                        bool is_warning);

}  // namespace cargobay::web
