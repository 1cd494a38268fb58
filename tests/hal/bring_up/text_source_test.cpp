// Whose lines are known.
#include "hal/bring_up/text_source.hpp"

#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

// All that a virtual Create prints: it boots, charges, sleeps and wakes.
std::vector<std::string> lines_of_the_robot() {
  sim::Device device{{.power_on = sim::PowerOn::now}};
  sim::VirtualLink link{device};
  link.advance(milliseconds{6000});
  device.press_power();
  link.advance(milliseconds{100});
  device.inputs().charger = true;
  link.advance(milliseconds{3000});
  device.press_power();
  link.advance(milliseconds{6000});
  std::vector<std::uint8_t> bytes(4096);
  bytes.resize(link.read(bytes).count);
  std::istringstream stream{std::string{bytes.begin(), bytes.end()}};
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) {
    while (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty()) lines.push_back(line);
  }
  return lines;
}

TEST(TextSource, KnowsEachLineOfTheRobot) {
  const std::vector<std::string> lines = lines_of_the_robot();
  EXPECT_GE(lines.size(), 10U);
  for (const std::string& line : lines) EXPECT_EQ(text_source(line), TextSource::robot) << line;
}

// As two programs that know such robots list them.
TEST(TextSource, KnowsTheRelativesOfTheRobot) {
  for (const char* const line :
       {"do-charging", "slept for 3 minutes, 2 seconds", "Roomba by iRobot!", "2005-07-14-1331-L",
        "bat:   min 3  sec 21  mV 15558  mA 1491  deg-C 24  ", "sec 21  mV 15558  mA -491"})
    EXPECT_EQ(text_source(line), TextSource::robot) << line;
}

TEST(TextSource, KnowsWhatElseMayBeThere) {
  const struct {
    const char* line;
    TextSource source;
  } lines[] = {
      {"raspberrypi login: ", TextSource::login_prompt},
      {"Debian GNU/Linux 12 robot ttyAMA0", TextSource::login_prompt},
      {"Ubuntu 24.04.1 LTS ttyS0", TextSource::login_prompt},
      {"Password: ", TextSource::login_prompt},
      {"Login incorrect", TextSource::login_prompt},
      {"-bash: \x80: command not found", TextSource::shell},
      {"pi@raspberrypi:~$ ", TextSource::shell},
      {"root@robot:/home/pi#", TextSource::shell},
      {"[    0.000000] Linux version 6.1.0-18-arm64", TextSource::kernel},
      {"1.234567] usb 1-1: new high-speed USB device", TextSource::kernel},
      {"[  OK  ] Started Serial Getty on ttyAMA0.", TextSource::kernel},
      {"U-Boot 2023.01+dfsg-2 (Jan 08 2023)", TextSource::boot_loader},
      {"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47", TextSource::gps},
      {"$GNRMC,,V,,,,,,,,,,N*4D", TextSource::gps},
      {"!AIVDM,1,1,,A,13aG?P0P00PD;88MD5MTDww@2<0L,0*23", TextSource::gps},
      {"1,08,0.9,545.4,M,46.9,M,,*47", TextSource::gps},
      {"NO CARRIER", TextSource::modem},
      {"+CREG: 1", TextSource::modem},
  };
  for (const auto& [line, source] : lines) {
    EXPECT_EQ(text_source(line), source) << line;
    EXPECT_TRUE(is_stranger(source));
    EXPECT_FALSE(describe(source).empty());
  }
}

TEST(TextSource, DoesNotGuess) {
  for (const char* const line :
       {"", "hello", "temperature 21.5", "OK", "min", "$", "$GPGGA", "$12.50, please", "a,b,c*zz",
        "2006-09-12", "costs 5 $", "#", "[ 12] x", "secure 7"}) {
    EXPECT_EQ(text_source(line), TextSource::unknown) << line;
  }
  EXPECT_EQ(prompt_source("bat:   min 0"), TextSource::unknown) << "it may still be damaged";
}

}  // namespace
}  // namespace cargobay::hal
