// The commonest faults of wiring and set-up that a virtual Create can have, each with the message
// that a new user is to find it by.
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/bring_up/bring_up.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/sim/robot/pins.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

struct Fault {
  std::string name{};
  std::string says{};  // what is wrong, in the message
  std::string help{};  // what to do
  sim::Parameters robot{};
  std::function<void(sim::Device&, sim::VirtualLink&)> prepare{};
};

std::vector<Fault> faults() {
  using sim::Device;
  using sim::VirtualLink;
  return {
      {.name = "the robot is off",
       .says = "the robot is silent at all its rates",
       .help = "is it switched on",
       .robot = {.power_on = sim::PowerOn::never}},
      {.name = "off, on its charger",
       .says = "the robot sends text at 57600 baud (bat: ",
       .help = "press its power button, and unplug the charger",
       .robot = {.power_on = sim::PowerOn::never},
       .prepare = [](Device& device, VirtualLink&) { device.inputs().charger = true; }},
      {.name = "TX and RX swapped",
       .says = "the robot is silent at all its rates",
       .help = "are TX and RX the right way round",
       .prepare =
           [](Device&, VirtualLink& link) {
             link.cable().faults_to_host().unplugged = true;
             link.cable().faults_to_robot().unplugged = true;
           }},
      {.name = "the wire to the robot is broken",
       .says = "the robot is silent at all its rates",
       .help = "are TX and RX the right way round",
       .prepare = [](Device&,
                     VirtualLink& link) { link.cable().faults_to_robot().unplugged = true; }},
      {.name = "no common ground, or no level shifter",
       .says = "baud but no whole frame at ",
       .help = "check ground, level shifter",
       .prepare =
           [](Device&, VirtualLink& link) {
             link.cable().faults_to_host().bytes.flipped = 0.4;
             link.cable().faults_to_host().bytes.lost = 0.2;
           }},
      {.name = "the charger is plugged in",
       .says = "stays in passive mode instead of safe",
       .help = "unplug the charger",
       .prepare = [](Device& device, VirtualLink&) { device.inputs().charger = true; }},
      {.name = "a wheel hangs in the air",
       .says = "stays in passive mode instead of safe",
       .help = "set it on its wheels",
       .prepare = [](Device& device, VirtualLink&) { device.inputs().wheel_drop_left = true; }},
  };
}

TEST(WiringFaults, AreNamedWithARemedy) {
  for (const Fault& fault : faults()) {
    sim::Device device{fault.robot};
    sim::VirtualLink link{device};
    if (fault.prepare) fault.prepare(device, link);
    const auto report = bring_up(link, {.packets = oi::kCreate.list(oi::FrameList::reading)});
    ASSERT_FALSE(report) << fault.name;
    const std::string& message = report.failure().message;
    std::printf("%s: %s\n", fault.name.c_str(), message.c_str());
    EXPECT_THAT(message, HasSubstr(fault.says)) << fault.name;
    EXPECT_THAT(message, HasSubstr(fault.help)) << fault.name;
  }
}

// The transistor is missing, or the line is inverted and nobody said so: the pulses go unnoticed,
// and the Baud command does their work.
TEST(WiringFaults, ABrcThatDoesNothingIsReportedByItsReplacement) {
  sim::Device device{sim::Parameters{}};
  sim::Device elsewhere{sim::Parameters{}};
  sim::Pins dead{[&](const std::function<void(sim::Device&)>& change) { change(elsewhere); }};
  sim::VirtualLink link{device};
  ASSERT_FALSE(link.set_baud(19200));
  const auto report = bring_up(
      link, {.packets = oi::kCreate.list(oi::FrameList::reading), .pins = {.brc = &dead.brc}});
  ASSERT_TRUE(report) << report.failure().message;
  EXPECT_EQ(report->rate_change, RateChange::command);
}

}  // namespace
}  // namespace cargobay::hal
