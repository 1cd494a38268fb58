// JSON that is written by hand is JSON.
#include "hal/json_object.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace cargobay::hal {
namespace {

using nlohmann::json;

TEST(JsonObject, IsReadBackAsItWas) {
  JsonObject inner;
  inner.number("third", 1.0 / 3.0);
  JsonObject object;
  object.text("text", "a \"b\" \\ \n\x01 \xc3\xa9")
      .number("least", std::numeric_limits<std::int64_t>::min())
      .number("most", std::numeric_limits<std::uint64_t>::max())
      .number("small", 5e-324)
      .thousandths("short", 1.23456)
      .truth("yes", true)
      .object("inner", std::move(inner))
      .raw("list", JsonArray{}.text("x").raw("1").take());
  const json read = json::parse(object.take());
  EXPECT_EQ(read["text"], "a \"b\" \\ \n\x01 \xc3\xa9");
  EXPECT_EQ(read["least"], std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(read["most"], std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(read["small"], 5e-324);
  EXPECT_EQ(read["short"], 1.235);
  EXPECT_EQ(read["yes"], true);
  EXPECT_EQ(read["inner"]["third"], 1.0 / 3.0);
  EXPECT_EQ(read["list"], json::parse(R"(["x",1])"));
}

TEST(JsonObject, HasNoNumberForWhatIsNone) {
  JsonObject object;
  object.number("nan", std::numeric_limits<double>::quiet_NaN())
      .number("inf", std::numeric_limits<float>::infinity())
      .thousandths("short", -std::numeric_limits<double>::infinity());
  EXPECT_EQ(object.take(), R"({"nan":null,"inf":null,"short":null})");
  EXPECT_EQ(JsonObject{}.take(), "{}");
  EXPECT_EQ(JsonArray{}.take(), "[]");
}

TEST(JsonObject, HasThousandthsOfAnyNumber) {
  constexpr double kMost = std::numeric_limits<double>::max();
  JsonObject object;
  object.thousandths("most", kMost).thousandths("least", -1e-9).thousandths("some", 1e6);
  const std::string text = object.take();
  EXPECT_EQ(json::parse(text)["most"], kMost);
  EXPECT_NE(text.find(R"("least":-0.000,"some":1000000.000)"), std::string::npos) << text;
}

TEST(JsonObject, ReplacesWhatIsNotUtf8) {
  for (const std::string wrong : {"\xff", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80"}) {
    const std::string text = json_text("a" + wrong + "b");
    ASSERT_TRUE(json::accept(text)) << text;
    EXPECT_NE(text.find("\xEF\xBF\xBD"), std::string::npos);
  }
  EXPECT_EQ(json_text("\xf0\x9f\xa4\x96"), "\"\xf0\x9f\xa4\x96\"");
}

}  // namespace
}  // namespace cargobay::hal
