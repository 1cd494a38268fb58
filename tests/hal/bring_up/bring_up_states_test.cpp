// Bring-up from every state a robot may be found in, in virtual time.
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/sensing/frame_lists.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/sim/robot/pins.hpp"
#include "hal/stream/spaced_stream.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

enum class Wired { serial, brc, brc_and_power };

struct Found {
  std::string name{};
  sim::Parameters robot{};
  std::function<void(sim::Device&, sim::VirtualLink&)> prepare{};
  oi::Mode mode = oi::Mode::safe;
  bool off = false;  // only a toggle helps
};

void say(sim::VirtualLink& link, std::vector<std::uint8_t> bytes) {
  (void)link.write(bytes);
  link.advance(milliseconds{100});
}

std::vector<Found> states() {
  using sim::Device;
  using sim::VirtualLink;
  const auto rate = [](std::uint32_t baud) { return sim::Parameters{.boot_baud = baud}; };
  const auto in_mode = [](const std::vector<std::uint8_t>& bytes) {
    return [bytes](Device&, VirtualLink& link) { say(link, bytes); };
  };
  const auto charging = [](Device& device, VirtualLink& link) {
    device.inputs().charger = true;
    link.advance(milliseconds{2500});
  };
  const sim::Parameters off{.power_on = sim::PowerOn::never};
  return {
      {.name = "57600", .robot = rate(57600)},
      {.name = "19200", .robot = rate(19200)},
      {.name = "115200", .robot = rate(115200)},
      {.name = "38400", .robot = rate(38400)},
      {.name = "28800", .robot = rate(28800)},
      {.name = "14400", .robot = rate(14400)},
      {.name = "9600", .robot = rate(9600)},
      {.name = "4800", .robot = rate(4800)},
      {.name = "2400", .robot = rate(2400)},
      {.name = "1200", .robot = rate(1200)},
      {.name = "600", .robot = rate(600)},
      {.name = "300", .robot = rate(300)},
      {.name = "half a script at 9600",
       .robot = rate(9600),
       .prepare = in_mode({128, 152, 100, 137})},
      {.name = "off", .robot = off, .off = true},
      {.name = "booting", .robot = {.power_on = sim::PowerOn::now}},
      {.name = "charging", .prepare = charging, .mode = oi::Mode::passive},
      {.name = "charging, off",
       .robot = off,
       .prepare = charging,
       .mode = oi::Mode::passive,
       .off = true},
      {.name = "mid-stream", .prepare = in_mode({128, 131, 148, 3, 7, 19, 35})},
      {.name = "mid-stream at 19200",
       .robot = rate(19200),
       .prepare = in_mode({128, 131, 148, 3, 7, 19, 35})},
      {.name = "half a script", .prepare = in_mode({128, 152, 100, 137})},
      {.name = "half a script at 19200",
       .robot = rate(19200),
       .prepare = in_mode({128, 152, 100, 137})},
      {.name = "half a song", .prepare = in_mode({128, 140, 0, 16})},
      {.name = "in Safe", .prepare = in_mode({128, 131})},
      {.name = "in Full, driving", .prepare = in_mode({128, 132, 145, 0, 200, 0, 200})},
      {.name = "in Full at 115200",
       .robot = rate(115200),
       .prepare =
           [](Device&, VirtualLink& link) {
             say(link, {128});  // one by one: the robot needs a pause between them
             say(link, {132});
           }},
      {.name = "half a query of 255", .prepare = in_mode({128, 149, 255})},
  };
}

// A robot, the host's link to it at its own rate, and the pins.
class Bench {
 public:
  Bench(const Found& found, std::uint32_t wanted) : device{found.robot}, link{device} {
    if (found.prepare) found.prepare(device, link);
    EXPECT_FALSE(link.set_baud(wanted));
    device.on_drive = [this](const sim::DriveRecord& record) {
      if (record.command != sim::WheelSpeeds{}) ++moves;
    };
  }
  Result<BringUpReport> bring_up(Wired wired, oi::Mode mode) {
    RobotPins wires;
    if (wired != Wired::serial) wires.brc = &pins.brc;
    if (wired == Wired::brc_and_power) {
      wires.power_toggle = &pins.power_toggle;
      wires.power_sense = &pins.power_sense;
      wires.charging = &pins.charging;
    }
    return hal::bring_up(
        stream, {.mode = mode, .packets = oi::kCreate.list(oi::FrameList::reading), .pins = wires});
  }

  sim::Device device;
  sim::VirtualLink link;
  SpacedStream stream{link};
  // Between two bytes the robot's time stands still for the host, as in a call.
  sim::Pins pins{[this](const std::function<void(sim::Device&)>& change) { change(device); }};
  int moves = 0;
};

const char* name(Wired wired) {
  switch (wired) {
    case Wired::serial: return "serial";
    case Wired::brc: return "BRC";
    case Wired::brc_and_power: return "BRC, power";
  }
  return "";
}

TEST(BringUpStates, AllLeadToAStreamAtTheWantedRateAndMode) {
  std::printf("%-24s %-12s %7s %8s %-13s %s\n", "found", "wired", "wanted", "s", "rate by", "also");
  for (const Found& found : states()) {
    for (const Wired wired : {Wired::serial, Wired::brc, Wired::brc_and_power}) {
      for (const std::uint32_t wanted : {57600U, 19200U, 115200U}) {
        if (found.off && wired != Wired::brc_and_power) continue;
        SCOPED_TRACE(found.name + ", " + name(wired) + ", " + std::to_string(wanted));
        Bench bench{found, wanted};
        const auto report = bench.bring_up(wired, found.mode);
        ASSERT_TRUE(report) << report.failure().message;
        std::printf("%-24s %-12s %7u %8.2f %-13s%s%s\n", found.name.c_str(), name(wired), wanted,
                    rt::seconds(report->took), std::string{hal::name(report->rate_change)}.c_str(),
                    report->powered_on ? " power-on" : "",
                    report->resynchronised ? " resynchronised" : "");
        EXPECT_EQ(bench.device.baud(), wanted);
        EXPECT_EQ(bench.link.baud(), wanted);
        EXPECT_EQ(bench.device.mode(), found.mode);
        EXPECT_TRUE(bench.device.stream().running());
        EXPECT_EQ(report->powered_on, found.off);
        EXPECT_LT(report->took, std::chrono::seconds{15});
        EXPECT_TRUE(bench.device.brc_high());
        EXPECT_EQ(bench.device.commanded(), sim::WheelSpeeds{});
        EXPECT_EQ(bench.moves, 0) << "what is heard at a wrong rate moves nothing";
      }
    }
  }
}

// Notes when each level was set, by the robot's clock, and passes it on.
class WatchedPin final : public gpio::Output {
 public:
  WatchedPin(gpio::Output& pin, const sim::Device& device) : pin_{pin}, device_{device} {}
  std::error_code set(gpio::Level level) override {
    edges.emplace_back(device_.now(), level);
    return pin_.set(level);
  }
  std::vector<std::pair<rt::Duration, gpio::Level>> edges;

 private:
  gpio::Output& pin_;
  const sim::Device& device_;
};

TEST(BringUpStates, PulsesAreWhatTheManualAsksFor) {
  for (const sim::PowerOn found : {sim::PowerOn::never, sim::PowerOn::now}) {
    Bench bench{{.robot = {.power_on = found}}, 19200};
    WatchedPin brc{bench.pins.brc, bench.device};
    WatchedPin toggle{bench.pins.power_toggle, bench.device};
    const auto report = bring_up(
        bench.stream,
        {.packets = oi::kCreate.list(oi::FrameList::reading),
         .pins = {.brc = &brc, .power_toggle = &toggle, .power_sense = &bench.pins.power_sense}});
    ASSERT_TRUE(report) << report.failure().message;
    EXPECT_EQ(report->rate_change, RateChange::brc);
    const bool toggled = found == sim::PowerOn::never;
    ASSERT_EQ(toggle.edges.size(), toggled ? 4U : 0U);
    const rt::Duration powered = toggled ? toggle.edges[1].first : rt::Duration{0};
    ASSERT_EQ(brc.edges.size(), 7U) << "three pulses, once, and the release";
    EXPECT_GE(brc.edges[0].first - powered, std::chrono::seconds{2});
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(brc.edges[i].second, i % 2 == 0 ? gpio::Level::low : gpio::Level::high);
      const rt::Duration width = brc.edges[i + 1].first - brc.edges[i].first;
      EXPECT_GE(width, milliseconds{50});
      EXPECT_LE(width, milliseconds{500});
    }
    EXPECT_EQ(bench.device.counters().boots, 1U) << "and never off";
  }
}

// A robot that is on: a toggle without the indicator would switch it off, and is not needed.
TEST(BringUpStates, ARobotThatAnswersIsNotToggled) {
  Bench bench{{.robot = {.boot_baud = 115200}}, 19200};
  const auto report = bring_up(
      bench.stream, {.packets = oi::kCreate.list(oi::FrameList::reading),
                     .pins = {.brc = &bench.pins.brc, .power_toggle = &bench.pins.power_toggle}});
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_FALSE(report->powered_on);
  EXPECT_EQ(bench.device.counters().boots, 0U);
}

TEST(BringUpStates, AToggleWithoutIndicatorHelpsTooWhereTheRobotIsOff) {
  for (const std::uint32_t wanted : {57600U, 19200U}) {
    Bench bench{{.robot = {.power_on = sim::PowerOn::never}}, wanted};
    const auto report = bring_up(
        bench.stream, {.packets = oi::kCreate.list(oi::FrameList::reading),
                       .pins = {.brc = &bench.pins.brc, .power_toggle = &bench.pins.power_toggle}});
    ASSERT_TRUE(report) << report.failure().message;
    EXPECT_TRUE(report->powered_on);
    EXPECT_EQ(bench.device.counters().boots, 1U);
  }
}

// Deaf because it waits in a script: the first toggle switches it off, the second on.
TEST(BringUpStates, ARobotThatIsOnAndDeafIsSwitchedOffAndOn) {
  Bench bench{
      {.prepare = [](sim::Device&, sim::VirtualLink& link) { say(link, {128, 131, 155, 255}); }},
      57600};
  ASSERT_TRUE(bench.device.waiting());
  const auto report = bring_up(bench.stream, {.packets = oi::kCreate.list(oi::FrameList::reading),
                                              .pins = {.power_toggle = &bench.pins.power_toggle}});
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_EQ(bench.device.counters().boots, 1U);
}

// A program was killed in the middle of the pulses: the line is an input again, pulled high.
TEST(BringUpStates, HalfAPulseTrainBeforeDoesNotMatter) {
  for (const int pulses : {1, 2}) {
    Bench bench{{.prepare =
                     [pulses](sim::Device& device, sim::VirtualLink& link) {
                       link.advance(std::chrono::seconds{3});
                       for (int i = 0; i < pulses; ++i) {
                         device.set_brc(false);
                         link.advance(milliseconds{120});
                         device.set_brc(true);
                         link.advance(milliseconds{120});
                       }
                     }},
                19200};
    const auto report = bench.bring_up(Wired::brc, oi::Mode::safe);
    ASSERT_TRUE(report) << report.failure().message;
    EXPECT_EQ(bench.device.baud(), 19200U);
  }
}

// The pin is not connected: the Baud command does the job.
TEST(BringUpStates, ADeadBrcWireIsMadeUpForByTheBaudCommand) {
  Bench bench{{}, 19200};
  sim::Device elsewhere{sim::Parameters{}};
  sim::Pins dead{[&](const std::function<void(sim::Device&)>& change) { change(elsewhere); }};
  const auto report = bring_up(bench.link, {.packets = oi::kCreate.list(oi::FrameList::reading),
                                            .pins = {.brc = &dead.brc}});
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_EQ(report->rate_change, RateChange::command);
  EXPECT_EQ(bench.device.baud(), 19200U);
}

TEST(BringUpStates, AStreamThatFitsNowhereElseIsNoObstacle) {
  Bench bench{{.robot = {.boot_baud = 19200}}, 57600};
  oi::StreamList everything;
  ASSERT_TRUE(everything.push_back(oi::PacketId{6}));  // 52 bytes: not at 19200
  ASSERT_TRUE(everything.push_back(oi::PacketId::oi_mode));
  EXPECT_TRUE(bring_up(bench.link, {.packets = everything}));
}

class BringUpFails : public testing::Test {
 protected:
  static std::string complaint(const Result<BringUpReport>& report) {
    EXPECT_FALSE(report);
    const std::string text = report ? "" : report.failure().message;
    EXPECT_EQ(text.find('\n'), std::string::npos);
    EXPECT_THAT(text, HasSubstr("bring-up failed at step"));
    return text;
  }
};

TEST_F(BringUpFails, QuotesTheTextOfARobotThatIsOffOnItsCharger) {
  Bench bench{{.robot = {.power_on = sim::PowerOn::never}}, 57600};
  bench.device.inputs().charger = true;
  const std::string text = complaint(bench.bring_up(Wired::serial, oi::Mode::safe));
  EXPECT_THAT(text, HasSubstr("text at 57600 baud (bat: "));
  EXPECT_THAT(text, HasSubstr("power button"));
}

TEST_F(BringUpFails, SaysThatTheIndicatorTellsItIsOff) {
  Bench bench{{.robot = {.power_on = sim::PowerOn::never}}, 57600};
  EXPECT_THAT(complaint(bring_up(bench.link, {.packets = oi::kCreate.list(oi::FrameList::reading),
                                              .pins = {.power_sense = &bench.pins.power_sense}})),
              HasSubstr("power indicator is low"));
}

TEST_F(BringUpFails, SaysThatTheToggleDidNothing) {
  Bench bench{{.robot = {.power_on = sim::PowerOn::never}}, 57600};
  sim::Device elsewhere{sim::Parameters{}};
  sim::Pins dead{[&](const std::function<void(sim::Device&)>& change) { change(elsewhere); }};
  EXPECT_THAT(complaint(bring_up(bench.link, {.packets = oi::kCreate.list(oi::FrameList::reading),
                                              .pins = {.power_toggle = &dead.power_toggle,
                                                       .power_sense = &bench.pins.power_sense}})),
              HasSubstr("pins 3 and 8"));
}

TEST_F(BringUpFails, SaysThatTheChargerKeepsItFromSafe) {
  Bench bench{{}, 57600};
  bench.device.inputs().charger = true;
  EXPECT_THAT(complaint(bench.bring_up(Wired::serial, oi::Mode::safe)),
              HasSubstr("stays in passive mode instead of safe"));
}

class FailingPin final : public gpio::Output {
 public:
  std::error_code set(gpio::Level) override {
    return std::make_error_code(std::errc::no_such_device);
  }
};

TEST_F(BringUpFails, SaysThatTheLineFailed) {
  Bench bench{{}, 19200};
  FailingPin pin;
  EXPECT_THAT(complaint(bring_up(bench.link, {.packets = oi::kCreate.list(oi::FrameList::reading),
                                              .pins = {.brc = &pin}})),
              HasSubstr("No such device"));
}

// Unplugged at each instant of a bring-up that has everything to do.
TEST_F(BringUpFails, UnpluggedAtAnyTimeLeavesThePinsReleased) {
  for (milliseconds at{0}; at < std::chrono::seconds{6}; at += milliseconds{130}) {
    Bench bench{{.robot = {.power_on = sim::PowerOn::never}}, 19200};
    const rt::TimePoint gone = bench.link.now() + at;
    const auto report = bring_up(bench.link, {.packets = oi::kCreate.list(oi::FrameList::reading),
                                              .pins = {.brc = &bench.pins.brc,
                                                       .power_toggle = &bench.pins.power_toggle,
                                                       .power_sense = &bench.pins.power_sense},
                                              .cancelled = [&] {
                                                if (bench.link.now() >= gone) bench.link.hang_up();
                                                return false;
                                              }});
    if (report) continue;  // it was done before
    EXPECT_THAT(complaint(report), HasSubstr("hung up"));
    EXPECT_TRUE(bench.device.brc_high());
  }
}

TEST_F(BringUpFails, CancelledInAPulseReleasesThePin) {
  Bench bench{{}, 19200};
  int low = 0;
  const auto report =
      bring_up(bench.stream, {.packets = oi::kCreate.list(oi::FrameList::reading),
                              .pins = {.brc = &bench.pins.brc},
                              .cancelled = [&] { return !bench.device.brc_high() && ++low > 3; }});
  EXPECT_THAT(complaint(report), HasSubstr("interrupted"));
  EXPECT_EQ(report.failure().code, std::errc::operation_canceled);
  EXPECT_GT(low, 0);
  EXPECT_TRUE(bench.device.brc_high());
}

}  // namespace
}  // namespace cargobay::hal
