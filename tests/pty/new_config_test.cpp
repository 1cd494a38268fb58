// A configuration file that is not there yet.

#include <csignal>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;

class NewConfigTest : public DriveTest {};

// Only a whole calibration, which takes most of a minute, would make the file.
TEST_F(NewConfigTest, IsMadeByCalibrate) {
  const TemporaryFolder folder;
  const std::string file = folder.path("new.toml");
  Command command{{"calibrate", "--port", port_, "--config", file}};
  ASSERT_TRUE(starts_to_move()) << command.err();
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 128 + SIGINT);
  EXPECT_THAT(command.err(), HasSubstr("is not there yet: it will be made"));
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_TRUE(stands_still());
}

TEST_F(NewConfigTest, IsRefusedByWhatOnlyReadsIt) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words : std::initializer_list<std::vector<std::string>>{
           {"drive"}, {"bringup"}, {"calibrate", "--write", folder.path("other.toml")}}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--port", port_, "--config", folder.path("new.toml")});
    Command command{all};
    EXPECT_EQ(command.exit_code(), 1) << words[0];
    EXPECT_THAT(command.err(), OneErrorLine("cannot read the configuration")) << words[0];
  }
}

}  // namespace
}  // namespace cargobay::test
