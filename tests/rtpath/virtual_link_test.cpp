// The virtual Create runs within the calls of its link: it must not allocate or lock there either,
// or no test over it could prove anything about the control cycle.
#include "hal/sim/line/virtual_link.hpp"

#include <array>
#include <chrono>

#include <gtest/gtest.h>

#include "tests/rtpath/call_counters.hpp"

namespace cargobay::hal::sim {
namespace {

using std::chrono_literals::operator""s;

TEST(VirtualLink, NeitherAllocatesNorLocksInItsCalls) {
  Device device{Parameters{}};
  VirtualLink link{device};
  const std::array<std::uint8_t, 9> start{128, 131, 148, 4, 19, 20, 35, 6, 0};
  (void)link.write(start);
  link.advance(1s);
  ASSERT_FALSE(link.set_wake_threshold(65));

  test::begin_counting();
  std::uint64_t frames = 0;
  for (int i = 0; i < 1000; ++i) {
    if (link.wait(link.now() + 1s) == ByteStream::Wait::ready) ++frames;
    std::array<std::uint8_t, 256> bytes{};
    (void)link.read(bytes);
    const std::array<std::uint8_t, 5> drive{145, 0, 200, 0, static_cast<std::uint8_t>(i % 200)};
    (void)link.write(drive);
    if (i == 500) device.inputs().wheel_drop_left = true;  // nor does a change of mode allocate
  }
  const test::Calls calls = test::end_counting();
  EXPECT_EQ(calls.heap, 0U);
  EXPECT_EQ(calls.locks, 0U);
  EXPECT_EQ(calls.waits, 0U);
  EXPECT_GT(frames, 900U);
}

}  // namespace
}  // namespace cargobay::hal::sim
