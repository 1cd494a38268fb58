#include "hal/feed/feed_place.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

// A service's folders, as systemd names them to it.
class FeedFolderTest : public testing::Test {
 protected:
  void TearDown() override {
    unsetenv("RUNTIME_DIRECTORY");  // NOLINT(concurrency-mt-unsafe): one thread
    rmdir(folder_.c_str());
  }
  std::string folder_in(const std::string& name, const std::string& as_named) {
    folder_ = "/tmp/" + name + std::to_string(getpid());
    mkdir(folder_.c_str(), S_IRWXU);
    const std::string value = "/tmp/" + as_named + std::to_string(getpid()) + ":/tmp/other";
    setenv("RUNTIME_DIRECTORY", value.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
    const auto folder = feed_folder();
    return folder ? *folder : folder.failure().message;
  }

  std::string folder_;
};

TEST_F(FeedFolderTest, IsTheFirstOfAService) { EXPECT_EQ(folder_in("feed-", "feed-"), folder_); }

TEST_F(FeedFolderTest, MayHaveColonsAndBackslashesInItsName) {
  EXPECT_EQ(folder_in("feed-by\\x2did-0000:00:01-", "feed-by\\\\x2did-0000\\:00\\:01-"), folder_);
}

TEST_F(FeedFolderTest, IsLeftToTheService) {
  leave_folder(folder_in("feed:", "feed\\:"));
  EXPECT_EQ(access(folder_.c_str(), F_OK), 0);
}

}  // namespace
}  // namespace cargobay::hal
