// Each default, range and bound that the header, the manual page and the shipped configuration
// state is the code's: read from their text, and compared with the constant that the code uses.

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/config/settings.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_outlets.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/guard/guard.hpp"
#include "hal/sim/drive_train/plants.hpp"
#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/robot/device.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"
#include "rt/realtime.hpp"
#include "rt/slew_limiter.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::duration;

std::string text_of(const std::string& file) {
  std::ifstream stream{CARGOBAY_SOURCE_DIR "/" + file};
  EXPECT_TRUE(stream) << file;
  return {std::istreambuf_iterator<char>{stream}, std::istreambuf_iterator<char>{}};
}

// As the header and the files write it.
std::string number(double value) {
  std::ostringstream text;
  text.precision(15);
  text << value;
  return text.str();
}

template <typename Unit>
double count(rt::Duration time) {
  return duration<double, Unit>{time}.count();
}

// A setting, in the words that the texts have for it.
struct Setting {
  std::string name{};
  std::optional<Range> range{};
  std::optional<double> by_default{};  // none: if left out, it is found out or absent
};

const ControlCycle::Parameters kCycle{};
const sim::Parameters kSim{};

std::vector<Setting> options() {
  const auto& loop = kCycle.loop;
  return {
      {"baud", {}, oi::kCreate.default_baud},
      {"priority", kPriority, rt::RealtimeRequest{}.priority},
      {"cpu", kCpu, {}},
      {"setpoint_lapse_ns", kSetpointLapseMs.times(1e6), count<std::nano>(kCycle.setpoint_lapse)},
      {"control_budget_ns", kControlBudgetUs.times(1e3), count<std::nano>(kCycle.control_budget)},
      {"control_overruns", kControlOverruns, kCycle.control_overruns_allowed},
      {"link_timeout_ns", kLinkTimeoutMs.times(1e6), count<std::nano>(kCycle.link_timeout)},
      {"guard_deadline_ns", kGuardDeadlineMs.times(1e6), count<std::nano>(GuardOptions{}.deadline)},
      {"acceleration_mm_s2", kAccelerationMmS2, loop.limits.acceleration_mm_s2},
      {"jerk_mm_s3", kJerkMmS3, {}},
      {"wheel_base_mm", kWheelBaseMm, loop.estimator.wheel_base_mm},
      {"distance_scale", kScale, kCycle.odometry.distance_scale},
      {"turn_scale", kScale, kCycle.odometry.turn_scale},
  };
}

std::vector<Setting> sim_options() {
  return {
      {"seed", {}, static_cast<double>(kSim.seed)},
      {"boot_baud", {}, kSim.boot_baud},
      {"lag_ns", kLagS.times(1e9), kSim.wheels.lag_s * 1e9},
      {"gain_left", sim::kGain, kSim.wheels.gain_left},
      {"gain_right", sim::kGain, kSim.wheels.gain_right},
      {"noise_mm_s", sim::kNoiseMmS, kSim.wheels.noise_mm_s},
      {"wheel_base_mm", kWheelBaseMm, kSim.wheels.wheel_base_mm},
  };
}

std::vector<Setting> file_keys() {
  std::vector<Setting> keys = options();
  std::erase_if(keys, [](const Setting& key) {
    // These are not in the file.
    static const std::set<std::string> kNot{"setpoint_lapse_ns", "control_budget_ns",
                                            "control_overruns", "link_timeout_ns",
                                            "guard_deadline_ns"};
    return kNot.contains(key.name);
  });
  keys.push_back({"lag_s", kLagS, kCycle.loop.estimator.likely_lag_s});
  const auto [slowest, fastest] = std::ranges::minmax(oi::kCreate.baud_rates);
  keys.front().range = Range{static_cast<double>(slowest), static_cast<double>(fastest)};
  return keys;
}

// The comment of each member of a struct of the header, on one line.
std::map<std::string, std::string> members(const std::string& name) {
  const std::string header = text_of("hal/c/cargobay.h");
  const std::size_t from = header.find("struct " + name + " {");
  const std::size_t to = header.find("\n};", from);
  EXPECT_NE(to, std::string::npos) << name;
  const std::string body = header.substr(from, to - from);
  const std::regex member{R"((\w+);\s*/\*\*<([^]*?)\*/)"};
  std::map<std::string, std::string> found;
  for (std::sregex_iterator i{body.begin(), body.end(), member}, end; i != end; ++i)
    found[(*i)[1]] = std::regex_replace((*i)[2].str(), std::regex{R"(\s+)"}, " ");
  return found;
}

void expect_states(const std::string& where, const std::string& text, const Setting& setting,
                   const std::string& before_default) {
  if (setting.range) {
    const std::regex stated{R"((^|[^\d.]))" + number(setting.range->least) + " to " +
                            number(setting.range->most) + R"((?![\d.]*\d))"};
    EXPECT_TRUE(std::regex_search(text, stated))
        << where << " " << setting.name << " does not state " << setting.range->words() << ": "
        << text;
  }
  if (!setting.by_default) return;
  const std::regex stated{before_default + number(*setting.by_default) + R"((?![\d.]*\d))"};
  EXPECT_TRUE(std::regex_search(text, stated))
      << where << " " << setting.name << " does not state its default "
      << number(*setting.by_default) << ": " << text;
}

void expect_members_state(const std::string& name, const std::vector<Setting>& settings) {
  const auto comments = members(name);
  std::set<std::string> known;
  for (const Setting& setting : settings) {
    known.insert(setting.name);
    ASSERT_TRUE(comments.contains(setting.name)) << name << " has no " << setting.name;
    expect_states(name, comments.at(setting.name), setting,
                  "(0: (the configuration's, or )?|after power-on: )");
  }
  // No other member may state a value that is not compared. Standard streams are below 3.
  for (const auto& [member, comment] : comments) {
    if (known.contains(member) || member == "port_fd" || member == "progress") continue;
    EXPECT_FALSE(std::regex_search(comment, std::regex{R"(\b[1-9]\d*(\.\d+)?\b)"}))
        << name << "." << member << " states a number that this test does not know: " << comment;
  }
}

TEST(StatedValues, OfTheOptionsInTheHeader) { expect_members_state("cargobay_options", options()); }

TEST(StatedValues, OfTheVirtualCreatesOptionsInTheHeader) {
  expect_members_state("cargobay_sim_options", sim_options());
}

TEST(StatedValues, OfTheManualPageOfTheConfiguration) {
  const std::string page = text_of("docs/man/cargobay.toml.5");
  for (const Setting& key : file_keys()) {
    const std::size_t from = page.find(".BR " + key.name + " ");
    ASSERT_NE(from, std::string::npos) << key.name;
    const std::string entry = page.substr(from, page.find("\n.TP", from) - from);
    expect_states("cargobay.toml(5)", entry, key, "Left out: ");
  }
}

TEST(StatedValues, OfTheShippedConfiguration) {
  const std::string file = text_of("examples/system/cargobay.toml");
  for (const Setting& key : file_keys()) {
    const std::regex line{"((?:\n# [^\n]*)+)\n#" + key.name + " = (\\S+)\n"};
    std::smatch found;
    ASSERT_TRUE(std::regex_search(file, found, line)) << key.name;
    const std::string comment = std::regex_replace(found[1].str(), std::regex{"\n# "}, " ");
    expect_states("cargobay.toml", comment, key, "Left out: ");
    // Removing the "#" changes nothing that has a default.
    if (key.by_default) {
      EXPECT_EQ(std::stod(found[2]), *key.by_default) << key.name;
    }
  }
}

// The row of a table whose first cell has `name` in it; empty if there is none.
std::string row_of(const std::string& tables, std::string_view name) {
  std::istringstream rows{tables};
  for (std::string row; std::getline(rows, row);) {
    const std::string cell = row.substr(0, row.find(" | "));
    if (row.starts_with("| ") && cell.find("`" + std::string{name} + "`") != std::string::npos)
      return row;
  }
  return {};
}

// The page of the virtual Create lists each plant, and each value with its range.
TEST(StatedValues, OfThePlantsOfTheVirtualCreate) {
  const std::string page = text_of("docs/virtual-create.md");
  const std::size_t plants = page.find("## Plants");
  const std::size_t values = page.find("The values of a plant", plants);
  ASSERT_NE(values, std::string::npos);
  for (const sim::Plant& plant : sim::plants())
    EXPECT_NE(row_of(page.substr(plants, values - plants), plant.name), "") << plant.name;
  for (const sim::PlantValue& value : sim::plant_values()) {
    const std::string row = row_of(page.substr(values), value.name);
    EXPECT_NE(row.find(sim::range_of(value, ", ")), std::string::npos) << value.name << ": " << row;
  }
}

// Sentences of the header that contain numbers.
TEST(StatedValues, OfTheSentencesOfTheHeader) {
  const std::string header =
      std::regex_replace(text_of("hal/c/cargobay.h"), std::regex{R"(\s+(\*(?!/)\s*)?)"}, " ");
  sim::Device device{kSim};
  sim::VirtualLink link{device};
  const std::size_t spare = std::make_unique<ControlCycle>(link, kCycle)->spare_bytes();
  ASSERT_FALSE(link.set_baud(19200));
  const std::size_t spare_when_slow = std::make_unique<ControlCycle>(link, kCycle)->spare_bytes();
  const std::string most = std::to_string(oi::kMaxWheelSpeed);
  const std::vector<std::string> sentences{
      "after half a second unless renewed",  // checked below
      "every " + number(count<std::milli>(oi::kTick)) + " ms",
      "a budget of " + number(count<std::milli>(kCycle.control_budget)) +
          " ms (`control_budget_ns`)",
      "-" + most + " to " + most + " each",
      "left_mm_s, right_mm_s -" + most + " to " + most + ".",
      "beyond " + most + " mm/s, the wheels stop",
      "The newest " + std::to_string(kMostEvents) + " are kept and",
      "in a queue of " + std::to_string(kMostRequests) + " and",
      "beside it: " + std::to_string(spare) + " bytes at 57600 baud, " +
          std::to_string(spare_when_slow) + " at 19200",
      "over " + number(count<std::milli>(kCycle.late_margin)) + " ms behind its time",
      "of the robot, " + number(count<std::milli>(oi::kTick)) + " ms each",
  };
  EXPECT_EQ(kCycle.setpoint_lapse, std::chrono::milliseconds{500}) << "half a second";
  for (const std::string& sentence : sentences)
    EXPECT_NE(header.find(sentence), std::string::npos) << "the header does not say: " << sentence;
}

}  // namespace
}  // namespace cargobay::hal
