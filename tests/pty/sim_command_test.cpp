// `cargobay sim` as a user runs it.

#include <algorithm>
#include <csignal>

#include "control_client.hpp"
#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::Bytes;
using hal::sim::test::Caller;
using hal::sim::test::SerialClient;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::string_view kAnnouncement = "listening on ";

// The path that it prints; empty if it prints something else.
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

TEST(SimCommand, IsControlledThroughItsSocket) {
  const TemporaryFolder folder;
  const std::string socket = folder.path("control");
  Command command{{"sim", "--control", socket}};
  const std::string path = announced_path(command);
  ASSERT_FALSE(path.empty()) << command.err();
  const SerialClient client{path};
  EXPECT_EQ(client.ask({128, 131, 142, 35}, 1), (Bytes{2}));
  const Caller caller{socket};
  ASSERT_TRUE(caller.connected());
  EXPECT_EQ(caller.ask("wheeldrop left on"), "ok");
  EXPECT_TRUE(eventually(
      [&] { return caller.ask("state").find("\"mode\":\"passive\"") != std::string::npos; }));
  command.send(SIGTERM);
  EXPECT_EQ(command.exit_code(), 0);
  EXPECT_FALSE(std::filesystem::exists(socket));
}

TEST(SimCommand, ServesSeveralEachWithItsOwnNumber) {
  const TemporaryFolder folder;
  Command command{{"sim", "--count", "3", "--link", folder.path("create"), "--control",
                   folder.path("control"), "--trace", folder.path("way.SVG")}};
  ASSERT_TRUE(eventually([&] {
    return !command.running() || std::ranges::count(command.out(), '\n') == 3;
  })) << command.err();
  for (const char* number : {"0", "1", "2"}) {
    const std::string link = folder.path(std::string{"create."} + number);
    EXPECT_THAT(command.out(), HasSubstr("listening on " + link + "\n"));
    const SerialClient client{link};
    EXPECT_EQ(client.ask({128, 142, 35}, 1), (Bytes{1}));
    const Caller caller{folder.path(std::string{"control."} + number)};
    EXPECT_EQ(caller.ask("bump left"), "ok");
    EXPECT_TRUE(eventually([&] { return client.ask({142, 7}, 1) == Bytes{2}; }));
    EXPECT_EQ(caller.ask("bump none"), "ok");
  }
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 0);
  for (const char* drawing : {"way.0.SVG", "way.1.SVG", "way.2.SVG"})
    EXPECT_TRUE(contents(folder.path(drawing)).starts_with("<svg ")) << drawing;
}

TEST(SimCommand, PutsSeveralIntoOneWorld) {
  const TemporaryFolder folder;
  Command command{{"sim", "--count", "2", "--together", "--link", folder.path("create"),
                   "--control", folder.path("control")}};
  ASSERT_TRUE(eventually([&] {
    return !command.running() || std::ranges::count(command.out(), '\n') == 2;
  })) << command.err();
  const SerialClient first{folder.path("create.0")};
  const SerialClient second{folder.path("create.1")};
  const Caller caller{folder.path("control.1")};
  EXPECT_THAT(caller.ask("state"), HasSubstr("\"y_mm\":500")) << "beside the first";
  EXPECT_EQ(first.ask({128, 142, 7}, 1), (Bytes{0}));
  EXPECT_EQ(caller.ask("place 330 0 180"), "ok");
  EXPECT_TRUE(eventually([&] { return first.ask({142, 7}, 1) == Bytes{3}; }));
  EXPECT_TRUE(eventually([&] { return second.ask({128, 142, 7}, 1) == Bytes{3}; }));
  EXPECT_EQ(caller.ask("place 1000 0 180"), "ok");
  EXPECT_TRUE(eventually([&] { return first.ask({142, 7}, 1) == Bytes{0}; }));
}

TEST_P(SimSignalTest, WritesTheTraceOfAWholeDriveInAWorld) {
  const TemporaryFolder folder;
  const std::string socket = folder.path("control");
  const std::string trace = folder.path("way.svg");
  const std::string world = CARGOBAY_SOURCE_DIR "/examples/worlds/table.world";
  Command command{{"sim", "--world", world, "--trace", trace, "--control", socket}};
  const std::string path = announced_path(command);
  ASSERT_FALSE(path.empty()) << command.err();
  const SerialClient client{path};
  const Caller caller{socket};
  ASSERT_TRUE(client.send({128, 131, 145, 1, 244, 1, 244}));
  EXPECT_TRUE(eventually([&] {
    return caller.ask("state").find("\"last_hazard\":\"cliff") != std::string::npos;
  })) << caller.ask("state");
  EXPECT_FALSE(std::filesystem::exists(trace)) << "only at the end";
  command.send(GetParam());
  EXPECT_EQ(command.exit_code(), 0);
  const std::string drawing = contents(trace);
  EXPECT_THAT(drawing, HasSubstr("class='cliff'"));
  EXPECT_THAT(drawing, HasSubstr("<path class='path' d='M350 -350 "));
  // To the right edge, where its sensors saw the end of the table: a point about every 7.5 mm.
  const std::size_t from = drawing.find("class='path'");
  const std::string way = drawing.substr(from, drawing.find("/>", from) - from);
  EXPECT_GT(std::ranges::count(way, ' '), 120);
}

TEST(SimCommand, BeginsWithTheFaultsItIsGiven) {
  Command command{{"sim", "--fault", "junk-reading 2", "--fault", "wrong-baud 19200"}};
  const std::string path = announced_path(command);
  ASSERT_FALSE(path.empty()) << command.err();
  const SerialClient client{path, 19200};
  const Bytes junk = client.ask({128, 142, 2}, 6);
  ASSERT_EQ(junk.size(), 6U);
  EXPECT_NE(junk[2] * 256 + junk[3], 0);
  EXPECT_EQ(client.ask({142, 2}, 6), (Bytes{255, 0, 0, 0, 0, 0}));
}

TEST(SimCommand, LetsAFaultHappenLater) {
  Command command{{"sim", "--fault", "at 1.2 text too late", "--fault", "at 1.0 text hello"}};
  const std::string path = announced_path(command);
  ASSERT_FALSE(path.empty()) << command.err();
  const SerialClient client{path};
  const Bytes said = client.receive(17);
  EXPECT_EQ(std::string(said.begin(), said.end()), "hello\r\ntoo late\r\n");
}

TEST(SimCommand, IsTheKindOfRobotThatItsOptionsSay) {
  Command command{{"sim", "--extensions", "--battery", "1000"}};
  const std::string path = announced_path(command);
  ASSERT_FALSE(path.empty()) << command.err();
  const SerialClient client{path};
  EXPECT_EQ(client.ask({128, 142, 43}, 2).size(), 2U);
  EXPECT_EQ(client.ask({8}, 7), (Bytes{18, 7, 9, 24, 18, 35, 18 ^ 7 ^ 9 ^ 24 ^ 18 ^ 35}));
  const Bytes charge = client.ask({142, 25}, 2);
  ASSERT_EQ(charge.size(), 2U);
  EXPECT_NEAR(charge[0] * 256 + charge[1], 1000, 2);
}

TEST(SimCommand, LeavesItsRobotOffUntilItsButtonIsPressed) {
  const TemporaryFolder folder;
  Command command{{"sim", "--power-on", "never", "--control", folder.path("control")}};
  const std::string path = announced_path(command);
  ASSERT_FALSE(path.empty()) << command.err();
  const SerialClient client{path};
  const Caller caller{folder.path("control")};
  EXPECT_THAT(caller.ask("state"), HasSubstr("\"powered\":false"));
  EXPECT_EQ(caller.ask("power"), "ok");
  EXPECT_EQ(client.receive(4), (Bytes{'k', 'e', 'y', '-'}));
}

struct BadOptions {
  std::vector<std::string> arguments;
  int exit_code;
  const char* says;
};

TEST(SimCommand, SaysWhatIsWrongWithItsOptions) {
  const TemporaryFolder folder;
  const std::string file = folder.write("notes", "mine");
  const std::string bad_world = folder.write("bad.world", "wall 0 0 1 1\nhole 1 2 3\n");
  const BadOptions cases[] = {
      {{"--fault", "earthquake"}, 2, "unknown fault 'earthquake'; the faults are: none lost"},
      {{"--fault", "lost 2"}, 2, "the usage is 'lost P [DIRECTION]'"},
      {{"--fault", "at noon text"}, 2, "at SECONDS NAME"},
      {{"--count", "0"}, 2, "--count"},
      {{"--count", "1000"}, 2, "--count"},
      {{"--power-on", "later"}, 2, "--power-on"},
      {{"--battery", "0"}, 2, "--battery"},
      {{"--world", folder.path("none")}, 1, "name a file that can be read"},
      {{"--world", bad_world}, 1, "line 2: 'hole' is not one of wall"},
      {{"--control", file}, 1, "name another path, or remove what is there"},
      {{"--control", folder.path("none/socket")}, 1, "name a path in a directory"},
      {{"--trace", folder.path("none/way.svg")}, 1, "name a file in a folder that exists"},
  };
  for (const BadOptions& each : cases) {
    std::vector<std::string> arguments{"sim"};
    arguments.insert(arguments.end(), each.arguments.begin(), each.arguments.end());
    Command command{arguments};
    EXPECT_EQ(command.exit_code(), each.exit_code) << each.arguments[1];
    EXPECT_THAT(command.err(), OneErrorLine(each.says)) << each.arguments[1];
    EXPECT_THAT(command.out(), IsEmpty());
  }
  EXPECT_EQ(contents(file), "mine");
}

}  // namespace
}  // namespace cargobay::test
