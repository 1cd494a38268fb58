// Every command of the control socket with arguments that make no sense.
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/remote/control.hpp"
#include "hal/sim/remote/fault_command.hpp"
#include "tests/sim/robot.hpp"

namespace cargobay::hal::sim {
namespace {

using namespace test;  // NOLINT(google-build-using-namespace): this file's own helpers

// In place of a number or a name, or after a complete command.
const std::vector<std::string>& hostile_words() {
  static const std::vector<std::string> kWords{"nan",
                                               "-nan",
                                               "inf",
                                               "-inf",
                                               "1e999",
                                               "-1e999",
                                               "1e-999",
                                               "-1",
                                               "-0.5",
                                               "+1",
                                               "0x10",
                                               "1,5",
                                               "1.5.5",
                                               "18446744073709551616",
                                               "99999999999999999999999999999999",
                                               "2147483648",
                                               "--1",
                                               "ON",
                                               "on;off",
                                               "%n%s",
                                               "../../etc/passwd",
                                               "\x1b[2J",
                                               "\xff\xfe",
                                               std::string("\0", 1),
                                               std::string("1\0", 2),
                                               std::string(1000, '9'),
                                               std::string(1000, 'x')};
  return kWords;
}

struct StandingRobot : Robot {
  StandingRobot() { send({128, 132}); }
  std::string say(std::string_view line) { return control(line, link.cable()); }
  // In its place, with no command obeyed, and alive.
  bool stands() {
    const WorldPose pose = device.truth().pose;
    return pose.x_mm == 0.0 && pose.y_mm == 0.0 && pose.heading_rad == 0.0 &&
           device.commanded() == WheelSpeeds{} && device.truth().speeds == WheelSpeeds{} &&
           ask({142, 35}) == Bytes{3};
  }
};

// Refused, with one line that says what is wanted.
void expect_refusal(StandingRobot& robot, const std::string& line) {
  const std::string answer = robot.say(line);
  const bool says =
      answer.starts_with("error: the usage is '") || answer.starts_with("error: unknown ");
  EXPECT_TRUE(says) << line << ": " << answer;
  EXPECT_EQ(answer.find('\n'), std::string::npos);
}

// One line of them, with spaces between.
std::string line_of(std::initializer_list<std::string_view> words) {
  std::string line;
  for (const std::string_view word : words) {
    if (!line.empty()) line += ' ';
    line += word;
  }
  return line;
}

TEST(HostileControl, IsRefusedInEachCommandByWhatItShouldBe) {
  StandingRobot robot;
  for (const ControlInfo& info : controls()) {
    const std::string name{info.name};
    if (name == "fault") continue;  // below
    for (const std::string& word : hostile_words()) {
      expect_refusal(robot, line_of({name, word}));
      // Two numbers are wheel speeds.
      if (name != "turn-wheels") expect_refusal(robot, line_of({name, word, word}));
      // Three numbers are a place.
      if (name != "place") expect_refusal(robot, line_of({name, word, word, word}));
      expect_refusal(robot, name + word);
      expect_refusal(robot, line_of({word, name}));
    }
  }
  EXPECT_TRUE(robot.stands());
}

TEST(HostileControl, IsRefusedInEachFault) {
  StandingRobot robot;
  for (const FaultInfo& info : faults()) {
    const std::string name{info.name};
    if (name == "text") continue;  // takes any words, which the robot prints
    for (const std::string& word : hostile_words()) {
      expect_refusal(robot, line_of({"fault", name, word}));
      expect_refusal(robot, line_of({"fault", name, "1", word}));
      expect_refusal(robot, line_of({"fault", name, "1", "both", word}));
      expect_refusal(robot, line_of({"fault", name + word}));
    }
  }
  for (const char* part : {"fault wrong-baud 57600.5", "fault garbled-frame 1.5",
                           "fault junk-reading 0.5", "fault held 2.5 10"}) {
    expect_refusal(robot, part);
  }
  EXPECT_TRUE(robot.stands());
}

// The right kind of word, out of range.
TEST(HostileControl, IsRefusedBeyondEachRange) {
  StandingRobot robot;
  for (const char* line : {"press play 3600000.1",
                           "press play -0.001",
                           "ir 256",
                           "ir -1",
                           "digital-in 4 0",
                           "digital-in -1 0",
                           "digital-in 0 2",
                           "analog-in 1024",
                           "analog-in -1",
                           "battery 65535.1",
                           "battery -0.1",
                           "place 1000000.1 0 0",
                           "place 0 -1000000.1 0",
                           "place 0 0 36000.1",
                           "fault lost 1.0001",
                           "fault lost -0.0001",
                           "fault jitter 3600000.1",
                           "fault jitter -1",
                           "fault stalled-stream 3600000.1",
                           "fault held 1000001 1",
                           "fault held 1 3600000.1",
                           "fault garbled-frame 1000001",
                           "fault junk-reading -1",
                           "fault wrong-baud 57601"}) {
    expect_refusal(robot, line);
  }
  EXPECT_TRUE(robot.stands());
}

// At the edges of the ranges it goes on, and its state can still be read as numbers.
TEST(HostileControl, IsBorneAtTheEdgesOfTheRanges) {
  Robot robot;
  robot.send({128, 132});
  for (const char* line :
       {"press play 0", "press play 3600000", "ir 255", "analog-in 1023", "battery 65535",
        "battery 0", "battery 1500", "place 1000000 -1000000 36000", "fault held 1000000 3600000",
        "fault jitter 3600000", "fault jitter 0", "fault stalled-stream 3600000",
        "fault junk-reading 1000000", "fault none", "fault text"}) {
    EXPECT_EQ(control(line, robot.link.cable()), "ok") << line;
    robot.wait(100ms);
  }
  const std::string state = control("state", robot.link.cable());
  EXPECT_NE(state.find("\"x_mm\":1000000.000"), std::string::npos) << state;
  for (const char* word : {"nan", "inf"}) EXPECT_EQ(state.find(word), std::string::npos) << state;
}

}  // namespace
}  // namespace cargobay::hal::sim
