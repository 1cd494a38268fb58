#include "rt/setpoint_cell.hpp"

#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "tests/rt/stress.hpp"

namespace cargobay::rt {
namespace {

TEST(SetpointCell, IsAtRestUntilSomethingIsPut) {
  const SetpointCell cell;
  EXPECT_EQ(cell.get().speeds, WheelSpeeds{});
  EXPECT_EQ(cell.get().serial, 0U);
}

TEST(SetpointCell, KeepsSpeedsToItsResolution) {
  SetpointCell cell;
  for (int step = 0; step <= 276; ++step) {
    const double left = -511.0 + 3.7 * step;
    const double right = -0.5 * left + 0.123;
    ASSERT_TRUE(cell.put({left, right}));
    EXPECT_NEAR(cell.get().speeds.left_mm_s, left, SetpointCell::kResolution / 2.0);
    EXPECT_NEAR(cell.get().speeds.right_mm_s, right, SetpointCell::kResolution / 2.0);
  }
}

TEST(SetpointCell, KeepsWholeSpeedsExactly) {
  SetpointCell cell;
  for (int speed = -511; speed <= 511; ++speed) {
    ASSERT_TRUE(cell.put({static_cast<double>(speed), static_cast<double>(-speed)}));
    EXPECT_EQ(cell.get().speeds,
              (WheelSpeeds{static_cast<double>(speed), static_cast<double>(-speed)}));
  }
}

TEST(SetpointCell, RefusesWhatIsNoSpeed) {
  SetpointCell cell;
  ASSERT_TRUE(cell.put({100.0, 50.0}));
  const std::uint32_t serial = cell.get().serial;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double wrong : {kNan, kInfinity, -kInfinity, 511.01, -511.01, 1e300}) {
    EXPECT_FALSE(cell.put({wrong, 0.0}));
    EXPECT_FALSE(cell.put({0.0, wrong}));
  }
  EXPECT_EQ(cell.get().speeds, (WheelSpeeds{100.0, 50.0})) << "and nothing changed";
  EXPECT_EQ(cell.get().serial, serial);
}

TEST(SetpointCell, NumbersEachSetpoint) {
  SetpointCell cell;
  std::set<std::uint32_t> serials{0};
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(cell.put({1.0, 1.0}));  // the same again is a new setpoint
    EXPECT_TRUE(serials.insert(cell.get().serial).second);
  }
}

// 24 bits of them, and never 0 again.
TEST(SetpointCell, WrapsItsNumbersPastZero) {
  SetpointCell cell;
  for (std::uint32_t i = 0; i < (1U << 24U) - 1; ++i) ASSERT_TRUE(cell.put({1.0, 2.0}));
  EXPECT_EQ(cell.get().serial, (1U << 24U) - 1);
  ASSERT_TRUE(cell.put({3.0, 4.0}));
  EXPECT_EQ(cell.get().serial, 1U);
  EXPECT_EQ(cell.get().speeds, (WheelSpeeds{3.0, 4.0})) << "the wrap does not spill over";
}

// Left and right of one setpoint are opposite, so a mixture shows.
template <typename Cell>
bool is_caught_mixing(Cell& cell) {
  int next = 0;
  std::uint64_t changes = 0;
  double former = 0.0;
  bool caught = false;
  // If other load starves them, the two may hardly meet in one go.
  for (int i = 0; i < test::kMostGoes && !caught && changes < test::kLeast; ++i) {
    test::contend(
        [&] {
          next = next % 499 + 1;
          (void)cell.put({static_cast<double>(next), static_cast<double>(-next)});  // in range
        },
        [&] {
          const WheelSpeeds speeds = cell.get().speeds;
          caught = speeds.left_mm_s != -speeds.right_mm_s;
          if (speeds.left_mm_s != former) ++changes;
          former = speeds.left_mm_s;
          return caught || changes >= test::kEnough;
        });
  }
  EXPECT_TRUE(caught || changes >= test::kLeast) << "only " << changes << " setpoints seen";
  return caught;
}

TEST(SetpointCell, NeverMixesTwoSetpoints) {
  SetpointCell cell;
  EXPECT_FALSE(is_caught_mixing(cell));
}

TEST(SetpointCell, CountsSetpointsFromSeveralThreads) {
  SetpointCell cell;
  constexpr int kEach = 20'000;
  const auto put = [&cell](double speed) {
    for (int i = 0; i < kEach; ++i) (void)cell.put({speed, -speed});  // in range
  };
  std::thread one{put, 100.0};
  std::thread other{put, 200.0};
  one.join();
  other.join();
  EXPECT_EQ(cell.get().serial, 2U * kEach) << "none lost";
  EXPECT_EQ(cell.get().speeds.left_mm_s, -cell.get().speeds.right_mm_s);
}

// Wrong on purpose: one word per wheel.
class TwoWordCell {
 public:
  bool put(const WheelSpeeds& speeds) {
    left_.store(speeds.left_mm_s, std::memory_order_release);
    test::falter();
    right_.store(speeds.right_mm_s, std::memory_order_release);
    return true;
  }
  SetpointCell::Setpoint get() const {
    return {
        .speeds = {left_.load(std::memory_order_acquire), right_.load(std::memory_order_acquire)}};
  }

 private:
  std::atomic<double> left_{0.0};
  std::atomic<double> right_{0.0};
};

TEST(SetpointCell, WouldBeCaughtWithAWordForEachWheel) {
  TwoWordCell broken;
  EXPECT_TRUE(is_caught_mixing(broken));
}

}  // namespace
}  // namespace cargobay::rt
