#include "hal/stream/spaced_stream.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

// A port in virtual time that records when it was given each byte.
class Port final : public ByteStream {
 public:
  struct Byte {
    rt::Duration at{};
    std::uint8_t value = 0;
    std::uint32_t baud = 0;
  };

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    now_ = std::max(now_, readable_at_ ? std::min(deadline, *readable_at_) : deadline);
    return readable_at_ && now_ >= *readable_at_ ? Wait::ready : Wait::timed_out;
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    readable_at_.reset();
    return {.count = bytes.empty() ? std::size_t{0} : std::size_t{1}};
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    ++writes;
    if (fails > 0) {
      --fails;
      return {.error = EIO};
    }
    for (const std::uint8_t value : bytes)
      taken_[size_++ % taken_.size()] = {
          .at = now_.time_since_epoch(), .value = value, .baud = baud_};
    return {.count = bytes.size()};
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return now_; }
  bool still_open() const CARGOBAY_NONBLOCKING override { return open; }
  std::uint32_t baud() const override { return baud_; }
  std::error_code set_baud(std::uint32_t baud) override {
    baud_ = baud;
    return {};
  }
  std::error_code set_wake_threshold(std::size_t) override { return {}; }
  void discard_input() override {}
  bool drain(rt::Duration) override { return true; }
  void sleep(rt::Duration duration) override { now_ += std::max(duration, rt::Duration::zero()); }

  std::vector<Byte> taken() const {
    return {taken_.begin(), taken_.begin() + static_cast<std::ptrdiff_t>(size_)};
  }
  void readable_in(rt::Duration duration) { readable_at_ = now_ + duration; }

  int writes = 0;
  int fails = 0;
  bool open = true;

 private:
  rt::TimePoint now_{std::chrono::hours{1}};
  std::optional<rt::TimePoint> readable_at_{};
  std::uint32_t baud_ = 115200;
  std::array<Byte, 2048> taken_{};
  std::size_t size_ = 0;
};

std::vector<std::uint8_t> counting(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

void expect_spaced(const std::vector<Port::Byte>& taken, std::size_t count) {
  ASSERT_EQ(taken.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(taken[i].value, static_cast<std::uint8_t>(i));
    if (i == 0) continue;
    EXPECT_GE(taken[i].at - taken[i - 1].at, SpacedStream::kInterval) << i;
  }
}

TEST(SpacedStream, IsStraightThroughBelow115200) {
  Port port;
  (void)port.set_baud(57600);
  SpacedStream stream{port};
  EXPECT_EQ(stream.write(counting(100)).count, 100U);
  EXPECT_EQ(port.writes, 1);
  EXPECT_EQ(port.taken().size(), 100U);
}

TEST(SpacedStream, IsInNobodysWayBelow115200) {
  Port port;
  SpacedStream stream{port};
  EXPECT_EQ(&stream.at_this_rate(), &stream);
  (void)stream.set_baud(57600);
  EXPECT_EQ(&stream.at_this_rate(), &port);
}

TEST(SpacedStream, LeavesTheFirstByteAtOnceAndTheOthersOneByOne) {
  Port port;
  SpacedStream stream{port};
  const rt::Duration before = stream.now().time_since_epoch();
  EXPECT_EQ(stream.write(counting(5)).count, 5U);
  ASSERT_EQ(port.taken().size(), 1U);
  EXPECT_EQ(port.taken()[0].at, before);
  EXPECT_TRUE(stream.drain(milliseconds{10}));
  expect_spaced(port.taken(), 5);
  EXPECT_EQ(port.taken()[4].at - before, 4 * SpacedStream::kInterval);
}

TEST(SpacedStream, SpacesWhatComesInSeveralWrites) {
  Port port;
  SpacedStream stream{port};
  const std::vector<std::uint8_t> bytes = counting(12);
  for (std::size_t i = 0; i < 12; i += 3) {
    EXPECT_EQ(stream.write(std::span{bytes}.subspan(i, 3)).count, 3U);
    stream.sleep(microseconds{250});
  }
  EXPECT_TRUE(stream.drain(milliseconds{10}));
  expect_spaced(port.taken(), 12);
}

TEST(SpacedStream, PassesOnWhileItWaitsForBytesOfTheRobot) {
  Port port;
  SpacedStream stream{port};
  (void)stream.write(counting(5));
  port.readable_in(microseconds{1000});
  EXPECT_EQ(stream.wait(stream.now() + milliseconds{15}), ByteStream::Wait::ready);
  EXPECT_EQ(port.taken().size(), 4U) << "those due in the first millisecond";
  std::array<std::uint8_t, 4> answer{};
  EXPECT_EQ(stream.read(answer).count, 1U);
  EXPECT_EQ(stream.wait(stream.now() + milliseconds{15}), ByteStream::Wait::timed_out);
  expect_spaced(port.taken(), 5);
}

TEST(SpacedStream, EndsItsWaitAtTheDeadline) {
  Port port;
  SpacedStream stream{port};
  (void)stream.write(counting(100));
  const rt::TimePoint deadline = stream.now() + milliseconds{2};
  EXPECT_EQ(stream.wait(deadline), ByteStream::Wait::timed_out);
  EXPECT_EQ(stream.now(), deadline);
  EXPECT_FALSE(stream.drain(milliseconds{1}));
  EXPECT_TRUE(stream.drain(milliseconds{100}));
  expect_spaced(port.taken(), 100);
}

TEST(SpacedStream, TakesNoMoreThanItHasRoomFor) {
  Port port;
  SpacedStream stream{port};
  const std::vector<std::uint8_t> bytes = counting(1000);
  const std::size_t count = stream.write(bytes).count;
  EXPECT_EQ(count, SpacedStream::kMostBytes);
  EXPECT_TRUE(stream.drain(std::chrono::seconds{1}));
  EXPECT_EQ(stream.write(std::span{bytes}.subspan(count)).count, 1000 - count);
  EXPECT_TRUE(stream.drain(std::chrono::seconds{1}));
  expect_spaced(port.taken(), 1000);
}

TEST(SpacedStream, SendsAllAtTheFormerRateBeforeItChanges) {
  Port port;
  SpacedStream stream{port};
  (void)stream.write(counting(3));
  EXPECT_FALSE(stream.set_baud(57600));
  expect_spaced(port.taken(), 3);
  for (const Port::Byte& byte : port.taken()) EXPECT_EQ(byte.baud, 115200U);
  EXPECT_EQ(stream.write(counting(100)).count, 100U);
  EXPECT_EQ(port.taken().size(), 103U);
}

TEST(SpacedStream, PassesOnWhatIsLeftWhenItEnds) {
  Port port;
  {
    SpacedStream stream{port};
    (void)stream.write(counting(5));
  }
  expect_spaced(port.taken(), 5);
}

TEST(SpacedStream, TriesAFailedByteOnceMore) {
  Port port;
  SpacedStream stream{port};
  port.fails = 1;
  EXPECT_EQ(stream.write(counting(5)).count, 5U);
  EXPECT_TRUE(stream.drain(milliseconds{10}));
  expect_spaced(port.taken(), 5);
}

TEST(SpacedStream, TellsOfAPortThatFailsTwiceAndDropsTheRest) {
  Port port;
  SpacedStream stream{port};
  port.fails = 2;
  (void)stream.write(counting(5));
  EXPECT_FALSE(stream.drain(milliseconds{10}));
  EXPECT_TRUE(port.taken().empty());
  EXPECT_EQ(stream.write(counting(1)).error, EIO);
  EXPECT_EQ(stream.write(counting(1)).error, 0);
}

TEST(SpacedStream, WritesNothingToAPortThatWasClosedMeanwhile) {
  Port port;
  SpacedStream stream{port};
  (void)stream.write(counting(5));
  port.open = false;
  EXPECT_FALSE(stream.drain(milliseconds{10}));
  EXPECT_EQ(port.taken().size(), 1U);
}

}  // namespace
}  // namespace cargobay::hal
