#include "hal/recording/estimate_again.hpp"

#include <random>

#include <gtest/gtest.h>

#include "tests/hal/recorded_drive.hpp"

namespace cargobay::hal {
namespace {

using test::RecordedDrive;

EstimateDifference again(const RecordedDrive& drive,
                         const rt::WheelEstimator::Parameters& parameters) {
  const auto file = drive.file();
  const auto recording = Recording::read(file);
  EXPECT_TRUE(recording) << recording.failure().message;
  return estimate_again(*recording, parameters);
}

TEST(EstimateAgain, IsTheSameWithTheSameParameters) {
  for (const auto kind : {sim::Remainder::carried, sim::Remainder::lost}) {
    RecordedDrive drive{sim::Parameters{.remainder = kind}};
    drive.run(2000);
    const EstimateDifference same = again(drive, drive.header.parameters.loop.estimator);
    EXPECT_EQ(same.ticks, 2000U);
    EXPECT_EQ(same.most, rt::WheelSpeeds{}) << "not by one bit";
    EXPECT_EQ(same.belief, same.recorded_belief);
  }
}

// The loop finds out later how long a silence lasted, by the second frame after it.
TEST(EstimateAgain, IsNearlyTheSameThroughASilence) {
  RecordedDrive drive;
  int swallowed = 0;
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    const bool silent = drive.states.size() == 300 && swallowed < 20;
    if (silent) ++swallowed;
    return silent ? 0 : bytes.size();
  };
  drive.run(600);
  const EstimateDifference near = again(drive, drive.header.parameters.loop.estimator);
  EXPECT_LT(near.rms.left_mm_s, 3.0);
  EXPECT_LT(near.rms.right_mm_s, 3.0);
}

TEST(EstimateAgain, IsNearlyTheSameOnADisturbedLine) {
  RecordedDrive drive;
  std::mt19937 random{4};
  drive.line.damage = [&](std::span<std::uint8_t> bytes) {
    if (random() % 20 == 0) bytes[random() % bytes.size()] ^= 0x10;
    return random() % 50 == 0 ? 0 : bytes.size();
  };
  drive.run(2000);
  const EstimateDifference near = again(drive, drive.header.parameters.loop.estimator);
  EXPECT_LT(near.rms.left_mm_s, 10.0);
  EXPECT_LT(near.rms.right_mm_s, 10.0);
}

TEST(EstimateAgain, TellsHowMuchAParameterMatters) {
  RecordedDrive drive;
  drive.run(2000);
  auto parameters = drive.header.parameters.loop.estimator;
  parameters.wheel_base_mm *= 1.1;
  const EstimateDifference base = again(drive, parameters);
  EXPECT_GT(base.rms.left_mm_s, 0.5);
  EXPECT_GE(base.most.left_mm_s, base.rms.left_mm_s);
  parameters = drive.header.parameters.loop.estimator;
  parameters.remainder = rt::Remainder::lost;
  const EstimateDifference lost = again(drive, parameters);
  EXPECT_GT(lost.rms.right_mm_s, 0.5);
  EXPECT_EQ(lost.belief, rt::RemainderBelief::lost);
}

}  // namespace
}  // namespace cargobay::hal
