// What was recorded of a drive, and the figures that follow from it.
#pragma once

#include <optional>
#include <vector>

#include "hal/cycle/cycle_state.hpp"
#include "hal/sim/line/server.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::cli {

struct DriveSample {
  double time_s = 0.0;       // robot time since the first frame
  double interval_ms = 0.0;  // since the frame before arrived; a tick for the first
  rt::WheelSpeeds set{};
  rt::WheelSpeeds estimate{};
  rt::WheelSpeeds command{};
  std::optional<rt::WheelSpeeds> truth{};  // of the virtual Create of our own
};

// Joins the loop's states with the truth at the tick each frame came from.
std::vector<DriveSample> join(const std::vector<hal::CycleState>& states,
                              const std::vector<hal::sim::TruthSample>& truth);

struct WheelFigures {
  double mean_set_mm_s = 0.0;
  double mean_estimate_mm_s = 0.0;
  double mean_truth_mm_s = 0.0;
  double steady_error_mm_s = 0.0;   // true (or estimated) minus set, once the set speed rests for 1
                                    // s: the mean over each such stretch, and of those the rms
  double tracking_rmse_mm_s = 0.0;  // true (or estimated) minus set, all the time
  double estimate_rmse_mm_s = 0.0;  // estimated minus true, from 1 s on
};

struct DriveFigures {
  WheelFigures left{};
  WheelFigures right{};
  bool has_truth = false;
  bool has_steady = false;  // whether any set speed rested long enough
};

DriveFigures figures(const std::vector<DriveSample>& samples);

}  // namespace cargobay::cli
