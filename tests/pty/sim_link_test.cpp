// The link to a virtual Create's pseudo-terminal: what may be in its place, and what happens to
// that.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <thread>
#include <utility>
#include <vector>

#include "drive_fixture.hpp"
#include "hal/file/descriptor.hpp"
#include "hal/file/left_behind.hpp"
#include "hal/sim/line/pty_port.hpp"

namespace cargobay::test {
namespace {

using hal::link_target;
using hal::remove_if;
using hal::sim::PtyPort;
using testing::HasSubstr;
namespace fs = std::filesystem;

// The path of a pseudo-terminal that is gone; a killed server leaves a link to such a path.
std::string dead_pty() { return "/dev/pts/999999"; }

TEST(SimLink, LeadsToThePortAndGoesWithIt) {
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  {
    const auto port = PtyPort::open(link, 57600);
    ASSERT_TRUE(port) << port.failure().message;
    EXPECT_EQ((*port)->path(), link);
    EXPECT_EQ(link_target(link), (*port)->device_path());
  }
  EXPECT_TRUE(fs::is_empty(folder.path(""))) << "nothing is left";
}

TEST(SimLink, ReplacesOneToAPtyThatIsGone) {
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  fs::create_symlink(dead_pty(), link);
  const auto port = PtyPort::open(link, 57600);
  ASSERT_TRUE(port) << port.failure().message;
  EXPECT_EQ(link_target(link), (*port)->device_path());
}

TEST(SimLink, RefusesEverythingElseInItsPlace) {
  const TemporaryFolder folder;
  const std::string file = folder.write("notes", "mine");
  const auto living = PtyPort::open("", 57600);
  ASSERT_TRUE(living);
  struct Case {
    const char* name;
    std::string target;
    const char* says;
  };
  const Case cases[] = {
      {"to-a-file", file, "which is not a virtual Create: remove it or name another"},
      {"to-nothing", "/nowhere", "which is not a virtual Create"},
      {"to-a-folder", "/tmp", "which is not a virtual Create"},
      {"to-a-port", "/dev/ttyUSB0", "which is not a virtual Create"},
      {"relative", "pts/3", "which is not a virtual Create"},
      {"to-more-than-a-number", "/dev/pts/3x", "which is not a virtual Create"},
      {"to-the-folder-of-ptys", "/dev/pts/", "which is not a virtual Create"},
      {"to-a-living-pty", (*living)->device_path(), "which is in use"},
  };
  for (const Case& each : cases) {
    const std::string link = folder.path(each.name);
    fs::create_symlink(each.target, link);
    const auto port = PtyPort::open(link, 57600);
    ASSERT_FALSE(port) << each.name;
    EXPECT_THAT(port.failure().message, HasSubstr(link));
    EXPECT_THAT(port.failure().message, HasSubstr(each.says));
    EXPECT_EQ(link_target(link), each.target) << "left as it was";
  }
  fs::create_directory(folder.path("folder"));
  for (const std::string& path : {file, folder.path("folder")}) {
    const auto port = PtyPort::open(path, 57600);
    ASSERT_FALSE(port) << path;
    EXPECT_THAT(port.failure().message, HasSubstr("it is not a symbolic link: remove it or name"));
  }
  EXPECT_EQ(contents(file), "mine");
}

TEST(SimLink, RefusesWhatAnotherUserLeft) {
  if (geteuid() != 0) GTEST_SKIP() << "only root makes another user's link";
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  fs::create_symlink(dead_pty(), link);
  ASSERT_EQ(lchown(link.c_str(), 65534, 65534), 0);
  const auto port = PtyPort::open(link, 57600);
  ASSERT_FALSE(port);
  EXPECT_THAT(port.failure().message, HasSubstr("it is another user's"));
  EXPECT_EQ(link_target(link), dead_pty());
}

TEST(SimLink, StaysWhenItIsAnothersByTheEnd) {
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  {
    const auto port = PtyPort::open(link, 57600);
    ASSERT_TRUE(port);
    fs::remove(link);
    fs::create_symlink("/nowhere", link);
  }
  EXPECT_EQ(link_target(link), "/nowhere");
}

// One after the other looks dead, and is replaced; all but one find a living link in the end.
TEST(SimLink, IsOfOneAloneOfManyThatWantItAtOnce) {
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  for (int round = 0; round < 50; ++round) {
    fs::create_symlink(dead_pty(), link);
    std::vector<std::unique_ptr<PtyPort>> ports(4);
    std::vector<std::thread> threads;
    threads.reserve(ports.size());
    for (auto& port : ports) {
      threads.emplace_back([&] {
        if (auto opened = PtyPort::open(link, 57600)) port = std::move(*opened);
      });
    }
    for (std::thread& thread : threads) thread.join();
    std::erase(ports, nullptr);
    ASSERT_EQ(ports.size(), 1U) << "round " << round;
    EXPECT_EQ(link_target(link), ports[0]->device_path());
    ports.clear();
    ASSERT_TRUE(fs::is_empty(folder.path(""))) << "round " << round;
  }
}

TEST(SimLink, OfARunningCommandIsRefusedAndOfAKilledOneReplaced) {
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  Command first{{"sim", "--link", link}};
  ASSERT_TRUE(eventually([&] { return fs::is_symlink(link); })) << first.err();
  Command second{{"sim", "--link", link}};
  EXPECT_EQ(second.exit_code(), 1);
  EXPECT_THAT(second.err(), OneErrorLine("which is in use: end the `cargobay sim`"));
  EXPECT_TRUE(fs::exists(link)) << "still leads to the first";
  first.send(SIGKILL);
  EXPECT_EQ(first.exit_code(), -SIGKILL);
  // The next one may get the same terminal, so the test checks that the link is a new one.
  const auto made = [&link] {
    struct stat file{};
    return lstat(link.c_str(), &file) == 0 ? std::pair{file.st_mtim.tv_sec, file.st_mtim.tv_nsec}
                                           : std::pair<time_t, long>{};
  };
  const auto left_behind = made();
  ASSERT_NE(left_behind.first, 0) << "left behind";
  Command third{{"sim", "--link", link}};
  EXPECT_TRUE(eventually([&] { return made() != left_behind && fs::exists(link); }));
  third.send(SIGTERM);
  EXPECT_EQ(third.exit_code(), 0) << third.err();
}

// Whoever opens the next terminal gets the name of the one that is gone.
TEST(SimLink, IsReplacedWhenItsTerminalsNameIsAnothers) {
  const TemporaryFolder folder;
  const std::string link = folder.path("create");
  auto killed = PtyPort::open("", 57600);
  ASSERT_TRUE(killed);
  const std::string target = (*killed)->device_path();
  fs::create_symlink(target, link);
  EXPECT_THAT(PtyPort::open(link, 57600).failure().message, HasSubstr("which is in use"));
  killed->reset();
  // Other tests open terminals too, and it does not matter whose has the name.
  std::vector<hal::Descriptor> others;
  while (!fs::exists(target)) {
    ASSERT_LT(others.size(), 256U);
    others.emplace_back(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
  }
  const auto port = PtyPort::open(link, 57600);
  ASSERT_TRUE(port) << port.failure().message;
  EXPECT_EQ(link_target(link), (*port)->device_path());
}

// Between the look and the removal another file came: it is put back.
TEST(RemoveIf, PutsBackWhatItDidNotMean) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "another's");
  int asked = 0;
  EXPECT_EQ(remove_if(file, [&](const std::string&) { return ++asked == 1; }),
            std::errc::file_exists);
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(contents(file), "another's");
  EXPECT_FALSE(remove_if(file, [](const std::string&) { return true; }));
  EXPECT_FALSE(remove_if(file, [](const std::string&) { return true; })) << "gone is well";
  EXPECT_TRUE(fs::is_empty(folder.path("")));
}

}  // namespace
}  // namespace cargobay::test
