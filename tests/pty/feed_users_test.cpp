// The feed and the other users of the machine (docs/feed.md, "Where it is"). As root, who can be
// each of them.
#include <fcntl.h>
#include <grp.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "feed_fixture.hpp"
#include "hal/feed/feed_place.hpp"
#include "hal/file/descriptor.hpp"

namespace cargobay::test {
namespace {

using hal::Descriptor;
using hal::FeedReader;
using testing::HasSubstr;

constexpr uid_t kRoot = 0;
constexpr uid_t kAnn = 54321;
constexpr uid_t kMallory = 54322;

bool is_root() { return geteuid() == kRoot; }

// This process is that user's for as long as this is there.
class User {
 public:
  explicit User(uid_t user) { EXPECT_EQ(seteuid(user), 0); }
  ~User() { EXPECT_EQ(seteuid(kRoot), 0); }
  User(const User&) = delete;
  User& operator=(const User&) = delete;
};

sockaddr_un address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::copy_n(path.c_str(), std::min(path.size(), sizeof address.sun_path - 1), address.sun_path);
  return address;
}

// Listens at `path`, where root has put the socket, as a process of `user`; any user may connect.
Descriptor listen_as(uid_t user, const std::string& path) {
  Descriptor socket{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  const sockaddr_un address = address_of(path);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as bind() wants it
  EXPECT_EQ(bind(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(chmod(path.c_str(), 0666), 0);
  const User listener{user};
  EXPECT_EQ(listen(socket.number(), 8), 0);
  return socket;
}

// What becomes of it if a process of that user alone, in no group of ours, connects: 0 or errno.
int connect_as(uid_t user, const std::string& path) {
  const sockaddr_un address = address_of(path);
  const pid_t child = fork();
  if (child == 0) {
    const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
    if (setgroups(0, nullptr) != 0 || setresgid(user, user, user) != 0 ||
        setresuid(user, user, user) != 0)
      _exit(ENOSYS);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): as connect() wants it
    const auto* const to = reinterpret_cast<const sockaddr*>(&address);
    _exit(connect(socket, to, sizeof address) == 0 ? 0 : errno);
  }
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return WEXITSTATUS(status);
}

class FeedUsersTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!is_root()) GTEST_SKIP() << "only root can be several users";
    ASSERT_EQ(chmod(folder_.path("").c_str(), 0755), 0);
  }
  static void expect_trusted(uid_t reader, const std::string& path) {
    const User user{reader};
    const auto attached = FeedReader::attach(path);
    EXPECT_TRUE(attached) << attached.failure().message;
  }
  static void expect_not_trusted(uid_t reader, const std::string& path) {
    const User user{reader};
    const auto attached = FeedReader::attach(path);
    ASSERT_FALSE(attached) << path;
    EXPECT_EQ(attached.failure().code, std::errc::permission_denied);
    EXPECT_THAT(attached.failure().message, HasSubstr("another user's process"));
  }

  const TemporaryFolder folder_{};
};

TEST_F(FeedUsersTest, AReaderTalksToItsOwnProcessesAndToRoots) {
  const std::string own = folder_.path("own");
  const std::string roots = folder_.path("roots");
  const Descriptor by_ann = listen_as(kAnn, own);
  const Descriptor by_root = listen_as(kRoot, roots);
  expect_trusted(kAnn, own);
  expect_trusted(kAnn, roots);
  expect_trusted(kRoot, roots);
}

TEST_F(FeedUsersTest, AReaderIsNotDeceivedByAnotherUser) {
  const std::string path = folder_.path("dev-ttyUSB0");
  const Descriptor by_mallory = listen_as(kMallory, path);
  expect_not_trusted(kAnn, path);
  expect_not_trusted(kRoot, path);
  // Nor by the name of a port.
  setenv("CARGOBAY_FEED_DIR", folder_.path("").c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  expect_not_trusted(kRoot, "/dev/ttyUSB0");
  expect_not_trusted(kRoot, "");
}

TEST_F(FeedUsersTest, TheServicesUserIsTrustedInItsFolderAlone) {
  // Of this process alone, and gone with it.
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("none", "/run", "tmpfs", 0, "mode=755") != 0)
    GTEST_SKIP() << "no /run of its own: "
                 << std::strerror(errno);  // NOLINT(concurrency-mt-unsafe)
  const std::string folder = "/run/cargobay";
  ASSERT_EQ(mkdir(folder.c_str(), 0755), 0);
  const std::string path = folder + "/dev-ttyUSB0";
  const Descriptor by_service = listen_as(kMallory, path);
  expect_not_trusted(kAnn, path);  // the folder is root's
  ASSERT_EQ(chown(folder.c_str(), kMallory, kMallory), 0);
  expect_trusted(kAnn, path);
  ASSERT_EQ(chmod(folder.c_str(), 0775), 0);
  expect_not_trusted(kAnn, path);  // others may write to it
  ASSERT_EQ(chmod(folder.c_str(), 0755), 0);
  const std::string elsewhere = folder_.path("cargobay");
  const Descriptor same_user = listen_as(kMallory, elsewhere);
  expect_not_trusted(kAnn, elsewhere);
}

TEST_F(FeedUsersTest, NothingIsPublishedInAFolderOfOthers) {
  const std::string folder = folder_.path("feeds");
  ASSERT_EQ(mkdir(folder.c_str(), 0755), 0);
  setenv("CARGOBAY_FEED_DIR", folder.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  EXPECT_TRUE(hal::feed_folder());
  ASSERT_EQ(chmod(folder.c_str(), 0777), 0);
  EXPECT_FALSE(hal::feed_folder()) << "anybody may put a socket there";
  ASSERT_EQ(chmod(folder.c_str(), 0755), 0);
  ASSERT_EQ(chown(folder.c_str(), kMallory, kMallory), 0);
  EXPECT_FALSE(hal::feed_folder()) << "its owner may";
  const std::string link = folder_.path("link");
  ASSERT_EQ(symlink("/run", link.c_str()), 0);
  setenv("CARGOBAY_FEED_DIR", link.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  EXPECT_FALSE(hal::feed_folder()) << "a link leads wherever its owner wants";
}

// Neither through the folder nor, were it open, through the socket.
TEST_F(FeedTest, OtherUsersNeitherWatchNorSteer) {
  if (!is_root()) GTEST_SKIP() << "only root can be several users";
  const TemporaryFolder above;
  ASSERT_EQ(chmod(above.path("").c_str(), 0755), 0);
  const std::string folder = above.path("feeds");
  setenv("CARGOBAY_FEED_DIR", folder.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  umask(0);                                        // it is not this that keeps them out
  Command command{serve_command()};
  wait_until_served(command);
  ASSERT_FALSE(hal::find_feeds().empty());
  const std::string socket = hal::find_feeds().front().socket;
  EXPECT_EQ(connect_as(kRoot, socket), 0);
  EXPECT_EQ(connect_as(kMallory, socket), EACCES);
  ASSERT_EQ(chmod(folder.c_str(), 0755), 0);
  EXPECT_EQ(connect_as(kMallory, socket), EACCES);
  Command watch{{"sensors", "--once", "--port", socket}, kNobody};
  EXPECT_EQ(watch.exit_code(), 1);
  EXPECT_EQ(watch.out(), "");
}

}  // namespace
}  // namespace cargobay::test
