// `cargobay doctor` on the machine that runs the tests, whatever it is like.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/pty/command.hpp"

namespace cargobay::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(DoctorCommand, ExitsAsItsFindingsSay) {
  Command command{{"doctor", "--json", "-"}};
  const int code = command.exit_code();
  const json result = json::parse(command.out());
  EXPECT_EQ(code, result.at("ok") == true ? 0 : 1);
  EXPECT_GE(result.at("findings").size(), 6U);
  for (const json& finding : result.at("findings")) {
    const auto text = [&finding](const char* key) { return finding.at(key).get<std::string>(); };
    EXPECT_FALSE(text("what").empty());
    EXPECT_EQ(text("verdict") == "good", text("remedy").empty()) << finding;
  }
}

TEST(DoctorCommand, SaysWhatToDoAboutAPortThatIsNotThere) {
  Command command{{"doctor", "--port", "/dev/nosuch"}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.out(), HasSubstr("bad     port        there is no /dev/nosuch\n"));
  EXPECT_THAT(command.out(), HasSubstr("cargobay ports"));
}

// As user nobody, without rights or limits.
TEST(DoctorCommand, SaysHowToGetRights) {
  Command command{{"doctor"}, {.user = Command::Setup::User::nobody}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.out(), HasSubstr("bad     fifo        SCHED_FIFO refused"));
  EXPECT_THAT(command.out(), HasSubstr("rtprio"));
}

TEST(DoctorCommand, RefusesAPriorityThatIsNone) {
  EXPECT_EQ(Command({"doctor", "--priority", "99"}).exit_code(), 2);
}

}  // namespace
}  // namespace cargobay::test
