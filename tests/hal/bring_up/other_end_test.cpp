// Something else than a robot at the other end of the cable, in virtual time.
#include "hal/bring_up/other_end.hpp"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/bring_up/sensor_stream.hpp"
#include "hal/trouble.hpp"
#include "oi/stream_budget.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::Not;

// Talks at one rate; at any other, what it sends arrives as garbage.
class OtherEnd final : public ByteStream {
 public:
  explicit OtherEnd(std::uint32_t own_baud) : own_baud_{own_baud} {}

  // Answers what it was sent, if that came at its own rate.
  std::function<void(OtherEnd&, std::span<const std::uint8_t>)> answer{};
  // Says this every so often.
  std::string chatter{};
  rt::Duration every = std::chrono::seconds{1};

  void say(std::string_view text) {
    rt::TimePoint at = std::max(now_, sent_);
    for (const char c : text) {
      at += oi::wire_time(1, own_baud_);
      coming_.emplace_back(at, static_cast<std::uint8_t>(c));
    }
    sent_ = at;
  }
  void echo(std::span<const std::uint8_t> bytes) {
    say({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  }
  // A wire from TX to RX: at any rate.
  void loop_back() { loops_back_ = true; }

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    rt::unchecked([&] {
      while (now_ < deadline && !due()) pass(deadline);
    });
    return due() ? Wait::ready : Wait::timed_out;
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    return rt::unchecked([&] { return take(bytes); });
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    now_ += oi::wire_time(bytes.size(), baud_);
    rt::unchecked([&] {
      if (loops_back_) echo(bytes);
      if (answer && baud_ == own_baud_) answer(*this, bytes);
    });
    return {.count = bytes.size()};
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return now_; }
  std::uint32_t baud() const override { return baud_; }
  std::error_code set_baud(std::uint32_t baud) override {
    baud_ = baud;
    return {};
  }
  std::error_code set_wake_threshold(std::size_t) override { return {}; }
  void discard_input() override {
    while (due()) coming_.pop_front();
  }
  bool drain(rt::Duration) override { return true; }
  void sleep(rt::Duration duration) override { pass(now_ + duration); }

 private:
  Transfer take(std::span<std::uint8_t> bytes) {
    std::size_t count = 0;
    for (; count < bytes.size() && due(); coming_.pop_front()) {
      const std::uint8_t byte = coming_.front().second;
      const bool clear = baud_ == own_baud_ || loops_back_;
      bytes[count++] = clear ? byte : static_cast<std::uint8_t>((unsigned{byte} << 3U) ^ 0xe3U);
    }
    return {.count = count};
  }
  bool due() const { return !coming_.empty() && coming_.front().first <= now_; }
  void pass(rt::TimePoint until) {
    rt::TimePoint next = until;
    if (!coming_.empty()) next = std::min(next, coming_.front().first);
    if (!chatter.empty()) next = std::min(next, next_chatter_);
    now_ = std::max(now_, next);
    if (chatter.empty() || now_ < next_chatter_) return;
    say(chatter);
    next_chatter_ += every;
  }

  std::uint32_t own_baud_;
  std::uint32_t baud_ = 57600;
  bool loops_back_ = false;
  rt::TimePoint now_{std::chrono::seconds{1}};
  rt::TimePoint sent_{};
  rt::TimePoint next_chatter_{std::chrono::seconds{1}};
  std::deque<std::pair<rt::TimePoint, std::uint8_t>> coming_{};
};

struct Ended {
  std::string message;
  double seconds = 0.0;
  Parting left = Parting::unconfirmed;
};

Ended bring_up_there(OtherEnd& other, std::uint32_t wanted = 57600) {
  EXPECT_FALSE(other.set_baud(wanted));
  const rt::TimePoint began = other.now();
  Parting left = Parting::unconfirmed;
  const auto report =
      bring_up(other, {.packets = oi::kCreate.list(oi::FrameList::reading), .left = &left});
  EXPECT_FALSE(report);
  if (report) return {};
  EXPECT_EQ(report.failure().code, Trouble::silent);
  EXPECT_EQ(report.failure().message.find('\n'), std::string::npos);
  EXPECT_THAT(report.failure().message, Not(HasSubstr("charging")));
  return {report.failure().message, rt::seconds(other.now() - began), left};
}

// It prompts once, and again when it was typed at; it echoes what is typed.
TEST(OtherEnd, ALoginPromptIsNamedAsOne) {
  for (const std::uint32_t baud : {115200U, 57600U, 9600U}) {
    OtherEnd other{baud};
    other.say("\r\nDebian GNU/Linux 12 raspberrypi ttyAMA0\r\n\r\nraspberrypi login: ");
    other.answer = [](OtherEnd& self, std::span<const std::uint8_t> bytes) {
      self.echo(bytes);
      self.say("\r\nraspberrypi login: ");
    };
    const Ended ended = bring_up_there(other);
    EXPECT_THAT(ended.message,
                HasSubstr("a login prompt is at this port and no robot: it sends at " +
                          std::to_string(baud) + " baud (raspberrypi login:)"));
    EXPECT_THAT(ended.message, HasSubstr("cargobay ports"));
    EXPECT_EQ(ended.left, Parting::standing) << "no robot is there that may be moving";
    EXPECT_LT(ended.seconds, 5.0) << baud;
  }
}

TEST(OtherEnd, AConsoleThatPrintsNowAndThenIsNamedAsAKernel) {
  OtherEnd other{115200};
  other.chatter = "[ 1234.567890] usb 1-1: new high-speed USB device number 5\r\n";
  EXPECT_THAT(bring_up_there(other).message,
              HasSubstr("a computer's kernel is at this port and no robot: it sends at 115200"));
}

// Most receivers talk at 9600 or 4800 baud, for a part of each second.
TEST(OtherEnd, AGpsIsNamedAsOne) {
  for (const std::uint32_t baud : {4800U, 9600U, 38400U, 115200U, 57600U}) {
    OtherEnd other{baud};
    other.chatter =
        "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n"
        "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";
    const Ended ended = bring_up_there(other);
    EXPECT_THAT(ended.message,
                HasSubstr("a GPS receiver is at this port and no robot: it sends at " +
                          std::to_string(baud) + " baud ("));
  }
}

TEST(OtherEnd, TheEchoOfALoopbackPlugIsNamedAsOne) {
  for (const std::uint32_t wanted : {57600U, 19200U, 115200U}) {
    OtherEnd other{57600};
    other.loop_back();
    const Ended ended = bring_up_there(other, wanted);
    EXPECT_THAT(ended.message, HasSubstr("what is sent at " + std::to_string(wanted) +
                                         " baud comes back, and no robot answers"));
    EXPECT_THAT(ended.message, HasSubstr("loopback plug"));
    EXPECT_EQ(ended.left, Parting::unconfirmed) << "a robot may be on the wire as well";
    EXPECT_LT(ended.seconds, 5.0);
  }
}

TEST(OtherEnd, TextThatNothingKnownSendsIsNotTakenForTheRobots) {
  OtherEnd other{57600};
  other.chatter = "temperature 21.5 humidity 40\r\n";
  other.every = milliseconds{200};
  EXPECT_THAT(bring_up_there(other).message,
              HasSubstr("something sends text at 57600 baud (temperature 21.5 humidity 40) that is "
                        "not the robot's"));
}

const Failure kSilent{"no answer", Trouble::silent};

std::string named(OtherEnd& other) { return name_other_end(other, kSilent, {}).message; }

TEST(NameOtherEnd, SaysWhatABringUpWouldSay) {
  OtherEnd plug{57600};
  plug.loop_back();
  EXPECT_THAT(named(plug), HasSubstr("what is sent at 57600 baud comes back"));
  OtherEnd gps{57600};
  gps.chatter = "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n";
  EXPECT_THAT(named(gps), HasSubstr("a GPS receiver is at this port and no robot"));
  OtherEnd charging{57600};
  charging.chatter = "bat:   min 4  sec 12  mV 16325  mA 1248  deg-C 22\r\n";
  EXPECT_THAT(named(charging), HasSubstr("it is charging or switched off"));
  OtherEnd prompt{57600};
  prompt.answer = [](OtherEnd& self, std::span<const std::uint8_t>) { self.say("pi login: "); };
  EXPECT_THAT(named(prompt), HasSubstr("a login prompt is at this port and no robot"));
}

TEST(NameOtherEnd, FindsAStrangerAtAnotherRate) {
  for (const std::uint32_t baud : {115200U, 9600U, 4800U, 38400U, 19200U}) {
    OtherEnd gps{baud};
    gps.chatter =
        "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A\r\n"
        "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n";
    const rt::TimePoint began = gps.now();
    EXPECT_THAT(named(gps), HasSubstr("a GPS receiver is at this port and no robot: it sends at " +
                                      std::to_string(baud) + " baud ("));
    EXPECT_LT(gps.now() - began, milliseconds{8000});
    EXPECT_EQ(gps.baud(), 57600U) << "the port's own rate again";
  }
}

TEST(NameOtherEnd, FindsAConsoleAtAnotherRate) {
  OtherEnd kernel{115200};
  kernel.chatter = "[ 1234.567890] usb 1-1: new high-speed USB device number 5\r\n";
  EXPECT_THAT(named(kernel), HasSubstr("a computer's kernel is at this port and no robot: it sends "
                                       "at 115200 baud"));
}

// Bytes that are text at no rate, as from a cable without a ground.
TEST(NameOtherEnd, GivesUpOnNoise) {
  OtherEnd noise{57600};
  noise.chatter = "\x81\x02\xf3\x94";
  noise.every = milliseconds{100};
  const rt::TimePoint began = noise.now();
  EXPECT_EQ(named(noise), "no answer");
  EXPECT_LT(noise.now() - began, milliseconds{10000});
  EXPECT_EQ(noise.baud(), 57600U);
}

TEST(NameOtherEnd, LeavesOtherFailuresAndSilenceAsTheyAre) {
  OtherEnd silent{57600};
  const rt::TimePoint began = silent.now();
  EXPECT_EQ(named(silent), "no answer");
  EXPECT_LT(silent.now() - began, milliseconds{1500});
  OtherEnd plug{57600};
  plug.loop_back();
  EXPECT_EQ(name_other_end(plug, Failure{"no port", Trouble::hung_up}, {}).message, "no port");
  EXPECT_EQ(name_other_end(plug, kSilent, [] { return true; }).message, "no answer");
}

// The first byte of a question would be a value.
TEST(QuerySensors, DoesNotTakeItsEchoForAnAnswer) {
  OtherEnd plug{57600};
  plug.loop_back();
  const std::vector<oi::PacketId> packets{oi::PacketId::bumps_and_wheel_drops};
  const auto values = query_sensors(plug, packets);
  ASSERT_FALSE(values);
  EXPECT_EQ(values.failure().code, Trouble::silent);
  EXPECT_FALSE(SensorStream::open(plug, packets));
  OtherEnd console{57600};
  console.answer = [](OtherEnd& self, std::span<const std::uint8_t> bytes) {
    self.echo(bytes);
    self.say("\r\npi login: ");
  };
  EXPECT_FALSE(query_sensors(console, packets));
}

// A frame is full of zeros, and so is what frees a robot from half a command.
TEST(OtherEnd, AStreamThatGoesOnIsNotTakenForAnEcho) {
  OtherEnd other{57600};
  other.chatter = std::string{"\x13\x05\x1d\x00\x00\x19\x00", 7} + std::string(40, '\0');
  other.every = milliseconds{100};
  EXPECT_THAT(bring_up_there(other).message, HasSubstr("but no whole frame"));
}

}  // namespace
}  // namespace cargobay::hal
