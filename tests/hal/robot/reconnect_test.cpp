// How a lost link is sought, on a made-up machine; the robot that is found is a virtual Create in
// virtual time.
#include "hal/robot/reconnect.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(BackOff, BeginsAtOnceAndDoublesUpToItsLimit) {
  BackOff back_off;
  std::vector<rt::Duration> pauses(7);
  std::ranges::generate(pauses, [&] { return back_off.next(); });
  EXPECT_THAT(pauses,
              ElementsAre(milliseconds{0}, milliseconds{50}, milliseconds{100}, milliseconds{200},
                          milliseconds{400}, milliseconds{400}, milliseconds{400}));
}

TEST(MayReconnect, WhereTheLinkWasLostAndNotTheMode) {
  EXPECT_TRUE(may_reconnect(CycleEnd::hung_up));
  EXPECT_TRUE(may_reconnect(CycleEnd::link_lost));
  EXPECT_FALSE(may_reconnect(CycleEnd::asked));
  EXPECT_FALSE(may_reconnect(CycleEnd::mode_lost));
}

// A USB adapter, its ports and its time. Time passes only while reconnect() sleeps.
class ReconnectTest : public testing::Test {
 protected:
  ReconnectTest() {
    request_.port = {.kind = PortIdentity::Kind::usb,
                     .path = "/dev/ttyUSB0",
                     .usb_vendor_id = 0x0403,
                     .usb_product_id = 0x6001,
                     .usb_serial = "A1"};
    request_.baud = 57600;
    request_.surroundings = {
        .ports = [this] { return ports(); },
        .open = [this](const std::string& path, std::uint32_t baud) { return open(path, baud); },
        .now = [this] { return now_; },
        .sleep =
            [this](rt::Duration duration) {
              pass(duration);
              if (duration > longest_sleep_) longest_sleep_ = duration;
            }};
  }

  std::vector<PortInfo> ports() {
    looked_at_.push_back(elapsed());
    if (now_ < back_at_) return {};
    PortInfo port{.path = "/dev/ttyUSB1", .usb_serial = "A1"};
    port.usb_vendor_id = 0x0403;
    port.usb_product_id = 0x6001;
    return {port};
  }
  Result<OpenedPort> open(const std::string& path, std::uint32_t baud) {
    opened_.push_back(path);
    if (opened_.size() <= refusals_) return Failure{"no permission to open " + path};
    auto link = std::make_unique<sim::VirtualLink>(device_);
    EXPECT_FALSE(link->set_baud(baud));
    return OpenedPort{.stream = std::move(link), .remark = "a remark"};
  }
  void pass(rt::Duration duration) { now_ += duration; }
  rt::Duration elapsed() const { return now_ - rt::TimePoint{}; }

  sim::Device device_{sim::Parameters{}};
  ReconnectRequest request_;
  rt::TimePoint back_at_{};
  std::size_t refusals_ = 0;
  std::vector<rt::Duration> looked_at_;
  std::vector<std::string> opened_;
  rt::Duration longest_sleep_{0};

 private:
  rt::TimePoint now_{};
};

TEST_F(ReconnectTest, BringsARobotUpWhosePortIsThereAtOnce) {
  {
    const auto back = reconnect(request_);
    ASSERT_TRUE(back) << back.failure().message;
    EXPECT_EQ(back->path, "/dev/ttyUSB1");
    EXPECT_EQ(back->remark, "a remark");
    EXPECT_EQ(device_.mode(), oi::Mode::safe);
    EXPECT_EQ(elapsed(), std::chrono::seconds{0});
  }
  EXPECT_EQ(device_.mode(), oi::Mode::passive) << "it is a Robot like any other";
}

TEST_F(ReconnectTest, FindsAPortWithin400MillisecondsOfItsReturn) {
  back_at_ += milliseconds{7001};
  ASSERT_TRUE(reconnect(request_));
  EXPECT_EQ(looked_at_.front(), std::chrono::seconds{0});
  EXPECT_LE(looked_at_.back() - milliseconds{7001}, milliseconds{400});
  EXPECT_LE(looked_at_.size(), 22U) << "and does not look more often than it must";
}

TEST_F(ReconnectTest, TriesAgainWhereThePortIsNotReadyYet) {
  refusals_ = 3;  // until udev has set its permissions
  ASSERT_TRUE(reconnect(request_));
  EXPECT_EQ(opened_.size(), 4U);
  EXPECT_EQ(elapsed(), milliseconds{350});
}

TEST_F(ReconnectTest, GivesUpAndSaysWhatItTriedLast) {
  back_at_ += std::chrono::seconds{3600};
  request_.patience = std::chrono::seconds{5};
  const auto back = reconnect(request_);
  ASSERT_FALSE(back);
  EXPECT_GE(elapsed(), std::chrono::seconds{5});
  EXPECT_LE(elapsed(), milliseconds{5020});
  EXPECT_THAT(back.failure().message, HasSubstr("within 5 s: /dev/ttyUSB0 is not there"));
}

TEST_F(ReconnectTest, SaysWhyAPortThatIsBackCouldNotBeUsed) {
  refusals_ = 1000;
  request_.patience = std::chrono::seconds{2};
  const auto back = reconnect(request_);
  ASSERT_FALSE(back);
  EXPECT_THAT(back.failure().message, HasSubstr("no permission to open /dev/ttyUSB1"));
}

TEST_F(ReconnectTest, MayBeCancelledAtAnyTime) {
  back_at_ += std::chrono::seconds{3600};
  request_.robot.cancelled = [this] { return elapsed() >= milliseconds{1234}; };
  const auto back = reconnect(request_);
  ASSERT_FALSE(back);
  EXPECT_EQ(back.failure().code, std::errc::interrupted);
  EXPECT_LE(elapsed(), milliseconds{1254});
  EXPECT_LE(longest_sleep_, milliseconds{20});
}

// The robot may be off: finding its port is not enough.
TEST_F(ReconnectTest, EndsABringUpThatOutlastsItsPatience) {
  device_.press_power();
  request_.patience = std::chrono::seconds{2};
  request_.robot.cancelled = [this] {
    pass(milliseconds{20});  // how often a bring-up asks
    return false;
  };
  const auto back = reconnect(request_);
  ASSERT_FALSE(back);
  EXPECT_LE(elapsed(), milliseconds{2100});
  EXPECT_THAT(back.failure().message, HasSubstr("within 2 s"));
}

}  // namespace
}  // namespace cargobay::hal
