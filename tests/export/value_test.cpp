// Values and objects as text.
#include "hal/columns/value.hpp"

#include <cstdlib>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "hal/export/json_schema.hpp"

namespace cargobay::hal {
namespace {

std::string in_json(const Value& value) {
  std::string out;
  append_json(out, value);
  return out;
}
std::string in_csv(const Value& value) {
  std::string out;
  append_csv(out, value);
  return out;
}

TEST(Value, HasTheSameDigitsInBothFormats) {
  for (const double number : {0.0, -0.0, 0.1, 1.0 / 3.0, 200.0, 1e300, 5e-324, -123456789.125}) {
    EXPECT_EQ(in_json(number), in_csv(number));
    EXPECT_EQ(std::strtod(in_json(number).c_str(), nullptr), number);
  }
  EXPECT_EQ(in_json(200.0), "200.0");
  EXPECT_EQ(in_json(std::int64_t{200}), "200");
  EXPECT_EQ(in_json(std::numeric_limits<std::int64_t>::min()), "-9223372036854775808");
}

TEST(Value, IsNotKnownIfItIsNotFinite) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kBeyond = std::numeric_limits<double>::infinity();
  for (const Value& value : {Value{}, Value{kNone}, Value{kBeyond}, Value{-kBeyond}}) {
    EXPECT_FALSE(known(value));
    EXPECT_EQ(in_json(value), "null");
    EXPECT_EQ(in_csv(value), "");
  }
  EXPECT_TRUE(known(Value{0.0}));
  EXPECT_TRUE(known(Value{std::string{}}));
}

TEST(Value, IsQuotedWhereItHasToBe) {
  EXPECT_EQ(in_json(std::string{"a \"b\" \\ \n"}), R"("a \"b\" \\ \u000a")");
  EXPECT_EQ(in_json(std::string{"\xFF"}), "\"\xEF\xBF\xBD\"");
  EXPECT_EQ(in_json(std::string{"\xC3\xBC"}), "\"\xC3\xBC\"");
  EXPECT_EQ(in_csv(std::string{"plain text; no more"}), "plain text; no more");
  EXPECT_EQ(in_csv(std::string{"one, \"two\"\nthree"}), "\"one, \"\"two\"\"\nthree\"");
}

TEST(Value, TellsNoWordsFromUnknownOnes) {
  using Words = std::vector<std::string_view>;
  EXPECT_EQ(in_json(Words{}), "[]");
  EXPECT_EQ(in_csv(Words{}), "none");
  EXPECT_EQ(in_json(Words{"left", "right"}), R"(["left","right"])");
  EXPECT_EQ(in_csv(Words{"left", "right"}), "left;right");
  EXPECT_EQ(in_csv(true), "1");
  EXPECT_EQ(in_json(false), "false");
}

TEST(MemberWriter, NestsMembersAndLeavesOutWhatIsNotKnown) {
  std::string out{"{"};
  MemberWriter object{out};
  object.put("a.unknown", {});
  object.put("a.left", std::int64_t{1});
  object.put("a.right", std::int64_t{2});
  object.put("b.left", std::int64_t{3});
  object.put("c", std::string{"d"});
  object.put("e", {});
  object.put("f.g", true);
  object.end();
  EXPECT_EQ(out, R"({"a":{"left":1,"right":2},"b":{"left":3},"c":"d","f":{"g":true})");
}

TEST(MemberWriter, GoesOnInAnObject) {
  std::string members;
  MemberWriter more{members};
  more.put("a.b", std::int64_t{1});
  more.put("c", std::int64_t{2});
  more.end();
  EXPECT_EQ(members, R"(,"a":{"b":1},"c":2)");
}

TEST(JsonSchema, HasTypesUnitsAndMeanings) {
  using Kind = ColumnInfo::Kind;
  const ColumnInfo number{"speed.left", Kind::number, "mm/s", "How fast"};
  const ColumnInfo words{"names", Kind::words, "", "Which"};
  const auto schema = nlohmann::json::parse(
      json_schema({.name = "things", .meaning = "All of them", .columns = {&number, &words}}));
  EXPECT_EQ(schema.at("title"), "cargobay.things");
  EXPECT_EQ(schema.at("type"), "object");
  const auto& speed = schema.at("properties").at("speed");
  EXPECT_EQ(speed.at("type"), "object");
  EXPECT_EQ(speed.at("properties").at("left").at("type"), "number");
  EXPECT_EQ(speed.at("properties").at("left").at("description"), "How fast [mm/s]");
  EXPECT_EQ(schema.at("properties").at("names").at("items").at("type"), "string");
}

}  // namespace
}  // namespace cargobay::hal
