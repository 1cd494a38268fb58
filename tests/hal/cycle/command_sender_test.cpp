#include "hal/cycle/command_sender.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <span>
#include <system_error>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using Sent = CommandSender::Sent;

// A port that records what it accepts.
class Port final : public ByteStream {
 public:
  std::vector<std::uint8_t> taken{};
  std::size_t room = 1000;  // of the next write
  int error = 0;            // of the next write
  bool open = true;
  rt::TimePoint time{1s};

  Wait wait(rt::TimePoint) CARGOBAY_NONBLOCKING override { return Wait::timed_out; }
  Transfer read(std::span<std::uint8_t>) CARGOBAY_NONBLOCKING override { return {}; }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    if (error != 0) return {.error = error};
    const std::size_t count = std::min(room, bytes.size());
    rt::unchecked([&]() noexcept {
      taken.insert(taken.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
    });
    return {.count = count};
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return time; }
  bool still_open() const CARGOBAY_NONBLOCKING override { return open; }
  std::uint32_t baud() const override { return 57600; }
  std::error_code set_baud(std::uint32_t) override { return {}; }
  std::error_code set_wake_threshold(std::size_t) override { return {}; }
  void discard_input() override {}
  bool drain(rt::Duration) override { return true; }
  void sleep(rt::Duration) override {}
};

class CommandSenderTest : public testing::Test {
 protected:
  CommandSender::Moment moment(oi::Mode mode = oi::Mode::safe, bool set_stands = false) const {
    return {.now = port_.time,
            .woken = port_.time,
            .frames_read = true,
            .mode = mode,
            .set_stands = set_stands};
  }
  // What the port accepted with this write.
  std::vector<std::uint8_t> drive(const rt::WheelSpeeds& speeds,
                                  FrameList list = FrameList::reading) {
    port_.taken.clear();
    sent_ = sender_.drive(speeds, list, moment());
    return port_.taken;
  }
  static Request request(std::initializer_list<std::uint8_t> bytes) {
    Request made;
    for (const std::uint8_t byte : bytes) made.bytes[made.size++] = byte;
    return made;
  }

  Port port_{};
  CommandSender sender_{port_, oi::kCreate, 15ms, 1s};
  Sent sent_ = Sent::failed;
};

TEST_F(CommandSenderTest, SendsADriveAndOnlyAChangedList) {
  EXPECT_THAT(drive({200.0, 100.0}), ElementsAre(145, 0, 100, 0, 200));
  EXPECT_EQ(sent_, Sent::whole);
  EXPECT_EQ(sender_.acting(), (rt::WheelSpeeds{200.0, 100.0}));
  EXPECT_THAT(drive({0.0, 0.0}, FrameList::hazards), ElementsAre(145, 0, 0, 0, 0, 148, 2, 35, 1));
  EXPECT_EQ(sender_.list(), FrameList::hazards);
  EXPECT_THAT(drive({0.0, 0.0}, FrameList::hazards), ElementsAre(145, 0, 0, 0, 0));
}

TEST_F(CommandSenderTest, CompletesACommandThatThePortTookInPart) {
  port_.room = 2;
  EXPECT_THAT(drive({200.0, 100.0}), ElementsAre(145, 0));
  EXPECT_EQ(sent_, Sent::not_whole);
  EXPECT_EQ(sender_.owed_bytes(), 3U);
  EXPECT_EQ(sender_.acting(), rt::WheelSpeeds{}) << "the robot has not got it";
  port_.room = 1000;
  EXPECT_THAT(drive({300.0, 300.0}), ElementsAre(100, 0, 200)) << "two would meet in a tick";
  EXPECT_EQ(sent_, Sent::withheld);
  EXPECT_EQ(sender_.acting(), (rt::WheelSpeeds{200.0, 100.0}));
}

TEST_F(CommandSenderTest, StopsInTheSameWriteAsTheRestOfACommand) {
  port_.room = 2;
  (void)drive({200.0, 100.0});
  port_.room = 1000;
  EXPECT_THAT(drive({0.0, 0.0}), ElementsAre(100, 0, 200, 145, 0, 0, 0, 0));
  EXPECT_EQ(sent_, Sent::whole);
}

TEST_F(CommandSenderTest, FillsUpALineThatWasDead) {
  sender_.doubt_hearing();
  const std::vector<std::uint8_t> bytes = drive({0.0, 0.0});
  ASSERT_GE(bytes.size(), CommandSender::kLongestOwnRest + 5);
  EXPECT_EQ(std::count(bytes.begin(), bytes.begin() + CommandSender::kLongestOwnRest, 0),
            static_cast<std::ptrdiff_t>(CommandSender::kLongestOwnRest));
  EXPECT_EQ(bytes[CommandSender::kLongestOwnRest], 145);
  EXPECT_EQ(bytes[CommandSender::kLongestOwnRest + 5], 148) << "zeros may have completed a list";
  EXPECT_THAT(drive({0.0, 0.0}), ElementsAre(145, 0, 0, 0, 0)) << "once is enough";
}

TEST_F(CommandSenderTest, SendsARequestThatTheModeAllows) {
  sender_.take_request(request({139, 2, 0, 255}));
  EXPECT_TRUE(sender_.request_waits());
  EXPECT_THAT(drive({0.0, 0.0}), ElementsAre(145, 0, 0, 0, 0, 139, 2, 0, 255));
  EXPECT_FALSE(sender_.request_waits());
}

TEST_F(CommandSenderTest, DropsARequestThatTheModeForbids) {
  sender_.take_request(request({139, 2, 0, 255}));
  port_.taken.clear();
  EXPECT_EQ(sender_.keep(FrameList::reading, std::nullopt, moment(oi::Mode::passive)), Sent::whole);
  EXPECT_THAT(port_.taken, ElementsAre());
  EXPECT_FALSE(sender_.request_waits());
}

TEST_F(CommandSenderTest, LetsALongRequestWaitUntilTheWheelsStand) {
  Request script = request({152, 100});
  script.size = 102;
  sender_.take_request(script);
  (void)drive({200.0, 200.0});
  EXPECT_EQ(drive({200.0, 200.0}).size(), 5U);
  EXPECT_TRUE(sender_.request_waits());
  (void)drive({0.0, 0.0});
  port_.taken.clear();
  (void)sender_.drive({}, FrameList::reading, moment(oi::Mode::safe, true));
  EXPECT_EQ(port_.taken.size(), 5U + 102U);
  EXPECT_FALSE(sender_.request_waits());
}

TEST_F(CommandSenderTest, GoesBackToTheModeWithoutADrive) {
  port_.taken.clear();
  EXPECT_EQ(sender_.keep(FrameList::hazards, oi::Mode::safe, moment(oi::Mode::passive)),
            Sent::whole);
  EXPECT_THAT(port_.taken, ElementsAre(131, 148, 2, 35, 1));
}

TEST_F(CommandSenderTest, WithholdsASecondCommandInATick) {
  FrameCounters counters;
  TickLedger ledger{oi::kCreate.frame_bytes, 15ms, 5ms, counters};
  oi::StreamDecoder::Counters bytes;
  const auto arrive = [&](rt::TimePoint time) {
    bytes.bytes += oi::kCreate.frame_bytes;
    bytes.framed += oi::kCreate.frame_bytes;
    (void)ledger.book({.time = time, .frames = 1, .corrupt = 0, .bytes = bytes});
  };
  for (int i = 0; i < 30; ++i) {
    port_.time += 15ms;
    arrive(port_.time);
    EXPECT_FALSE(sender_.must_withhold(port_.time, ledger)) << i;
    (void)drive({200.0, 200.0});
  }
  EXPECT_TRUE(sender_.must_withhold(port_.time + 3ms, ledger));
  // A late frame is answered in the tick of the next one.
  port_.time += 27ms;
  arrive(port_.time);
  EXPECT_FALSE(sender_.must_withhold(port_.time, ledger));
  (void)drive({200.0, 200.0});
  port_.time += 3ms;
  arrive(port_.time);
  EXPECT_TRUE(sender_.must_withhold(port_.time, ledger));
}

TEST_F(CommandSenderTest, WritesNothingToAPortThatIsNotItsOwn) {
  port_.open = false;
  port_.taken.clear();
  CommandSender::Moment silent = moment();
  silent.frames_read = false;
  EXPECT_EQ(sender_.drive({}, FrameList::reading, silent), Sent::failed);
  EXPECT_THAT(port_.taken, ElementsAre());
  sender_.note_hung_up(EIO);
  EXPECT_EQ(sender_.port_error(), EBADF);
  port_.open = true;
  sender_.note_hung_up(EIO);
  EXPECT_EQ(sender_.port_error(), EIO);
}

TEST_F(CommandSenderTest, TellsAFullPortFromAFailedOne) {
  port_.error = EAGAIN;
  (void)drive({200.0, 200.0});
  EXPECT_EQ(sent_, Sent::not_whole);
  port_.error = EIO;
  (void)drive({200.0, 200.0});
  EXPECT_EQ(sent_, Sent::failed);
  EXPECT_EQ(sender_.port_error(), EIO);
}

TEST_F(CommandSenderTest, WritesNothingOnceItIsAbandoned) {
  sender_.abandon();
  EXPECT_THAT(drive({200.0, 200.0}), ElementsAre());
  EXPECT_EQ(sent_, Sent::withheld);
}

TEST_F(CommandSenderTest, KnowsWhichListsMayHaveReadTheCounters) {
  using Counters = FrameRotation::Counters;
  EXPECT_EQ(sender_.next_list(Counters::wanted, rt::kBothAxes, FrameList::battery),
            FrameList::battery);
  EXPECT_EQ(sender_.may_have_read(false), rt::kBothAxes);
  (void)drive({0.0, 0.0}, FrameList::battery);
  for (int i = 0; i < 3; ++i) {
    (void)sender_.next_list(Counters::wanted, rt::kBothAxes, FrameList::battery);
    (void)drive({0.0, 0.0}, FrameList::battery);
  }
  EXPECT_FALSE(sender_.may_have_read(false).any());
  EXPECT_EQ(sender_.may_have_read(true), rt::kBothAxes) << "what never came is missed late";
  EXPECT_EQ(sender_.ends_window(), rt::kBothAxes);
  (void)sender_.next_list(Counters::wanted, {.distance = true}, std::nullopt);
  EXPECT_EQ(sender_.may_have_read(false), rt::Axes{.distance = true});
}

}  // namespace
}  // namespace cargobay::hal
