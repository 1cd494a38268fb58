#include "tests/campaign/plant_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>

#include "tests/campaign/plant_drive.hpp"
#include "tests/campaign/plant_targets.hpp"

namespace cargobay::campaign {
namespace {

constexpr double kChiSquare99 = 9.21;  // of two degrees of freedom
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kDriveS = 34.0;
constexpr double kError = 0.02;

constexpr std::array kNames{"square with stops", "driving about", "setpoints every 105 ms", "eight",
                            "stop and go"};

bool inside(const Driven& driven) {
  const double x_mm = driven.pose.x_mm - driven.truth.x_mm;
  const double y_mm = driven.pose.y_mm - driven.truth.y_mm;
  const rt::PoseCovariance& p = driven.covariance;
  const double distance = (x_mm * x_mm * p.yy - 2.0 * x_mm * y_mm * p.xy + y_mm * y_mm * p.xx) /
                          (p.xx * p.yy - p.xy * p.xy);
  return distance < kChiSquare99;
}

// Each wheel slips, misses counts or neither; the base is wrong.
PlantValues wronged(PlantValues plant, std::uint64_t seed) {
  std::mt19937_64 random{seed + 17};
  const auto of_three = [&random] {
    return kError * (static_cast<double>(std::uniform_int_distribution<int>{0, 2}(random)) - 1.0);
  };
  plant.slip_left = of_three();
  plant.slip_right = of_three();
  plant.base_error = random() % 2 == 0 ? kError : -kError;
  plant.counts_by_command = true;
  return plant;
}

}  // namespace

void OdometryRows::see(const PlantValues& plant, std::uint64_t seed) {
  see_drives(plant, seed);
  see_courses(plant, seed);
}

void OdometryRows::see_drives(PlantValues plant, std::uint64_t seed) {
  const std::array<Target, kDrives> targets{
      then_stand(square, kDriveS), then_stand(about(plant, seed), kDriveS),
      then_stand(steered(seed), kDriveS), then_stand(eight, kDriveS),
      then_stand(stop_and_go, kDriveS)};
  const auto note = [seed](const PlantValues& robot, const Target& target, Row& row) {
    const Driven driven = drive(robot, seed, kDriveS + 3.0, target);
    row.position_mm.add(
        std::hypot(driven.pose.x_mm - driven.truth.x_mm, driven.pose.y_mm - driven.truth.y_mm));
    row.heading_deg.add(std::abs(driven.pose.heading_rad - driven.truth.heading_rad) / kDegree);
    row.inside.add(inside(driven) ? 1.0 : 0.0);
  };
  for (std::size_t i = 0; i < kDrives; ++i) {
    note(plant, targets[i], plain_[i]);
    note(wronged(plant, seed), targets[i], wrong_);
    plant.counts_by_command = true;
    note(plant, targets[i], by_command_[i]);
    plant.counts_by_command = false;
  }
}

void OdometryRows::see_courses(const PlantValues& plant, std::uint64_t seed) {
  constexpr double kFarMm = 5000.0;
  std::mt19937_64 random{seed + 19};
  const auto draw = [&random](double least, double most) {
    return std::uniform_real_distribution<double>{least, most}(random);
  };
  const double speed = draw(100.0, fastest(plant));
  const Target straight = [speed](double) { return WheelSpeeds{speed, speed}; };
  for (const bool holds : {false, true}) {
    const Driven driven = drive(plant, seed, 1.3 * kFarMm / speed, straight,
                                {.holds_heading = holds, .until_x_mm = kFarMm});
    Course& course = holds ? held_ : alone_;
    course.aside_mm.add(std::abs(driven.truth.y_mm));
    course.heading_deg.add(std::abs(driven.truth.heading_rad) / kDegree);
  }
  // An arc of 13 s, and from its third second on.
  const double inner = draw(0.4, 0.9) * speed;
  const Driven arc = drive(plant, seed, 13.0, [&](double) { return WheelSpeeds{inner, speed}; });
  const auto curvature_off = [&](double from_s) {
    double left_mm = 0.0;
    double right_mm = 0.0;
    for (const State& state : arc.states) {
      if (state.time_s < from_s) continue;
      left_mm += state.truth.left_mm_s * kTickS;
      right_mm += state.truth.right_mm_s * kTickS;
    }
    const double asked = (speed - inner) / (speed + inner);
    return 100.0 * std::abs((right_mm - left_mm) / (right_mm + left_mm) / asked - 1.0);
  };
  curvature_.add(curvature_off(0.0));
  late_curvature_.add(curvature_off(3.0));
}

void print_odometry(OdometryRows& carried, OdometryRows& lost) {
  const auto row = [](const char* what, Figures& of_carried, Figures& of_lost) {
    std::printf("| %s | %s | %s |\n", what, shares(of_carried).c_str(), shares(of_lost).c_str());
  };
  const auto part = [](const char* what, const Figures& of_carried, const Figures& of_lost) {
    std::printf("| %s | %.1f | %.1f |\n", what, 100.0 * mean(of_carried), 100.0 * mean(of_lost));
  };
  for (std::size_t i = 0; i < OdometryRows::kDrives; ++i) {
    std::printf("| odometry, %s, 34 s: mm | %s | %s |\n", kNames[i],
                shares(carried.plain_[i].position_mm).c_str(),
                shares(lost.plain_[i].position_mm).c_str());
    row("the same: degrees", carried.plain_[i].heading_deg, lost.plain_[i].heading_deg);
    row("counters with the sign of the command: mm", carried.by_command_[i].position_mm,
        lost.by_command_[i].position_mm);
    row("the same: degrees", carried.by_command_[i].heading_deg, lost.by_command_[i].heading_deg);
    part("truth inside the 99 % ellipse, %", carried.plain_[i].inside, lost.plain_[i].inside);
  }
  part("all drives, slip and base of 2 %, sign of the command: inside, %", carried.wrong_.inside,
       lost.wrong_.inside);
  row("5 m straight: mm aside", carried.alone_.aside_mm, lost.alone_.aside_mm);
  row("the same: degrees", carried.alone_.heading_deg, lost.alone_.heading_deg);
  row("5 m with heading hold: mm aside", carried.held_.aside_mm, lost.held_.aside_mm);
  row("the same: degrees", carried.held_.heading_deg, lost.held_.heading_deg);
  row("arc of 13 s from standing: curvature off, %", carried.curvature_, lost.curvature_);
  row("its last 10 s: curvature off, %", carried.late_curvature_, lost.late_curvature_);
}

bool OdometryRows::hold() {
  constexpr double kInside = 0.95;  // of few plants
  bool all = true;
  const auto at_least = [&all](const char* what, const Figures& figures) {
    if (mean(figures) >= kInside) return;
    std::printf("does not hold: %s: inside the ellipse in %.3f of drives\n", what, mean(figures));
    all = false;
  };
  for (std::size_t i = 0; i < kDrives; ++i) at_least(kNames[i], plain_[i].inside);
  at_least("slip and base", wrong_.inside);
  return all;
}

}  // namespace cargobay::campaign
