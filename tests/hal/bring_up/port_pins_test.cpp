// BRC and the power toggle on RTS and DTR of a USB cable, in virtual time.
#include <algorithm>
#include <chrono>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/bring_up/open_pins.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/stream/forwarding_stream.hpp"
#include "hal/trouble.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

using gpio::Polarity;
using testing::HasSubstr;
using ModemLine = ByteStream::ModemLine;

PinSetting on(const std::string& line, Polarity polarity = Polarity::direct) {
  return {.address = {.line = line}, .polarity = polarity};
}

// A robot whose pins hang on a cable's outputs. Opening a port asserts both, as the kernel does.
class PortPins : public testing::Test {
 protected:
  void wire(Polarity brc, ModemLine brc_line = ModemLine::rts) {
    link_.on_modem_line([this, brc, brc_line](ModemLine line, bool asserted) {
      const bool low_at_cable = asserted;
      if (line == brc_line) {
        device_.set_brc(low_at_cable != (brc == Polarity::direct));
      } else {
        device_.set_power_toggle(!low_at_cable);
      }
      ++changes_;
    });
    ASSERT_FALSE(link_.set_modem_line(ModemLine::rts, true));
    ASSERT_FALSE(link_.set_modem_line(ModemLine::dtr, true));
    changes_ = 0;
    ASSERT_FALSE(link_.set_baud(19200));
  }
  Result<BringUpReport> bring_up(const PinSettings& settings) {
    auto lines = open_pins(settings);
    if (!lines) return lines.failure();
    return hal::bring_up(
        link_, {.packets = oi::kCreate.list(oi::FrameList::reading), .pins = lines->pins()});
  }

  sim::Device device_{sim::Parameters{}};
  sim::VirtualLink link_{device_};
  int changes_ = 0;
};

TEST_F(PortPins, PulsesOnRtsBring19200) {
  for (const Polarity polarity : {Polarity::direct, Polarity::inverted}) {
    device_.brown_out();  // back to 57600
    device_.set_brc(true);
    wire(polarity);
    const auto report = bring_up({.brc = on("rts", polarity)});
    ASSERT_TRUE(report) << report.failure().message;
    EXPECT_EQ(report->rate_change, RateChange::brc);
    EXPECT_EQ(report->brc.pulses().size(), 6U);
    EXPECT_TRUE(device_.brc_high()) << "released";
    EXPECT_EQ(device_.baud(), 19200U);
  }
}

TEST_F(PortPins, TheOtherPolarityIsNotTakenForPulses) {
  wire(Polarity::inverted);
  const auto report = bring_up({.brc = on("rts")});
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_EQ(report->rate_change, RateChange::command) << "BRC was low between the pulses";
}

TEST_F(PortPins, DtrServesAsWell) {
  wire(Polarity::direct, ModemLine::dtr);
  const auto report = bring_up({.brc = on("DTR")});
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_EQ(report->rate_change, RateChange::brc);
}

TEST_F(PortPins, DtrSwitchesTheRobotOn) {
  device_.press_power();  // off
  wire(Polarity::direct);
  EXPECT_EQ(device_.power(), sim::Power::off);
  const auto report = bring_up({.brc = on("rts"), .power_toggle = on("dtr")});
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_TRUE(report->powered_on);
  EXPECT_EQ(report->rate_change, RateChange::brc);
  EXPECT_NE(device_.power(), sim::Power::off);
}

// Nothing drives the line of a robot that is off: it picks up what is sent beside it.
class Crosstalk final : public ForwardingStream {
 public:
  Crosstalk(ByteStream& line, const sim::Device& robot) : ForwardingStream{line}, robot_{robot} {}

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    return picked_up_.empty() ? stream().wait(deadline) : Wait::ready;
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    if (picked_up_.empty()) return stream().read(bytes);
    return rt::unchecked([&] {
      const std::size_t count = std::min(bytes.size(), picked_up_.size());
      const auto end = picked_up_.begin() + static_cast<std::ptrdiff_t>(count);
      std::copy(picked_up_.begin(), end, bytes.begin());
      picked_up_.erase(picked_up_.begin(), end);
      return Transfer{.count = count};
    });
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    rt::unchecked([&] {
      if (robot_.power() == sim::Power::off)
        picked_up_.insert(picked_up_.end(), bytes.begin(), bytes.end());
    });
    return stream().write(bytes);
  }
  void discard_input() override {
    picked_up_.clear();
    stream().discard_input();
  }

 private:
  const sim::Device& robot_;
  std::vector<std::uint8_t> picked_up_{};
};

TEST_F(PortPins, AnEchoDoesNotKeepARobotFromBeingSwitchedOn) {
  device_.press_power();  // off
  wire(Polarity::direct);
  ASSERT_FALSE(link_.set_baud(57600));
  link_.sleep(std::chrono::seconds{2});
  link_.discard_input();  // what it said when it was switched off would name it
  Crosstalk line{link_, device_};
  const auto lines = open_pins({.power_toggle = on("dtr")});
  ASSERT_TRUE(lines);
  const BringUpRequest request{.packets = oi::kCreate.list(oi::FrameList::reading),
                               .pins = lines->pins()};
  const auto report = hal::bring_up(line, request);
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_TRUE(report->powered_on);
}

TEST_F(PortPins, AreReleasedAtTheBeginning) {
  wire(Polarity::direct);
  EXPECT_FALSE(device_.brc_high()) << "as the kernel opened the port";
  ASSERT_FALSE(link_.set_baud(57600));
  const auto report = bring_up({.brc = on("rts")});
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_EQ(report->brc.count, 0U) << "no pulses at this rate";
  EXPECT_TRUE(device_.brc_high());
}

TEST_F(PortPins, APortWithoutThemIsRefusedWithAWayOut) {
  ASSERT_FALSE(link_.set_baud(19200));
  const auto report = bring_up({.brc = on("rts")});
  ASSERT_FALSE(report);
  EXPECT_EQ(device_.counters().bytes_received, 0U) << "the robot is as it was found";
  EXPECT_EQ(report.failure().code, Trouble::pin);
  EXPECT_THAT(report.failure().message, HasSubstr("RTS or DTR of the port cannot be set"));
  EXPECT_THAT(report.failure().message, HasSubstr("a pseudo-terminal has none"));
}

TEST_F(PortPins, SettingsThatCannotWorkAreRefused) {
  wire(Polarity::direct);
  const auto complaint = [this](const PinSettings& settings) {
    const auto report = bring_up(settings);
    EXPECT_FALSE(report);
    return report ? "" : report.failure().message;
  };
  EXPECT_THAT(complaint({.power_toggle = on("dtr", Polarity::inverted)}),
              HasSubstr("each time that the port is opened"));
  EXPECT_THAT(complaint({.brc = on("rts"), .power_toggle = on("rts")}), HasSubstr("both on rts"));
  PinSetting open_drain = on("rts");
  open_drain.drive = gpio::Drive::open_drain;
  EXPECT_THAT(complaint({.brc = open_drain}), HasSubstr("neither open drain nor bias"));
  EXPECT_EQ(changes_, 0) << "and no line was touched";
}

// With a chip it is a GPIO line of that name.
TEST_F(PortPins, OfAChipTheNameIsThatOfItsLine) {
  PinSetting of_chip = on("rts");
  of_chip.address.chip = "nosuch";
  EXPECT_FALSE(of_chip.modem_line());
  EXPECT_FALSE(on("17").modem_line());
  EXPECT_EQ(on("rts").modem_line(), ModemLine::rts);
}

}  // namespace
}  // namespace cargobay::hal
