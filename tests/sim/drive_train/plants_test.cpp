#include "hal/sim/drive_train/plants.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace cargobay::hal::sim {
namespace {

WheelParameters made_of(const std::string& words) {
  WheelParameters parameters;
  EXPECT_EQ(set_plant(words, parameters), "") << words;
  return parameters;
}
std::string complaint(const std::string& words) {
  WheelParameters parameters;
  const std::string wrong = set_plant(words, parameters);
  EXPECT_EQ(parameters, WheelParameters{}) << words << " has changed something";
  return wrong;
}

TEST(Plants, HaveNamesOfTheirOwnAndValuesInRange) {
  std::set<std::string_view> names;
  for (const Plant& plant : plants()) {
    EXPECT_TRUE(names.insert(plant.name).second) << plant.name;
    EXPECT_EQ(plant_name(plant.parameters), plant.name);
    EXPECT_FALSE(plant.meaning.empty());
    WheelParameters again;
    for (const PlantValue& value : plant_values()) {
      const std::string word = value_of(value, plant.parameters);
      EXPECT_EQ(set_value(value, word, again), "")
          << plant.name << " " << value.name << " " << word;
    }
    EXPECT_EQ(again, plant.parameters) << plant.name << " has something that is not a value";
  }
  for (const char* name :
       {"default", "ideal", "quick", "slow", "heavy", "dead-time", "ramp", "coarse", "fine-steps",
        "weak", "strong", "carpet", "sticky", "counting", "quadrature"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
}

TEST(Plants, TakeSingleValuesOnTop) {
  EXPECT_EQ(made_of("slow").lag_s, 0.25);
  const WheelParameters both = made_of("slow dead-time 0.06 gain-left 0.7");
  EXPECT_EQ(both.lag_s, 0.25);
  EXPECT_EQ(both.dead_time_s, 0.06);
  EXPECT_EQ(both.gain_left, 0.7);
  EXPECT_EQ(plant_name(both), std::nullopt);
  EXPECT_EQ(made_of("response counting lag 0.15 gain-left 1 gain-right 1"), made_of("counting"));
  EXPECT_EQ(made_of("sign true"), made_of("quadrature"));
  EXPECT_EQ(made_of(""), WheelParameters{});
}

// Some are a value too.
TEST(Plants, AreToldFromValuesOfTheSameName) {
  EXPECT_EQ(made_of("ramp").ramp_mm_s2, 300.0);
  EXPECT_EQ(made_of("ramp 500").ramp_mm_s2, 500.0);
  EXPECT_EQ(made_of("dead-time dead-time 0.02").dead_time_s, 0.02);
  EXPECT_EQ(made_of("ramp lag 0.2").ramp_mm_s2, 300.0);
  EXPECT_EQ(made_of("ramp 500 lag 0.2").lag_s, 0.2);
}

TEST(Plants, LeaveWheelBaseAndEncodersAlone) {
  WheelParameters parameters{.counts_per_mm = 2.25, .wheel_base_mm = 235.0};
  EXPECT_EQ(set_plant("slow", parameters), "");
  EXPECT_EQ(parameters.lag_s, 0.25);
  EXPECT_EQ(parameters.counts_per_mm, 2.25);
  EXPECT_EQ(parameters.wheel_base_mm, 235.0);
  EXPECT_EQ(plant_name(parameters), "slow");
}

TEST(Plants, SayWhatWasProbablyMeant) {
  EXPECT_EQ(complaint("lag 100"), "lag is in seconds, 0.001 to 1; milliseconds? did you mean 0.1");
  EXPECT_EQ(complaint("dead-time 60"),
            "dead-time is in seconds, 0 to 0.5; milliseconds? did you mean 0.06");
  EXPECT_EQ(complaint("ramp 0.3"),
            "ramp is in mm/s^2, 0, or 10 to 100000; m/s^2? did you mean 300");
  EXPECT_EQ(complaint("gain-left 94"),
            "gain-left is a part of 1, 0.1 to 1.5; percent? did you mean 0.94");
  EXPECT_EQ(complaint("slip-right 3"),
            "slip-right is a part of 1, 0 to 1; percent? did you mean 0.03");
  EXPECT_EQ(complaint("wheel-base 0.258"),
            "wheel-base is in mm, 50 to 1000; metres? did you mean 258");
  EXPECT_EQ(complaint("step 0.0285"),
            "step is in mm/s, 0, or 0.1 to 250; metres per second? did you mean 28.5");
}

TEST(Plants, RefuseWhatIsOutOfRangeOrNotAValue) {
  for (const PlantValue& value : plant_values()) {
    const std::string name{value.name};
    EXPECT_TRUE(complaint("lag 0.2 " + name).starts_with(name + " is "));
    for (const char* word : {"nan", "-nan", "inf", "1e999", "x", "0x10", "1,5", "-1"}) {
      const std::string wrong = complaint(name + " " + word);
      EXPECT_TRUE(wrong.starts_with(name + " is ")) << wrong;
      EXPECT_NE(wrong.find(range_of(value)), std::string::npos) << wrong;
    }
    if (!value.is_number()) continue;
    WheelParameters parameters;
    EXPECT_EQ(set_value(value, std::to_string(value.range.least), parameters), "") << name;
    EXPECT_EQ(set_value(value, std::to_string(value.range.most), parameters), "") << name;
    EXPECT_NE(complaint(name + " " + std::to_string(value.range.most * 1.01)), "") << name;
    EXPECT_NE(complaint(name + " " + std::to_string(value.range.least - 0.0009)), "") << name;
  }
  EXPECT_TRUE(complaint("fast").starts_with("unknown plant or value 'fast'; the plants are: "));
  EXPECT_TRUE(complaint("slow quick").starts_with("unknown plant or value 'quick'"));
}

}  // namespace
}  // namespace cargobay::hal::sim
