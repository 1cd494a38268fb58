#include "rt/odometry.hpp"

#include <cmath>

namespace cargobay::rt {
namespace {

// How x, y and heading follow from a little way ahead and a little turn.
Eigen::Matrix<double, 3, 2> directions(double heading_rad) noexcept CARGOBAY_NONBLOCKING {
  Eigen::Matrix<double, 3, 2> matrix;
  matrix << std::cos(heading_rad), 0.0, std::sin(heading_rad), 0.0, 0.0, 1.0;
  return matrix;
}

}  // namespace

void Odometry::reset(const Pose& pose) noexcept CARGOBAY_NONBLOCKING {
  pose_ = pose;
  grown_.setZero();
}

void Odometry::step(const Travel& travel) noexcept CARGOBAY_NONBLOCKING {
  const double base_mm = parameters_.wheel_base_mm;
  const double distance_mm = travel.distance_mm * parameters_.distance_scale;
  const double turn_rad = travel.turn_rad * parameters_.turn_scale;
  const double middle_rad = pose_.heading_rad + turn_rad / 2.0;
  // The chord of the arc; a turn of one step is so small that a series is exact.
  const double chord_mm = distance_mm * (1.0 - turn_rad * turn_rad / 24.0);

  const double slip = parameters_.slip_mm2_per_mm;
  const double left_mm = std::abs(distance_mm - turn_rad * base_mm / 2.0);
  const double right_mm = std::abs(distance_mm + turn_rad * base_mm / 2.0);
  const double slip_variance = slip * (left_mm + right_mm);
  Eigen::Matrix2d moved;
  moved << travel.distance_variance + slip_variance / 4.0,
      slip * (right_mm - left_mm) / (2.0 * base_mm), slip * (right_mm - left_mm) / (2.0 * base_mm),
      travel.turn_variance + slip_variance / (base_mm * base_mm);

  Eigen::Matrix3d carried = Eigen::Matrix3d::Identity();
  carried(0, 2) = -chord_mm * std::sin(middle_rad);
  carried(1, 2) = chord_mm * std::cos(middle_rad);
  const Eigen::Matrix<double, 3, 2> ahead = directions(middle_rad);
  grown_ = (carried * grown_ * carried.transpose() + ahead * moved * ahead.transpose()).eval();

  pose_.x_mm += chord_mm * std::cos(middle_rad);
  pose_.y_mm += chord_mm * std::sin(middle_rad);
  pose_.heading_rad += turn_rad;
  distance_mm_ += distance_mm;
  unread_distance_ = travel.unread_distance_variance;
  unread_turn_ = travel.unread_turn_variance;
}

std::array<double, 9> Odometry::covariance() const noexcept CARGOBAY_NONBLOCKING {
  const Eigen::Matrix<double, 3, 2> ahead = directions(pose_.heading_rad);
  Eigen::Matrix2d unread = Eigen::Matrix2d::Zero();
  unread(0, 0) = unread_distance_;
  unread(1, 1) = unread_turn_;
  std::array<double, 9> rows{};
  // Symmetric: columns are rows.
  Eigen::Map<Eigen::Matrix3d>{rows.data()} = grown_ + ahead * unread * ahead.transpose();
  return rows;
}

}  // namespace cargobay::rt
