// Each value of the Open Interface has one name, and each enumerator has a row.
#include "oi/value_names.hpp"

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

// How the compiler spells the enumerator of that value; empty if the enum has none: `(Mode)4`.
template <auto kValue>
constexpr std::string_view enumerator() {
  std::string_view spelled{__PRETTY_FUNCTION__};
  spelled.remove_prefix(spelled.find("kValue = ") + std::string_view{"kValue = "}.size());
  if (spelled.front() == '(') return {};
  spelled = spelled.substr(0, spelled.find_first_of(";]"));
  return spelled.substr(spelled.rfind(':') + 1);
}

template <typename Enum, int... kOffsets>
std::map<std::int32_t, std::string_view> enumerators(std::integer_sequence<int, kOffsets...>) {
  constexpr int kLowest = std::is_signed_v<std::underlying_type_t<Enum>> ? -128 : 0;
  std::map<std::int32_t, std::string_view> all{
      {kLowest + kOffsets, enumerator<static_cast<Enum>(kLowest + kOffsets)>()}...};
  std::erase_if(all, [](const auto& each) { return each.second.empty(); });
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
