#include "hal/sim/world/path_recorder.hpp"

#include <algorithm>
#include <cmath>

namespace cargobay::hal::sim {

namespace {

// At full speed a robot drives 8 mm a tick, and an obstacle moves it no further than that.
constexpr double kLeapMm = 50.0;

double distance_mm(const WorldPose& a, const WorldPose& b) {
  return std::hypot(a.x_mm - b.x_mm, a.y_mm - b.y_mm);
}

}  // namespace

PathRecorder::PathRecorder(std::size_t most) : most_{std::max<std::size_t>(most, 4)} {
  kept_.reserve(most_);
}

void PathRecorder::add(const WorldPose& pose, bool bumper_pushed) {
  const bool first = kept_.empty();
  const bool leapt = !first && distance_mm(last_.pose, pose) > kLeapMm;
  // The place it leapt from is worth keeping too.
  if (leapt) {
    if (kept_.size() == most_) thin_out();
    kept_.push_back(last_);
  }
  last_ = {.pose = pose, .placed = leapt, .bumped = bumper_pushed && !pushed_};
  pushed_ = bumper_pushed;
  const bool far = first || distance_mm(kept_.back().pose, pose) >= spacing_mm_;
  if (!far && !leapt && !last_.bumped) return;
  if (kept_.size() == most_) thin_out();
  kept_.push_back(last_);
}

// Drops every second waypoint, except the first and the last; the next one takes over what it had
// to report.
void PathRecorder::thin_out() {
  std::size_t count = 0;
  Waypoint gone{};
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    Waypoint waypoint = kept_[i];
    waypoint.placed = waypoint.placed || gone.placed;
    waypoint.bumped = waypoint.bumped || gone.bumped;
    const bool goes = i % 2 == 1 && i + 1 < kept_.size();
    gone = goes ? waypoint : Waypoint{};
    if (!goes) kept_[count++] = waypoint;
  }
  kept_.resize(count);
  spacing_mm_ *= 2.0;
}

std::vector<Waypoint> PathRecorder::path() const {
  std::vector<Waypoint> path = kept_;
  if (!path.empty() && distance_mm(path.back().pose, last_.pose) > 0.0) {
    path.push_back({.pose = last_.pose});
  } else if (!path.empty()) {
    path.back().pose = last_.pose;  // it turned in place
  }
  return path;
}

}  // namespace cargobay::hal::sim
