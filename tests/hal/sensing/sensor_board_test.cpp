#include "hal/sensing/sensor_board.hpp"

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using oi::PacketId;

TEST(SensorBoard, AddsUpEachFrameOnce) {
  SensorBoard board;
  oi::SensorValues frame;
  frame.set(PacketId::distance, 7);
  frame.set(PacketId::angle, -2);
  board.see(frame, 0);
  EXPECT_EQ(board.readings().distance_sum_mm, 7);
  frame.set(PacketId::distance, -10);
  board.see(frame, 1);
  // One that does not have the counters, as of lists that take turns: the board shows the last.
  oi::SensorValues other;
  other.set(PacketId::wall_signal, 5);
  board.see(other, 2);
  const SensorReadings read = board.readings();
  EXPECT_EQ(read.value[static_cast<std::size_t>(PacketId::distance)], -10);
  EXPECT_EQ(read.distance_sum_mm, -3);
  EXPECT_EQ(read.angle_sum_deg, -4);
}

}  // namespace
}  // namespace cargobay::hal
