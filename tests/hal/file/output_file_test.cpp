// What is written at the place a user names, and what is left alone.
#include "hal/file/output_file.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

constexpr uid_t kSomebody = 65534;

class OutputFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "cargobay-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) folder_ = name;
  }
  void TearDown() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream{path(name)} << text;
    return path(name);
  }
  static std::string contents(const std::string& path) {
    std::ifstream file{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{file}, {}};
  }
  // Everything in the test's folder.
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator{folder_})
      all.push_back(entry.path().filename());
    return all;
  }
  static std::string complaint(const std::string& path) {
    const auto file = OutputFile::open(path);
    return file ? "nothing: it was opened" : file.failure().message;
  }
  static std::string put(const std::string& path, const std::string& text) {
    auto file = OutputFile::open(path);
    if (!file) return file.failure().message;
    if (const auto done = file->write(text); !done) return done.failure().message;
    if (const auto done = file->publish(); !done) return done.failure().message;
    return "";
  }

  fs::path folder_;
};

TEST_F(OutputFileTest, ShowsNothingBeforeItIsPublished) {
  {
    auto file = OutputFile::open(path("file"));
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write("some "));
    EXPECT_FALSE(fs::exists(path("file")));
    ASSERT_TRUE(file->publish());
    EXPECT_EQ(contents(path("file")), "some ");
    ASSERT_TRUE(file->write("text"));  // and is written to from there on
    EXPECT_TRUE(file->publish());
  }
  EXPECT_EQ(contents(path("file")), "some text");
  EXPECT_THAT(names(), testing::ElementsAre("file"));
}

TEST_F(OutputFileTest, LeavesWhatWasThereUntilThen) {
  write("file", "before");
  {
    auto file = OutputFile::open(path("file"));
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write("after"));
    EXPECT_EQ(contents(path("file")), "before");
  }
  EXPECT_EQ(contents(path("file")), "before");
  EXPECT_THAT(names(), testing::ElementsAre("file"));
  EXPECT_EQ(put(path("file"), "after"), "");
  EXPECT_EQ(contents(path("file")), "after");
  EXPECT_THAT(names(), testing::ElementsAre("file"));
}

TEST_F(OutputFileTest, KeepsTheRightsOfWhatItReplaces) {
  write("file", "before");
  ASSERT_EQ(chmod(path("file").c_str(), 0640), 0);
  const bool may_give_away = geteuid() == 0;
  const uid_t owner = may_give_away ? kSomebody : geteuid();
  if (may_give_away) {
    ASSERT_EQ(chown(path("file").c_str(), owner, owner), 0);
  }
  ASSERT_EQ(put(path("file"), "after"), "");
  struct stat status{};
  ASSERT_EQ(stat(path("file").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0640U);
  EXPECT_EQ(status.st_uid, owner);
}

TEST_F(OutputFileTest, DoesNotReplaceWhatCameMeanwhile) {
  auto file = OutputFile::open(path("file"));
  ASSERT_TRUE(file);
  ASSERT_TRUE(file->write("ours"));
  write("file", "theirs");
  const auto done = file->publish();
  ASSERT_FALSE(done);
  EXPECT_EQ(contents(path("file")), "theirs");
  const std::string aside = done.failure().message.substr(done.failure().message.rfind(" in ") + 4);
  EXPECT_THAT(aside, StartsWith(path("file.")));
  EXPECT_EQ(contents(aside), "ours") << done.failure().message;
}

TEST_F(OutputFileTest, FollowsLinksAndLeavesThem) {
  write("file", "before");
  fs::create_symlink("file", path("link"));
  fs::create_symlink("link", path("link_to_link"));
  fs::create_symlink("none", path("dangling"));
  ASSERT_EQ(put(path("link_to_link"), "after"), "");
  EXPECT_EQ(contents(path("file")), "after");
  ASSERT_EQ(put(path("dangling"), "new"), "");
  EXPECT_EQ(contents(path("none")), "new");
  for (const char* link : {"link", "link_to_link", "dangling"})
    EXPECT_TRUE(fs::is_symlink(path(link))) << link;
  fs::create_symlink("circle", path("circle"));
  EXPECT_THAT(complaint(path("circle")), HasSubstr("symbolic links"));
}

// The old, predictable name: whatever is there does not matter to us.
TEST_F(OutputFileTest, TakesNoNameThatCanBeForeseen) {
  write("precious", "theirs");
  fs::create_symlink("precious", path("file.part"));
  ASSERT_EQ(put(path("file"), "ours"), "");
  EXPECT_EQ(contents(path("precious")), "theirs");
  EXPECT_TRUE(fs::is_symlink(path("file.part")));
}

TEST_F(OutputFileTest, TakesNothingOfOthersInAFolderForAll) {
  if (geteuid() != 0) GTEST_SKIP() << "needs another user's files";
  const std::string open_folder = path("open");
  fs::create_directory(open_folder);
  ASSERT_EQ(chmod(open_folder.c_str(), 01777), 0);
  write("precious", "mine");
  write("open/file", "theirs");
  ASSERT_EQ(chown(path("open/file").c_str(), kSomebody, kSomebody), 0);
  fs::create_symlink(path("precious"), path("open/link"));
  fs::create_symlink(path("none"), path("open/dangling"));
  ASSERT_EQ(lchown(path("open/link").c_str(), kSomebody, kSomebody), 0);
  ASSERT_EQ(lchown(path("open/dangling").c_str(), kSomebody, kSomebody), 0);
  ASSERT_EQ(mkfifo(path("open/fifo").c_str(), 0666), 0);
  ASSERT_EQ(chown(path("open/fifo").c_str(), kSomebody, kSomebody), 0);
  for (const char* name : {"open/file", "open/link", "open/dangling", "open/fifo"})
    EXPECT_THAT(complaint(path(name)), HasSubstr("another user")) << name;
  EXPECT_EQ(contents(path("precious")), "mine");
  EXPECT_EQ(contents(path("open/file")), "theirs");
}

TEST_F(OutputFileTest, RefusesPortsAndOtherDevices) {
  const int port = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(port, 0);
  grantpt(port);
  unlockpt(port);
  std::array<char, 64> name{};
  ASSERT_EQ(ptsname_r(port, name.data(), name.size()), 0);
  fs::create_symlink(name.data(), path("link"));
  const int slave = open(name.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  const std::string by_number = "/dev/fd/" + std::to_string(slave);
  for (const std::string& each : {std::string{name.data()}, path("link"), by_number})
    EXPECT_THAT(complaint(each), HasSubstr("a port")) << each;
  close(slave);
  close(port);
  EXPECT_THAT(complaint("/dev/zero"), HasSubstr("another device"));
  EXPECT_THAT(complaint("/tmp"), HasSubstr("Is a directory; name a file"));
  EXPECT_THAT(complaint(path("none/file")), HasSubstr("No such file or directory; name a file"));
}

TEST_F(OutputFileTest, WritesNullAndFullInPlace) {
  EXPECT_EQ(put("/dev/null", "text"), "");
  EXPECT_THAT(put("/dev/full", "text"), HasSubstr("No space left on device; make room"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(OutputFileTest, DoesNotWaitForTheReaderOfAFifo) {
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  EXPECT_THAT(complaint(path("fifo")), HasSubstr("nothing reads; start its reader"));
  const int reader = open(path("fifo").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  EXPECT_EQ(put(path("fifo"), "text"), "");
  std::array<char, 8> bytes{};
  EXPECT_EQ(read(reader, bytes.data(), bytes.size()), 4);
  // A reader that has stopped reading is not waited for either, if that was requested.
  auto file = OutputFile::open(path("fifo"));
  ASSERT_TRUE(file);
  const auto done = file->write(std::string(1U << 20U, 'x'), std::chrono::milliseconds{1});
  ASSERT_FALSE(done);
  EXPECT_THAT(done.failure().message, HasSubstr("check what reads the pipe"));
  close(reader);
  EXPECT_THAT(file->write("text").failure().message, HasSubstr("Broken pipe"));  // and no SIGPIPE
}

TEST_F(OutputFileTest, WritesWhereADescriptorIsOpen) {
  const int open_file = open(write("file", "").c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  const std::string name = "/dev/fd/" + std::to_string(open_file);
  EXPECT_EQ(put(name, "some "), "");
  EXPECT_EQ(put(name, "text"), "");
  close(open_file);
  EXPECT_EQ(contents(path("file")), "some text");
  EXPECT_THAT(complaint(name), HasSubstr("Bad file descriptor"));
}

// In the thread of a program that knows nothing of it: no disposition, mask or pending signal has
// changed afterwards.
TEST_F(OutputFileTest, FailsAtALimitOfTheFileSize) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  auto file = OutputFile::open(path("file"));
  ASSERT_TRUE(file);
  const rlimit little{.rlim_cur = 1000, .rlim_max = before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  const auto done = file->write(std::string(5000, 'x'));
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(done);
  EXPECT_THAT(done.failure().message, HasSubstr("File too large; raise the file size limit"));
  ASSERT_TRUE(file->publish());
  EXPECT_EQ(contents(path("file")).size(), 1000U);
  sigset_t mask{};
  pthread_sigmask(SIG_BLOCK, nullptr, &mask);
  EXPECT_EQ(sigismember(&mask, SIGXFSZ), 0);
  struct sigaction disposition{};
  sigaction(SIGXFSZ, nullptr, &disposition);
  EXPECT_EQ(disposition.sa_handler, SIG_DFL);
}

TEST_F(OutputFileTest, LeavesAPendingSignalOfTheProgramsPending) {
  sigset_t pipe{};
  sigset_t before{};
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &pipe, &before);
  pthread_kill(pthread_self(), SIGPIPE);
  EXPECT_EQ(put(path("file"), "text"), "");
  sigset_t pending{};
  sigpending(&pending);
  EXPECT_EQ(sigismember(&pending, SIGPIPE), 1);
  constexpr timespec kAtOnce{};
  sigtimedwait(&pipe, nullptr, &kAtOnce);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

// A program that has closed its standard output prints into the first file it opens.
TEST_F(OutputFileTest, TakesNoneOfTheStandardDescriptors) {
  const int saved = dup(STDIN_FILENO);
  close(STDIN_FILENO);
  {
    auto file = OutputFile::open(path("file"));
    EXPECT_TRUE(file);
    EXPECT_LT(fcntl(STDIN_FILENO, F_GETFD), 0) << "it has become ours";
  }
  dup2(saved, STDIN_FILENO);
  close(saved);
}

TEST_F(OutputFileTest, KnowsOneFileByEveryName) {
  write("file", "text");
  fs::create_symlink("file", path("link"));
  fs::create_hard_link(path("file"), path("hard"));
  fs::create_directory(path("folder"));
  const auto same = [this](const std::string& a, const std::string& b) {
    return same_file(place_of(path(a)), place_of(path(b)));
  };
  EXPECT_TRUE(same("file", "link"));
  EXPECT_TRUE(same("file", "hard"));
  EXPECT_TRUE(same("none", "folder/../none"));
  EXPECT_FALSE(same("none", "other"));
  EXPECT_FALSE(same("none", "folder/none"));
  EXPECT_FALSE(same_file(place_of("/dev/null"), place_of("/dev/null")));
}

}  // namespace
}  // namespace cargobay::hal
