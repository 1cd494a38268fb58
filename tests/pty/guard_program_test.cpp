// Which program may be the guard.

#include "hal/guard/guard_program.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class GuardProgramTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder_.path("own/inner"));
    fs::copy_file(CARGOBAY_BINARY_DIR "/cargobay-guard", guard_);
    for (const char* path : {"", "own", "own/inner"}) set_mode(path, 0755);
    set_mode("own/inner/cargobay-guard", 0755);
  }
  void set_mode(const std::string& path, mode_t mode) const {
    ASSERT_EQ(chmod(folder_.path(path).c_str(), mode), 0);
  }
  // Empty if it may be run.
  std::string refusal() const {
    const auto found = hal::guard_program(guard_);
    return found ? "" : found.failure().message;
  }

  TemporaryFolder folder_{};
  std::string guard_ = folder_.path("own/inner/cargobay-guard");
};

TEST_F(GuardProgramTest, IsOneThatNobodyElseCanChange) { EXPECT_EQ(refusal(), ""); }

TEST_F(GuardProgramTest, IsNoneThatOthersMayWrite) {
  for (const mode_t mode : {0775U, 0757U, 0777U}) {
    set_mode("own/inner/cargobay-guard", mode);
    EXPECT_THAT(refusal(), HasSubstr("others may write to " + guard_));
    EXPECT_THAT(refusal(), HasSubstr("chmod go-w"));
  }
}

TEST_F(GuardProgramTest, IsNoneInAFolderThatOthersMayWrite) {
  for (const mode_t mode : {0775U, 0757U, 01777U}) {
    set_mode("own/inner", mode);
    EXPECT_THAT(refusal(), HasSubstr("others may write to its folder"));
  }
}

TEST_F(GuardProgramTest, IsNoneBelowAFolderThatOthersMayWrite) {
  set_mode("own", 0777);
  EXPECT_THAT(refusal(), HasSubstr("others may write to " + folder_.path("own")));
}

TEST_F(GuardProgramTest, IsNoneThatBelongsToOthers) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a file away";
  ASSERT_EQ(chown(guard_.c_str(), 65534, 65534), 0);
  EXPECT_THAT(refusal(), HasSubstr("belongs to user 65534, neither root nor you"));
  ASSERT_EQ(chown(guard_.c_str(), 0, 0), 0);
  ASSERT_EQ(chown(folder_.path("own").c_str(), 65534, 65534), 0);
  EXPECT_THAT(refusal(), HasSubstr("belongs to user 65534, neither root nor you"));
}

TEST_F(GuardProgramTest, IsJudgedBehindLinks) {
  const std::string link = folder_.path("link");
  fs::create_symlink(guard_, link);
  EXPECT_EQ(*hal::guard_program(link), guard_);
  set_mode("own/inner/cargobay-guard", 0777);
  const auto found = hal::guard_program(link);
  ASSERT_FALSE(found);
  EXPECT_THAT(found.failure().message, HasSubstr("others may write to " + guard_));
}

TEST_F(GuardProgramTest, IsAProgram) {
  set_mode("own/inner/cargobay-guard", 0644);
  EXPECT_THAT(refusal(), HasSubstr("cannot run"));
  guard_ = folder_.path("own");
  EXPECT_THAT(refusal(), HasSubstr("not a program"));
  guard_ = folder_.path("missing");
  EXPECT_THAT(refusal(), HasSubstr("No such file"));
}

TEST(GuardProgramOfABuildTree, IsThatOfTheTree) {
  const auto found = hal::guard_program("");
  ASSERT_TRUE(found) << found.failure().message;
  EXPECT_EQ(fs::canonical(*found), fs::canonical(CARGOBAY_BINARY_DIR "/cargobay-guard"));
}

}  // namespace
}  // namespace cargobay::test
