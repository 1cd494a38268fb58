// The record of a drive, and the figures that follow from it.
#pragma once

#include <optional>
#include <vector>

#include "hal/cycle/cycle_state.hpp"
#include "hal/sim/line/server.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::cli {

struct DriveSample {
  double time_s = 0.0;       // robot time since the first frame
  double interval_ms = 0.0;  // since the previous frame arrived; a tick for the first
  rt::WheelSpeeds set{};
  rt::WheelSpeeds estimate{};
  rt::WheelSpeeds command{};
  std::optional<rt::WheelSpeeds> truth{};  // from our own virtual Create
};

// Joins the loop's states with the truth at the tick of each frame.
std::vector<DriveSample> join(const std::vector<hal::CycleState>& states,
                              const std::vector<hal::sim::TruthSample>& truth);

struct WheelFigures {
  double mean_set_mm_s = 0.0;
  double mean_estimate_mm_s = 0.0;
  double mean_truth_mm_s = 0.0;
  double steady_error_mm_s = 0.0;   // true (or estimated) minus set, once the set speed has been
                                    // constant for 1 s: mean over each such stretch, rms of those
  double tracking_rmse_mm_s = 0.0;  // true (or estimated) minus set, over the whole drive
  double estimate_rmse_mm_s = 0.0;  // estimated minus true, from 1 s on
};

struct DriveFigures {
  WheelFigures left{};
  WheelFigures right{};
  bool has_truth = false;
  bool has_steady = false;  // whether any set speed was constant for long enough
};

DriveFigures figures(const std::vector<DriveSample>& samples);

}  // namespace cargobay::cli
