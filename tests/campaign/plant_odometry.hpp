// The campaign's lines on where the robot is and how it keeps its course.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tests/campaign/plant_figures.hpp"
#include "tests/campaign/plant_robot.hpp"

namespace cargobay::campaign {

class OdometryRows {
 public:
  // Drives the plant and notes where it is, and where it thinks it is.
  void see(const PlantValues& plant, std::uint64_t seed);
  // Whether what docs/control.md promises holds; says what does not.
  bool hold();
  // How far aside 5 m with heading hold end.
  Figures& held_aside_mm() { return held_.aside_mm; }

 private:
  friend void print_odometry(OdometryRows& carried, OdometryRows& lost);
  static constexpr std::size_t kDrives = 5;
  struct Row {
    Figures position_mm{};
    Figures heading_deg{};
    Figures inside{};  // 1: the truth is inside the 99 % ellipse
  };
  void see_drives(PlantValues plant, std::uint64_t seed);
  void see_courses(const PlantValues& plant, std::uint64_t seed);

  std::array<Row, kDrives> plain_{};
  std::array<Row, kDrives> by_command_{};  // counters take the sign of the command
  Row wrong_{};                            // slip, base and the sign of the command, all drives
  struct Course {
    Figures aside_mm{};
    Figures heading_deg{};
  };
  Course alone_{};
  Course held_{};
  // Of an arc from standing, and of its last ten seconds.
  Figures curvature_{};
  Figures late_curvature_{};
};

// Lines of the table.
void print_odometry(OdometryRows& carried, OdometryRows& lost);

}  // namespace cargobay::campaign
