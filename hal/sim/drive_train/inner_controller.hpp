// The velocity controller inside a robot: at each of its ticks it counts the encoder steps since
// the last, and drives its motor by proportional and integral feedback.
#pragma once

#include <algorithm>
#include <cstdint>

namespace cargobay::hal::sim {

class InnerController {
 public:
  static constexpr double kFullDriveMmPerSec = 700.0;  // a free wheel at full voltage

  struct Gains {
    double period_s = 0.015;
    double proportional = 0.0;
    double integral_per_s = 0.0;
  };

  // `counts` of the encoder so far; `set_mm_s` is what they are to become.
  void tick(const Gains& gains, double set_mm_s, std::int64_t counts, double counts_per_mm) {
    const auto seen = static_cast<double>(counts - counts_);
    counts_ = counts;
    const double error_mm_s = set_mm_s - seen / (counts_per_mm * gains.period_s);
    const double step_mm_s = gains.integral_per_s * gains.period_s * error_mm_s;
    integral_mm_s_ =
        std::clamp(integral_mm_s_ + step_mm_s, -kFullDriveMmPerSec, kFullDriveMmPerSec);
    drive_mm_s_ = std::clamp(gains.proportional * error_mm_s + integral_mm_s_, -kFullDriveMmPerSec,
                             kFullDriveMmPerSec);
  }
  // The motor is off: it counts on, without driving.
  void look(std::int64_t counts) { counts_ = counts; }
  // Switches the motor off.
  void release() { begin(0.0, counts_); }
  // Goes on from this speed.
  void begin(double drive_mm_s, std::int64_t counts) {
    counts_ = counts;
    integral_mm_s_ = drive_mm_s;
    drive_mm_s_ = drive_mm_s;
  }

  // How fast a free wheel would turn, in the end.
  double drive_mm_s() const { return drive_mm_s_; }

 private:
  std::int64_t counts_ = 0;  // at the last tick
  double integral_mm_s_ = 0.0;
  double drive_mm_s_ = 0.0;
};

}  // namespace cargobay::hal::sim
