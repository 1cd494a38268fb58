#include "hal/bring_up/sensor_stream.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/stream/forwarding_stream.hpp"
#include "oi/dialect.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {
namespace {

using oi::PacketId;
using testing::HasSubstr;

// Counts calls, loses bytes, and keeps commands from the robot.
class CountingLine final : public ForwardingStream {
 public:
  using ForwardingStream::ForwardingStream;

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    ++calls;
    return ForwardingStream::wait(deadline);
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    ++calls;
    if (gone) return {.error = EIO};  // a link in virtual time still has what comes
    Transfer got = ForwardingStream::read(bytes);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < got.count; ++i) {
      if (++seen == lose_at) {
        ++lost;
        lose_at += lose_every;
      } else {
        bytes[kept++] = bytes[i];
      }
    }
    got.count = kept;
    return got;
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    if (bytes[0] == deaf_to) return {.count = bytes.size()};
    return ForwardingStream::write(bytes);
  }
  void sleep(rt::Duration duration) override {
    ++calls;
    ForwardingStream::sleep(duration);
  }

  int calls = 0;
  int lost = 0;
  std::uint64_t seen = 0;
  std::uint64_t lose_at = 0;  // the number of the next byte that is lost, from 1
  std::uint64_t lose_every = 0;
  std::uint8_t deaf_to = 0;  // opcode
  bool gone = false;
};

class SensorStreamTest : public testing::Test {
 protected:
  void drive(std::int16_t left_mm_s, std::int16_t right_mm_s) {
    const auto high = [](std::int16_t value) { return static_cast<std::uint8_t>(value >> 8); };
    const auto low = [](std::int16_t value) { return static_cast<std::uint8_t>(value & 0xff); };
    const std::array<std::uint8_t, 7> bytes{
        128, 131, 145, high(right_mm_s), low(right_mm_s), high(left_mm_s), low(left_mm_s)};
    (void)link_.write(bytes);
    link_.advance(std::chrono::milliseconds{100});
  }

  sim::Device device_{sim::Parameters{}};
  sim::VirtualLink link_{device_};
  CountingLine line_{link_};
  std::vector<PacketId> packets_{PacketId::distance, PacketId::angle, PacketId::oi_mode};
};

TEST_F(SensorStreamTest, SumsDistanceAndAngleOfEveryFrame) {
  drive(200, 300);
  auto stream = SensorStream::open(line_, packets_);
  ASSERT_TRUE(stream) << stream.failure().message;
  EXPECT_THAT((*stream)->why_asked(), testing::IsEmpty());
  std::int64_t distance = 0;
  std::int64_t angle = 0;
  for (int i = 0; i < 200; ++i) {
    const auto frame = (*stream)->next();
    ASSERT_TRUE(frame) << frame.failure().message;
    distance += frame->values.raw(PacketId::distance);
    angle += frame->values.raw(PacketId::angle);
    EXPECT_EQ(frame->distance_mm, distance);
    EXPECT_EQ(frame->angle_deg, angle);
  }
  EXPECT_GT(distance, 500);
  EXPECT_GT(angle, 20);
}

TEST_F(SensorStreamTest, CostsOneSleepAndOneReadAFrame) {
  auto stream = SensorStream::open(line_, packets_);
  ASSERT_TRUE(stream);
  constexpr int kFrames = 500;
  line_.calls = 0;
  const rt::TimePoint begin = link_.now();
  for (int i = 0; i < kFrames; ++i) ASSERT_TRUE((*stream)->next());
  EXPECT_LE(line_.calls, 2 * kFrames + kFrames / 10);
  EXPECT_LE(link_.now() - begin, (kFrames + 1) * oi::kTick) << "none is left waiting";
}

TEST_F(SensorStreamTest, LosesNoMoreThanTheFramesThatAreDamaged) {
  auto stream = SensorStream::open(line_, packets_);
  ASSERT_TRUE(stream);
  const std::size_t frame = oi::frame_bytes(packets_);
  line_.lose_every = 10 * frame + 1;  // each byte of a frame is lost once
  line_.lose_at = line_.seen + line_.lose_every;
  const rt::TimePoint begin = link_.now();
  int frames = 0;
  line_.calls = 0;
  while (link_.now() - begin < std::chrono::seconds{15}) {
    ASSERT_TRUE((*stream)->next());
    ++frames;
  }
  EXPECT_GT(line_.lost, 50);
  EXPECT_GE(frames, 1000 - 2 * line_.lost - 1);
  EXPECT_LE(line_.calls, 4 * frames);
}

TEST_F(SensorStreamTest, AsksForFramesThatDoNotFitTheLine) {
  drive(100, 100);
  ASSERT_EQ(link_.write(std::array<std::uint8_t, 2>{129, 4}).error, 0);  // 4800 baud
  link_.advance(std::chrono::milliseconds{100});
  ASSERT_FALSE(link_.set_baud(4800));
  const std::vector<PacketId> all{PacketId::group_6};
  auto stream = SensorStream::open(line_, all);
  ASSERT_TRUE(stream) << stream.failure().message;
  EXPECT_THAT((*stream)->why_asked(), HasSubstr("do not fit 4800 baud"));
  const rt::TimePoint begin = link_.now();
  std::int64_t distance = 0;
  for (int i = 0; i < 20; ++i) {
    const auto frame = (*stream)->next();
    ASSERT_TRUE(frame) << frame.failure().message;
    EXPECT_EQ(frame->values.mode(), oi::Mode::safe);
    distance = frame->distance_mm;
  }
  const double driven_mm = 100.0 * rt::seconds(link_.now() - begin);
  EXPECT_NEAR(static_cast<double>(distance), driven_mm, 0.15 * driven_mm);
}

TEST_F(SensorStreamTest, AsksARobotThatDoesNotStream) {
  line_.deaf_to = oi::Stream::kOpcode;
  auto stream = SensorStream::open(line_, packets_);
  ASSERT_TRUE(stream) << stream.failure().message;
  EXPECT_THAT((*stream)->why_asked(), HasSubstr("does not stream"));
  rt::TimePoint before{};
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE((*stream)->next());
    EXPECT_GE(link_.now() - before, oi::kTick) << "no more often (OI p. 13)";
    before = link_.now();
  }
}

TEST_F(SensorStreamTest, SaysThatThePortHungUp) {
  auto stream = SensorStream::open(line_, packets_);
  ASSERT_TRUE(stream);
  ASSERT_TRUE((*stream)->next());
  link_.hang_up();
  line_.gone = true;
  const auto frame = (*stream)->next();
  ASSERT_FALSE(frame);
  EXPECT_THAT(frame.failure().message, HasSubstr("the port hung up"));
}

TEST_F(SensorStreamTest, SaysThatNothingAnswers) {
  line_.deaf_to = oi::Start::kOpcode;
  const auto stream = SensorStream::open(line_, packets_);
  ASSERT_FALSE(stream);
  EXPECT_THAT(stream.failure().message, HasSubstr("does not answer"));
}

}  // namespace
}  // namespace cargobay::hal
