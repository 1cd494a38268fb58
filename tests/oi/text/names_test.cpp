#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "oi/baud.hpp"
#include "oi/commands.hpp"
#include "oi/text/argument_names.hpp"
#include "oi/text/nearest_name.hpp"

namespace cargobay::oi {
namespace {

TEST(ValueNames, AreTheRatesOfTheBaudCodes) {
  const ArgumentInfo& code = kCommandInfo<129>.argument_slots[0];
  ASSERT_EQ(value_names(code).size(), kBaudRates.size());
  for (std::size_t i = 0; i < kBaudRates.size(); ++i)
    EXPECT_EQ(value_name(code, static_cast<std::int32_t>(i)), std::to_string(kBaudRates[i]));
}

TEST(ValueNames, AreThoseOfTheEnumerators) {
  const ArgumentInfo& event = kCommandInfo<158>.argument_slots[0];
  EXPECT_EQ(named_value(event, "cliff"), static_cast<int>(ScriptEvent::cliff));
  EXPECT_EQ(named_value(event, "no_home_base"), static_cast<int>(inverse(ScriptEvent::home_base)));
  for (int value = 1; value <= 22; ++value)
    EXPECT_EQ("no_" + std::string{value_name(event, value)}, value_name(event, -value));
  const ArgumentInfo& demo = kCommandInfo<136>.argument_slots[0];
  EXPECT_EQ(named_value(demo, "wimp"), static_cast<int>(DemoNumber::wimp));
  for (int value = -1; value <= 9; ++value) EXPECT_NE(value_name(demo, value), "");
}

TEST(NearestName, IsNearWithinAThirdOfTheLetters) {
  const auto nearest = [](std::string_view word) {
    NearestName name{word};
    for (const std::string_view candidate : {"play", "pause", "straight"}) name.consider(candidate);
    return std::string{name.name()};
  };
  EXPECT_EQ(nearest("plya"), "play");
  EXPECT_EQ(nearest("STRAIHGT"), "straight");
  EXPECT_EQ(nearest("strght"), "straight");
  EXPECT_EQ(nearest("paus"), "pause");
  EXPECT_EQ(nearest("xxxx"), "");
  EXPECT_EQ(nearest(""), "");
  EXPECT_EQ(nearest(std::string(200, 'p')), "");
}

}  // namespace
}  // namespace cargobay::oi
