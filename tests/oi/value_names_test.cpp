// Each value of the Open Interface has one name, and each enumerator has a row.
#include "oi/value_names.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string_view>
#include <type_traits>
#include <utility>

#include <gtest/gtest.h>

#include "oi/text/argument_names.hpp"

namespace cargobay::oi {
namespace {

// How the compiler spells all these values, separated by commas: `cargobay::oi::Mode::off`, but
// `(cargobay::oi::Mode)4` if no enumerator has that value. One function for all: one for each value
// takes the compiler half a minute.
template <auto... kValues>
constexpr std::string_view spelled_values() {
  return __PRETTY_FUNCTION__;
}

template <typename Enum, int... kOffsets>
std::map<std::int32_t, std::string_view> enumerators(std::integer_sequence<int, kOffsets...>) {
  constexpr int kLowest = std::is_signed_v<std::underlying_type_t<Enum>> ? -128 : 0;
  std::string_view rest = spelled_values<static_cast<Enum>(kLowest + kOffsets)...>();
  constexpr std::string_view kBefore = "kValues = {";  // g++; clang has <
  rest.remove_prefix(rest.find(kBefore.substr(0, kBefore.size() - 1)) + kBefore.size());
  std::map<std::int32_t, std::string_view> all;
  for (int value = kLowest; value < kLowest + int{sizeof...(kOffsets)}; ++value) {
    std::string_view spelled = rest.substr(0, rest.find_first_of(",}>"));
    rest.remove_prefix(std::min(spelled.size() + std::string_view{", "}.size(), rest.size()));
    if (!spelled.starts_with('(')) all[value] = spelled.substr(spelled.rfind(':') + 1);
  }
  return all;
}

template <typename Enum>
class ValueNames : public testing::Test {};
using NamedEnums = testing::Types<Mode, StreamState, DemoNumber, ScriptEvent, Led, LowSideDriver,
                                  DigitalOutput, Bump, Overcurrent, Button, DigitalInput,
                                  ChargingSource, ChargingState, InfraredCharacter>;
TYPED_TEST_SUITE(ValueNames, NamedEnums);

TYPED_TEST(ValueNames, AreOneForEachEnumerator) {
  auto unnamed = enumerators<TypeParam>(std::make_integer_sequence<int, 256>{});
  std::set<std::string_view> names;
  for (const ValueName& each : kValueNames<TypeParam>) {
    EXPECT_TRUE(names.insert(each.name).second) << each.name << " names a second value";
    EXPECT_EQ(name(static_cast<TypeParam>(each.value)), each.name);
    EXPECT_EQ(value_named<TypeParam>(each.name), static_cast<TypeParam>(each.value));
    if (each.name.find(' ') == std::string_view::npos &&
        !std::is_same_v<TypeParam, ChargingState>) {
      EXPECT_EQ(unnamed[each.value], each.name);
    }
    EXPECT_EQ(unnamed.erase(each.value), 1U) << each.name << " is a second name, or of no value";
  }
  for (const auto& [value, spelled] : unnamed) ADD_FAILURE() << spelled << " has no name";
  EXPECT_FALSE(value_named<TypeParam>("unknown"));
}

TEST(NamedValues, AreTheOnlyOnesOfPacketsAndArguments) {
  for (const NamedPacket& each : kNamedPackets) {
    const PacketInfo& info = kCreate.packet(each.packet);
    for (const ValueName& value : each.names) {
      EXPECT_GE(info.max, each.bits ? 1 << value.value : value.value) << info.key << value.name;
    }
  }
  for (const CommandInfo& info : kCommands) {
    for (const ArgumentInfo& argument : info.arguments()) {
      std::set<std::string_view> names;
      for (const ValueName& each : value_names(argument)) {
        EXPECT_TRUE(names.insert(each.name).second) << each.name;
        EXPECT_EQ(named_value(argument, each.name), each.value);
        EXPECT_EQ(value_name(argument, each.value), each.name);
      }
    }
  }
}

// The characters of a Home Base are named by what lights the receiver.
TEST(HomeBaseBeams, AreThoseOfTheCharactersName) {
  for (unsigned raw = 0; raw < 256; ++raw) {
    const auto character = InfraredCharacter{static_cast<std::uint8_t>(raw)};
    const HomeBaseBeams beams = home_base_beams(character);
    const std::string_view called = name(character);
    const auto says = [called](std::string_view word) {
      return called.starts_with("home base") && called.find(word) != std::string_view::npos;
    };
    EXPECT_EQ(beams.has(HomeBaseBeam::force_field), says("force field")) << raw;
    EXPECT_EQ(beams.has(HomeBaseBeam::green_buoy), says("green")) << raw;
    EXPECT_EQ(beams.has(HomeBaseBeam::red_buoy), says("red")) << raw;
    if (beams.any()) {
      EXPECT_EQ(infrared_character(beams), character);
    }
  }
}

}  // namespace
}  // namespace cargobay::oi
