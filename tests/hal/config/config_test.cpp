#include "hal/config/config.hpp"

#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/setting_table.hpp"
#include "hal/config/settings.hpp"

namespace cargobay::hal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

std::string complaint(std::string_view text) {
  Config config;
  const auto read = read_config(text, "my.toml", config);
  EXPECT_FALSE(read) << text;
  if (read) return "";
  const std::string message = read.failure().message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  return message;
}

TEST(ConfigFile, HoldsPortPinsRobotAndRealtime) {
  Config config;
  const auto read = read_config(R"(
port = "/dev/serial0"
baud = 19200
[pins.brc]
chip = "pinctrl-bcm2835"
line = 17
active_low = true
[pins.power]
line = "GPIO27"
open_drain = true
bias = "pull_up"
[pins.power_sense]
line = 22
[robot]
distance_scale = 1.02
turn_scale = 0.98
wheel_base_mm = 260
lag_s = 0.12
acceleration_mm_s2 = 800
jerk_mm_s3 = 4000
remainder = "lost"
hold_heading = true
wheel_error = 0.01
wheel_base_error = 0.03
[realtime]
priority = 70
cpu = 3
require = true
)",
                                "my.toml", config);
  ASSERT_TRUE(read) << read.failure().message;
  EXPECT_EQ(config.port, "/dev/serial0");
  EXPECT_EQ(config.baud, 19200U);
  EXPECT_EQ(config.pins.brc.address.chip, "pinctrl-bcm2835");
  EXPECT_EQ(config.pins.brc.address.line, "17");
  EXPECT_EQ(config.pins.brc.polarity, gpio::Polarity::inverted);
  EXPECT_EQ(config.pins.power_toggle.address.line, "GPIO27");
  EXPECT_EQ(config.pins.power_toggle.drive, gpio::Drive::open_drain);
  EXPECT_EQ(config.pins.power_toggle.bias, gpio::Bias::pull_up);
  EXPECT_TRUE(config.pins.power_sense.wired());
  EXPECT_FALSE(config.pins.charging.wired());
  EXPECT_EQ(config.priority, 70);
  EXPECT_EQ(config.cpu, 3);
  EXPECT_TRUE(config.require_realtime);
  EXPECT_TRUE(config.hold_heading);
  CycleParameters parameters;
  apply(config, parameters);
  EXPECT_EQ(parameters.loop.estimator.wheel_base_mm, 260.0);
  EXPECT_EQ(parameters.loop.estimator.likely_lag_s, 0.12);
  EXPECT_EQ(parameters.odometry.distance_scale, 1.02);
  EXPECT_EQ(parameters.odometry.turn_scale, 0.98);
  EXPECT_EQ(parameters.odometry.wheel_error, 0.01);
  EXPECT_EQ(parameters.odometry.base_error, 0.03);
  EXPECT_TRUE(parameters.loop.course.hold_heading);
  EXPECT_EQ(parameters.loop.estimator.remainder, rt::Remainder::lost);
  EXPECT_EQ(parameters.loop.limits.acceleration_mm_s2, 800.0);
  EXPECT_EQ(parameters.loop.limits.jerk_mm_s3, 4000.0);
}

TEST(ConfigFile, LeavesWhatItDoesNotSay) {
  Config config;
  ASSERT_TRUE(read_config("port = 'first'\nbaud = 19200", "a", config));
  ASSERT_TRUE(read_config("port = 'second'", "b", config));
  EXPECT_EQ(config.port, "second");
  EXPECT_EQ(config.baud, 19200U);
}

TEST(ConfigFile, NamesLineAndNearestKey) {
  EXPECT_THAT(complaint("port = 'x'\nbuad = 19200"),
              AllOf(StartsWith("my.toml:2: "), HasSubstr("buad"), HasSubstr("did you mean baud?")));
  EXPECT_THAT(complaint("\n\n[pins.brc]\nactive-low = true"),
              AllOf(StartsWith("my.toml:4: "), HasSubstr("did you mean active_low?")));
  EXPECT_THAT(complaint("[pins.br]\nline = 1"), HasSubstr("did you mean brc?"));
}

TEST(ConfigFile, ListsTheKeysWhereNoneIsNear) {
  EXPECT_THAT(complaint("[realtime]\nquickly = true"), HasSubstr("priority, cpu, require"));
}

TEST(ConfigFile, SaysWhereAKeyBelongs) {
  EXPECT_THAT(complaint("[robot]\nport = '/dev/ttyUSB0'"),
              AllOf(StartsWith("my.toml:2: unknown key port"),
                    HasSubstr("it belongs at the top of the file, before any [table]")));
  EXPECT_THAT(complaint("lag_s = 0.1"), HasSubstr("it belongs under [robot]"));
  EXPECT_THAT(complaint("[robot]\npriority = 80"), HasSubstr("it belongs under [realtime]"));
  EXPECT_THAT(complaint("[brc]\nline = 17"), HasSubstr("it is a table: [pins.brc]"));
  EXPECT_THAT(complaint("line = 17"), HasSubstr("it belongs under a pin, such as [pins.brc]"));
  EXPECT_THAT(complaint("[pins]\nchip = 'x'"), HasSubstr("it belongs under a pin"));
}

TEST(ConfigFile, SaysHowALineIsWritten) {
  struct Line {
    std::string text;
    const char* says;
  };
  for (const Line& line : std::initializer_list<Line>{
           {"port = /dev/ttyUSB0", "text goes in quotes: port = \"/dev/ttyUSB0\""},
           {"port = /dev/ttyUSB0  # mine", "text goes in quotes: port = \"/dev/ttyUSB0\""},
           {"port: /dev/ttyUSB0", "have = between them: port = /dev/ttyUSB0"},
           {"port = \u201c/dev/ttyUSB0\u201d", "quotes are plain ones: port = \"/dev/ttyUSB0\""},
           {"port = \"/dev/ttyUSB0", "does its text end with a quote?"},
           {"port =", "its value is missing"},
           {"learnt = none", "text goes in quotes: learnt = \"none\""},
           {"[robot]\nremainder = lost", "text goes in quotes: remainder = \"lost\""},
           {"[robot]\nhold_heading = True", "that is written: hold_heading = true"},
           {"[robot]\nhold_heading = yes", "that is written: hold_heading = true"},
           {"[robot]\nhold_heading = off", "that is written: hold_heading = false"},
           {"[robot]\nwheel_base_mm = 258 mm", "alone: wheel_base_mm = 258"},
           {"[robot]\nwheel_base_mm = 258,5", "alone: wheel_base_mm = 258.5"},
           {"[robot\nwheel_base_mm = 258", "the name of a table goes in brackets: [robot]"},
           {"// the robot", "a comment begins with #"},
           {"[pins.brc]\nchip = pinctrl-bcm2835",
            "text goes in quotes: chip = \"pinctrl-bcm2835\""},
           {"baud = 57,600", "alone: baud = 57600"},
           {"baud = 057600", "alone: baud = 57600"},
           {"port = 'x' // mine", "a comment begins with #"},
           {"port = 'x' baud = 57600", "nothing but a comment may follow the text"},
           {"= 3", "the name before the = is missing"},
           {"port = 'a'\nport = 'b'", "further up: keep one of them"},
           {"baud = 57600\nbaud = 57600", "further up: keep one of them"},
           {"port", "a line is a [table], or: key = value"}}) {
    EXPECT_THAT(complaint(line.text), AllOf(HasSubstr("not TOML"), HasSubstr(line.says)))
        << line.text;
  }
}

TEST(ConfigFile, SaysThatNumbersHaveNoQuotes) {
  for (const char* const text :
       {"baud = '57600'", "[robot]\nwheel_base_mm = '258'", "[realtime]\npriority = '80'"}) {
    EXPECT_THAT(complaint(text), HasSubstr(", without quotes")) << text;
  }
  EXPECT_THAT(complaint("baud = 5"), Not(HasSubstr("quotes")));
}

// What the hint tells to write can be read.
TEST(ConfigFile, SaysNothingOfALineThatIsRight) {
  Config config;
  EXPECT_TRUE(
      read_config("port = \"/dev/ttyUSB0\"\n[robot]\nwheel_base_mm = 258.5\n"
                  "hold_heading = true\nremainder = \"lost\"",
                  "a", config));
}

TEST(ConfigFile, SaysWhatAValueIs) {
  EXPECT_THAT(complaint("baud = 12345"),
              HasSubstr("my.toml:1: baud must be one of the robot's rates"));
  complaint("baud = '19200'");
  complaint("baud = -1");
  complaint("baud = 4295024896");  // 57600 beyond 32 bits
  EXPECT_THAT(complaint("port = 1"), HasSubstr("text in quotes"));
  EXPECT_THAT(complaint("pins = 1"), HasSubstr("table"));
  EXPECT_THAT(complaint("[pins.brc]\nline = -1"), HasSubstr("my.toml:2: line must be"));
  complaint("[pins.brc]\nline = ''");
  complaint("[pins.brc]\nactive_low = 1");
  complaint("[pins.brc]\nbias = 'up'");
  complaint("[pins.power_sense]\nopen_drain = true");
  complaint("[robot]\nwheel_base_mm = 0");
  complaint("[robot]\nlag_s = nan");
  complaint("[robot]\njerk_mm_s3 = -1");
  complaint("[robot]\nremainder = 'kept'");
  EXPECT_THAT(complaint("[realtime]\npriority = 99"), HasSubstr("from 1 to 98"));
}

// Values in another unit, or that are just numbers; and the ends of the accepted ranges.
TEST(ConfigFile, RefusesWhatNoRobotIs) {
  struct Row {
    std::string key{};
    Range range{};
    std::string unit{};
  };
  const std::vector<Row> rows{{"wheel_base_mm", kWheelBaseMm, "mm, not metres"},
                              {"distance_scale", kScale, "1 if"},
                              {"turn_scale", kScale, "1 if"},
                              {"lag_s", kLagS, "in seconds, not ms"},
                              {"acceleration_mm_s2", kAccelerationMmS2, "in mm/s^2, not m/s^2"},
                              {"jerk_mm_s3", kJerkMmS3, "in mm/s^3, not m/s^3"}};
  for (const Row& row : rows) {
    const auto line = [&row](double value) {
      std::ostringstream text;
      text.precision(17);
      text << "[robot]\n" << row.key << " = " << std::showpoint << value;
      return text.str();
    };
    const auto refused = AllOf(StartsWith("my.toml:2: " + row.key + " must be a number from "),
                               HasSubstr(row.range.words()), HasSubstr(row.unit));
    for (const double value :
         {1e-300, 1e300, 0.0, -1.0, row.range.least * 0.999, row.range.most * 1.001})
      EXPECT_THAT(complaint(line(value)), refused) << value;
    EXPECT_THAT(complaint("[robot]\n" + row.key + " = nan"), refused);
    EXPECT_THAT(complaint("[robot]\n" + row.key + " = inf"), refused);
    for (const double value : {row.range.least, row.range.most}) {
      Config config;
      EXPECT_TRUE(read_config(line(value), "my.toml", config)) << line(value);
    }
  }
  for (const char* text : {"priority = 0", "priority = 99", "priority = 9223372036854775807",
                           "cpu = -1", "cpu = 1024"})
    complaint(std::string{"[realtime]\n"} + text);
}

// In the units that people think in.
TEST(ConfigFile, SaysWhatWasProbablyMeant) {
  struct Row {
    std::string line{};
    std::string meant{};
  };
  const std::vector<Row> rows{{"[robot]\nwheel_base_mm = 0.258", "metres? did you mean 258"},
                              {"[robot]\nwheel_base_mm = 25.8", "centimetres? did you mean 258"},
                              {"[robot]\nlag_s = 100", "milliseconds? did you mean 0.1"},
                              {"[robot]\nlag_s = 5", "milliseconds? did you mean 0.005"},
                              {"[robot]\nlag_s = 100000", "microseconds? did you mean 0.1"},
                              {"[robot]\nacceleration_mm_s2 = 0.5", "m/s^2? did you mean 500"},
                              {"[robot]\nacceleration_mm_s2 = 1", "m/s^2? did you mean 1000"},
                              {"[robot]\njerk_mm_s3 = 10", "m/s^3? did you mean 10000"},
                              {"[robot]\ndistance_scale = 102", "percent? did you mean 1.02"},
                              {"[robot]\nturn_scale = 98", "percent? did you mean 0.98"},
                              {"[robot]\nwheel_error = 2", "percent? did you mean 0.02"},
                              {"baud = 57", "thousands? did you mean 57600"},
                              {"baud = 115.2", "thousands? did you mean 115200"}};
  for (const Row& row : rows) EXPECT_THAT(complaint(row.line), HasSubstr("; " + row.meant));
  // Nothing sensible is near.
  for (const char* text : {"[robot]\nwheel_base_mm = -258", "[robot]\nlag_s = 0", "baud = 12345",
                           "[robot]\nturn_scale = 9000", "[robot]\nlag_s = nan"})
    EXPECT_THAT(complaint(text), testing::Not(HasSubstr("did you mean"))) << text;
}

// A setting that has a unit knows what it is taken for.
TEST(ConfigFile, KnowsTheMistakesOfEachUnit) {
  for (const Setting& setting : settings()) {
    EXPECT_EQ(setting.unit.empty() && setting.not_unit.empty(), setting.mistakes.empty())
        << setting.key;
    for (const Mistake& mistake : setting.mistakes) {
      // Something within the range would be out of it in that unit.
      const Range range = *setting.range;
      const double middle =
          range.least > 0.0 ? std::sqrt(range.least * range.most) : range.most / 2.0;
      EXPECT_THAT(likely_meaning(*setting.range, setting.mistakes, middle / mistake.factor),
                  HasSubstr("did you mean"))
          << setting.key;
    }
  }
}

TEST(ConfigFile, SaysWhereItIsNoToml) {
  EXPECT_THAT(complaint("port = 'x'\nbaud ="), HasSubstr("my.toml:2: not TOML"));
  // The parser asserts that this cannot be.
  EXPECT_THAT(complaint("port = 'x'\n[:]"), HasSubstr("my.toml:2: not TOML"));
}

TEST(ConfigFile, SaysThatItCannotBeRead) {
  for (const char* file : {"/no/such/file.toml", "/tmp"}) {
    const auto config = load_config(file);
    ASSERT_FALSE(config) << file;
    EXPECT_THAT(config.failure().message, HasSubstr(file));
  }
}

TEST(ConfigFile, IsWhatTheWiringPageShows) {
  std::ifstream file{CARGOBAY_SOURCE_DIR "/docs/wiring.md"};
  const std::string page{std::istreambuf_iterator<char>{file}, std::istreambuf_iterator<char>{}};
  const std::string begin = "```toml\n";
  const std::size_t at = page.find(begin);
  ASSERT_NE(at, std::string::npos);
  const std::size_t from = at + begin.size();
  Config config;
  const auto read =
      read_config(page.substr(from, page.find("```", from) - from), "docs/wiring.md", config);
  ASSERT_TRUE(read) << read.failure().message;
  EXPECT_TRUE(config.pins.brc.wired());
  EXPECT_EQ(config.pins.brc.polarity, gpio::Polarity::inverted);
  EXPECT_EQ(config.pins.power_toggle.polarity, gpio::Polarity::direct);
}

TEST(ConfigFile, MayBeEmpty) { EXPECT_TRUE(load_config("/dev/null")); }

}  // namespace
}  // namespace cargobay::hal
