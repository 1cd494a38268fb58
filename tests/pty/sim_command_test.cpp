// `cargobay sim` as a user runs it.

#include <csignal>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::Bytes;
using hal::sim::test::SerialClient;
using testing::IsEmpty;

constexpr std::string_view kAnnouncement = "listening on ";

// The path it prints; empty where it prints something else.
std::string announced_path(Command& command) {
  (void)eventually(
      [&] { return !command.running() || command.out().find('\n') != std::string::npos; });
  const std::string& out = command.out();
  if (!out.starts_with(kAnnouncement)) return {};
  return out.substr(kAnnouncement.size(), out.find('\n') - kAnnouncement.size());
}

class SimSignalTest : public testing::TestWithParam<int> {};

TEST_P(SimSignalTest, EndsIt) {
  Command command{{"sim"}};
  const std::string path = announced_path(command);
  ASSERT_FALSE(path.empty()) << command.out() << command.err();
  {
    const SerialClient client{path};
    EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
  }
  EXPECT_TRUE(command.running());
  command.send(GetParam());
  EXPECT_EQ(command.exit_code(), 0);
  EXPECT_EQ(command.out(), std::string{kAnnouncement} + path + "\n");
  EXPECT_THAT(command.err(), IsEmpty());
}

TEST_P(SimSignalTest, TakesItsLinkAway) {
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  Command command{{"sim", "--link", link}};
  ASSERT_EQ(announced_path(command), link) << command.err();
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  const SerialClient client{link};
  EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
  command.send(GetParam());
  EXPECT_EQ(command.exit_code(), 0);
  EXPECT_FALSE(std::filesystem::is_symlink(link));
  EXPECT_EQ(command.out(), std::string{kAnnouncement} + link + "\n");
}

INSTANTIATE_TEST_SUITE_P(Each, SimSignalTest, testing::Values(SIGINT, SIGTERM),
                         [](const auto& tested) {
                           return std::string{"SIG"} + sigabbrev_np(tested.param);
                         });

TEST(SimCommand, RefusesALinkInThePlaceOfAFile) {
  const TemporaryFolder folder;
  const std::string file = folder.write("notes", "mine");
  Command command{{"sim", "--link", file}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("remove it or name another"));
  EXPECT_THAT(command.out(), IsEmpty());
  ASSERT_TRUE(std::filesystem::is_regular_file(file));
  EXPECT_EQ(contents(file), "mine");
}

TEST(SimCommand, RefusesALinkInAFolderThatIsMissing) {
  const TemporaryFolder folder;
  Command command{{"sim", "--link", folder.path("none/create")}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("name a path in a"));
}

TEST(SimCommand, RefusesARateTheRobotDoesNotHave) {
  Command command{{"sim", "--boot-baud", "12345"}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("choose 57600 or 19200"));
}

TEST(SimCommand, IsDrivenByDrive) {
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  Command robot{{"sim", "--link", link, "--remainder", "lost", "--checksum", "excluding",
                 "--boot-baud", "19200"}};
  ASSERT_EQ(announced_path(robot), link) << robot.err();
  Command command{{"drive", "--port", link, "--baud", "19200", "--duration", "0.6"}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  const SerialClient client{link, 19200};
  EXPECT_EQ(client.ask({142, 35}, 1), (Bytes{1})) << "left in Passive";
}

}  // namespace
}  // namespace cargobay::test
