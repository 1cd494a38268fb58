#include "hal/cycle/frame_receiver.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "oi/dialect.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

using namespace std::chrono_literals;

// A frame of a list, with the checksum that robots send.
std::vector<std::uint8_t> frame(FrameList list, std::uint8_t data = 0) {
  std::vector<std::uint8_t> bytes{19, static_cast<std::uint8_t>(oi::kCreate.frame_bytes - 3)};
  for (const oi::PacketId packet : oi::kCreate.list(list)) {
    bytes.push_back(static_cast<std::uint8_t>(packet));
    bytes.insert(bytes.end(), oi::kCreate.packet_size(static_cast<std::uint8_t>(packet)), data);
  }
  bytes.push_back(static_cast<std::uint8_t>(-std::accumulate(bytes.begin(), bytes.end(), 0)));
  return bytes;
}

class FrameReceiverTest : public testing::Test {
 protected:
  FrameReceiverTest() { receiver_.begin(rt::TimePoint{}); }
  // The lists of the frames in it; nothing for an unknown one.
  std::vector<std::optional<FrameList>> receive(const std::vector<std::uint8_t>& bytes,
                                                rt::Duration at = 15ms) {
    std::copy(bytes.begin(), bytes.end(), receiver_.room().begin());
    std::vector<std::optional<FrameList>> lists;
    receiver_.decode(bytes.size(), rt::TimePoint{at},
                     [&](const oi::SensorValues&) CARGOBAY_NONBLOCKING {
                       rt::unchecked([&]() noexcept { lists.push_back(receiver_.list()); });
                     });
    return lists;
  }
  FrameReceiver receiver_{oi::kCreate, 15ms};
};

TEST_F(FrameReceiverTest, KnowsEachListByItsFrame) {
  using enum FrameList;
  for (const FrameList list : {reading, hazards, battery, signals_left, signals_right, outputs,
                               distance, distance_buttons, angle}) {
    const auto lists = receive(frame(list));
    ASSERT_EQ(lists.size(), 1U);
    EXPECT_EQ(lists[0], list);
    EXPECT_EQ(receiver_.reads(), axes_of(list));
    EXPECT_TRUE(receiver_.whole());
  }
}

TEST_F(FrameReceiverTest, KnowsAFrameThatNobodyAskedFor) {
  const auto lists = receive({19, 2, 7, 0, 228});
  ASSERT_EQ(lists.size(), 1U);
  EXPECT_EQ(lists[0], std::nullopt);
}

TEST_F(FrameReceiverTest, HasOneEntryForEachFrame) {
  std::vector<std::uint8_t> bytes = frame(FrameList::hazards);
  const std::vector<std::uint8_t> second = frame(FrameList::reading, 1);
  bytes.insert(bytes.end(), second.begin(), second.end());
  EXPECT_EQ(receive(bytes).size(), 2U);
  ASSERT_EQ(receiver_.readings().size(), 2U);
  EXPECT_FALSE(receiver_.readings()[0].axes().any());
  EXPECT_EQ(receiver_.readings()[1].axes(), rt::kBothAxes);
  EXPECT_EQ(receiver_.readings()[1].distance_mm, 257);
  EXPECT_TRUE(receive({}).empty());
  EXPECT_TRUE(receiver_.empty()) << "of this pass";
}

TEST_F(FrameReceiverTest, GivesUpAnOpenFrameWhenTheLineIsQuiet) {
  std::vector<std::uint8_t> bytes{19, 40};  // the beginning of a frame that is longer than ours
  const std::vector<std::uint8_t> whole = frame(FrameList::reading);
  bytes.insert(bytes.end(), whole.begin(), whole.end());
  EXPECT_TRUE(receive(bytes, 15ms).empty());
  EXPECT_FALSE(receiver_.whole());
  EXPECT_TRUE(receive({}, 44ms).empty());
  EXPECT_EQ(receive({}, 45ms).size(), 1U) << "two ticks after the last byte";
  EXPECT_TRUE(receiver_.whole());
}

TEST_F(FrameReceiverTest, CountsWhatWasNoFrameOnce) {
  std::vector<std::uint8_t> bytes = frame(FrameList::reading);
  bytes.back() ^= 1U;
  const std::vector<std::uint8_t> good = frame(FrameList::reading);
  bytes.insert(bytes.end(), good.begin(), good.end());
  EXPECT_EQ(receive(bytes).size(), 1U);
  EXPECT_EQ(receiver_.take_corrupt(), 1U);
  EXPECT_EQ(receiver_.take_corrupt(), 0U);
}

}  // namespace
}  // namespace cargobay::hal
