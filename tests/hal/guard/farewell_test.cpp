// How a robot is left, in virtual time, through a port that fails once at any of its calls.

#include "hal/guard/farewell.hpp"

#include <cerrno>

#include <gtest/gtest.h>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/stream/forwarding_stream.hpp"
#include "hal/stream/write_all.hpp"
#include "oi/command_table.hpp"
#include "oi/encode.hpp"

namespace cargobay::hal {
namespace {

// The call with this index fails, whatever it is; with from_then_on, so do all that follow.
class FailingStream final : public ForwardingStream {
 public:
  FailingStream(ByteStream& stream, int at, int error)
      : ForwardingStream{stream}, at_{at}, error_{error} {}

  bool from_then_on = false;
  int calls() const { return calls_; }

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    return fails() ? Wait::hung_up : stream().wait(deadline);
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return fails() ? Transfer{.error = error_} : stream().read(bytes);
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return fails() ? Transfer{.error = error_} : stream().write(bytes);
  }

 private:
  bool fails() noexcept {
    const int call = calls_++;
    return call == at_ || (from_then_on && call > at_);
  }

  int at_;
  int error_;
  int calls_ = 0;
};

class FarewellTest : public testing::Test {
 protected:
  FarewellTest() {
    tell(oi::Start{});
    tell(oi::Full{});
    tell(oi::DriveDirect{.left = oi::MmPerSec{200}, .right = oi::MmPerSec{200}});
    link_.advance(std::chrono::milliseconds{300});
    EXPECT_EQ(device_.mode(), oi::Mode::full);
  }
  template <typename Command>
  void tell(const Command& command) {
    EXPECT_TRUE(write_all(link_, *oi::encode(command)));
    link_.advance(std::chrono::milliseconds{20});
  }
  void expect_standing() const {
    EXPECT_EQ(device_.mode(), oi::Mode::passive);
    EXPECT_EQ(device_.commanded(), sim::WheelSpeeds{});
  }

  sim::Device device_{sim::Parameters{}};
  sim::VirtualLink link_{device_};
};

TEST_F(FarewellTest, NeedsOneTryWhereNothingFails) {
  FailingStream stream{link_, -1, 0};
  EXPECT_EQ(farewell(stream), Parting::standing);
  EXPECT_LE(stream.calls(), 10);
  EXPECT_EQ(device_.counters().unknown_opcodes, 0U) << "no zeros without need";
  expect_standing();
}

TEST(Farewell, StandsWhicheverCallFailsOnce) {
  for (const int error : {EIO, ENOMEM, ENODEV, EBADF}) {
    for (int at = 0; at < 12; ++at) {
      sim::Device device{sim::Parameters{}};
      sim::VirtualLink link{device};
      ASSERT_TRUE(write_all(link, *oi::encode(oi::Start{})));
      ASSERT_TRUE(write_all(link, *oi::encode(oi::Full{})));
      FailingStream stream{link, at, error};
      EXPECT_EQ(farewell(stream), Parting::standing) << at;
      EXPECT_EQ(device.mode(), oi::Mode::passive) << at;
    }
  }
}

TEST_F(FarewellTest, SaysThatThePortIsGone) {
  FailingStream stream{link_, 0, EIO};
  stream.from_then_on = true;
  EXPECT_EQ(farewell(stream), Parting::port_gone);
}

TEST_F(FarewellTest, SaysThatTheRobotDoesNotAnswer) {
  sim::Device off{sim::Parameters{.power_on = sim::PowerOn::never}};
  sim::VirtualLink link{off};
  EXPECT_EQ(farewell(link), Parting::unconfirmed);
}

// It is unknown what was begun: the second try sends enough to complete any command.
TEST_F(FarewellTest, CompletesTheLongestCommandThereIs) {
  const std::array<std::uint8_t, 3> song_of_255{oi::Song::kOpcode, 0, 255};
  ASSERT_TRUE(write_all(link_, song_of_255));
  EXPECT_EQ(farewell(link_), Parting::standing);
  expect_standing();
}

TEST_F(FarewellTest, CompletesAtOnceWhatIsKnownToBeMissing) {
  const std::array<std::uint8_t, 3> half{oi::DriveDirect::kOpcode, 0, 100};
  ASSERT_TRUE(write_all(link_, half));
  const rt::TimePoint before = link_.now();
  EXPECT_EQ(farewell(link_, {.bytes = 2}), Parting::standing);
  EXPECT_LT(link_.now() - before, std::chrono::milliseconds{100}) << "of virtual time: one try";
  expect_standing();
}

TEST_F(FarewellTest, EndsADemo) {
  tell(oi::Demo{oi::DemoNumber::spot_cover});
  link_.advance(std::chrono::seconds{1});
  ASSERT_NE(device_.commanded(), sim::WheelSpeeds{});
  EXPECT_EQ(farewell(link_, {.demo = true}), Parting::standing);
  expect_standing();
}

TEST(LongestRest, IsASongOf255Notes) { EXPECT_EQ(oi::kLongestRest, 2U + 2U * 255U); }

}  // namespace
}  // namespace cargobay::hal
