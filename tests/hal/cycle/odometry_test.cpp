// The loop's odometry compared with where the virtual Create is: for both kinds, over many drives.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "tests/hal/virtual_drive.hpp"

namespace cargobay::hal {
namespace {

// A path with turns, different for each seed.
rt::WheelSpeeds wandering(double seconds, std::uint64_t seed) {
  const double phase = static_cast<double>(seed);
  return {200.0 + 80.0 * std::sin(0.7 * seconds + phase), 200.0 + 80.0 * std::cos(0.5 * seconds)};
}

struct PoseErrors {
  double position_mm = 0.0;  // greatest
  double heading_rad = 0.0;
  double within = 0.0;  // share of the drives whose end lies within what the covariance says
};

PoseErrors errors(sim::Remainder kind) {
  PoseErrors found;
  constexpr int kDrives = 40;
  int within = 0;
  for (std::uint64_t seed = 1; seed <= kDrives; ++seed) {
    test::VirtualDrive drive{{.remainder = kind, .seed = seed}};
    sim::WorldPose truth;
    drive.on_frame = [&](int /*frame*/, ControlCycle& /*cycle*/) {
      truth = drive.device.truth().pose;
    };
    ControlCycle::Parameters parameters;
    parameters.loop.estimator.remainder =
        kind == sim::Remainder::carried ? rt::Remainder::carried : rt::Remainder::lost;
    const test::DriveResult result =
        drive.run(1200, [seed](double seconds) { return wandering(seconds, seed); }, parameters);
    const CycleState& last = result.ticks.back().state;
    const Eigen::Vector3d error{last.pose.x_mm - truth.x_mm, last.pose.y_mm - truth.y_mm,
                                last.pose.heading_rad - truth.heading_rad};
    const rt::PoseCovariance& p = last.pose_covariance;
    Eigen::Matrix3d covariance;
    covariance << p.xx, p.xy, p.xh, p.xy, p.yy, p.yh, p.xh, p.yh, p.hh;
    found.position_mm = std::max(found.position_mm, std::hypot(error.x(), error.y()));
    found.heading_rad = std::max(found.heading_rad, std::abs(error.z()));
    constexpr double kChiSquare99 = 11.34;  // of three degrees of freedom
    if (error.dot(covariance.inverse() * error) < kChiSquare99) ++within;
  }
  found.within = static_cast<double>(within) / kDrives;
  return found;
}

// 18 s at about 200 mm/s: 3.6 m.
TEST(LoopOdometry, IsWithinWhatItsCovarianceSays) {
  const PoseErrors carried = errors(sim::Remainder::carried);
  EXPECT_LE(carried.position_mm, 40.0);
  EXPECT_LE(carried.heading_rad, 0.03);
  EXPECT_GE(carried.within, 0.95);
  const PoseErrors lost = errors(sim::Remainder::lost);
  // Each reading loses up to a degree, and it is unknown how much.
  EXPECT_LE(lost.position_mm, 900.0);
  EXPECT_LE(lost.heading_rad, 0.4);
  EXPECT_GE(lost.within, 0.7);
}

TEST(LoopOdometry, KeepsCountOverLostFrames) {
  constexpr int kPeriod = 15;  // one frame in this many is lost
  std::vector<double> x_mm;
  std::vector<double> heading_rad;
  for (int phase = 0; phase < kPeriod; ++phase) {
    test::VirtualDrive drive{{}};
    bool driving = false;  // before, a read is a byte
    int swallowed = phase;
    drive.line.damage = [&](std::span<std::uint8_t> bytes) {
      const bool gone = driving && ++swallowed % kPeriod == 0;
      return gone ? std::size_t{0} : bytes.size();
    };
    sim::WorldPose truth;
    drive.on_frame = [&](int /*frame*/, ControlCycle& /*cycle*/) {
      driving = true;
      truth = drive.device.truth().pose;
    };
    const test::DriveResult result =
        drive.run(800, [](double seconds) { return wandering(seconds, 1); });
    EXPECT_GT(result.frames.lost + result.frames.bad, 30U);
    const CycleState& last = result.ticks.back().state;
    x_mm.push_back(std::abs(last.pose.x_mm - truth.x_mm));
    heading_rad.push_back(std::abs(last.pose.heading_rad - truth.heading_rad));
  }
  std::ranges::sort(x_mm);
  std::ranges::sort(heading_rad);
  std::printf("x %.0f median, %.0f mm most; heading %.3f median, %.3f rad most\n",
              x_mm[kPeriod / 2], x_mm.back(), heading_rad[kPeriod / 2], heading_rad.back());
  EXPECT_LE(x_mm[kPeriod / 2], 150.0);
  EXPECT_LE(heading_rad[kPeriod / 2], 0.2);
}

}  // namespace
}  // namespace cargobay::hal
