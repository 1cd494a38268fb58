// Who opens a file is seen, whatever the program does to the descriptor that it is seen by.
#include "hal/robot/open_watch.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using Woken = OpenWatch::Woken;
using std::chrono::seconds;

class OpenWatchTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    const int file = mkstemp(name.data());
    ASSERT_GE(file, 0);
    close(file);
    path_ = name;
    ASSERT_TRUE(watch_.begin(path_));
  }
  void TearDown() override { std::filesystem::remove(path_); }
  void open_it() const { std::ifstream{path_}.get(); }
  Woken look() { return watch_.wait(rt::Clock::now()); }

  std::string path_;
  OpenWatch watch_;
};

TEST_F(OpenWatchTest, SeesThatTheFileWasOpened) {
  EXPECT_EQ(look(), Woken::timed_out);
  open_it();
  open_it();
  EXPECT_EQ(watch_.wait(rt::Clock::now() + seconds{60}), Woken::opened);
  EXPECT_EQ(look(), Woken::timed_out) << "both at once";
}

TEST_F(OpenWatchTest, EndsWhenItIsTold) {
  open_it();
  watch_.end();
  EXPECT_EQ(watch_.wait(rt::Clock::now() + seconds{60}), Woken::ended);
}

TEST_F(OpenWatchTest, CannotWatchWhatIsNotThere) {
  OpenWatch other;
  EXPECT_FALSE(other.begin(path_ + "-not"));
  EXPECT_EQ(other.wait(rt::Clock::now() + seconds{60}), Woken::blind);
}

// As a program does that closes all descriptors that it does not know, and opens its own.
TEST_F(OpenWatchTest, LeavesAFileUnderItsFormerNumberAlone) {
  std::array<int, 2> pipe_ends{-1, -1};
  ASSERT_EQ(pipe(pipe_ends.data()), 0);
  ASSERT_EQ(write(pipe_ends[1], "x", 1), 1);
  int number = -1;
  {
    OpenWatch watch;
    ASSERT_TRUE(watch.begin(path_));
    for (int candidate = 3; candidate < 256; ++candidate) {
      std::error_code error;
      const auto link =
          std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(candidate), error);
      if (!error && link == "anon_inode:inotify") number = candidate;  // the last: `watch`
    }
    ASSERT_GE(number, 3);
    ASSERT_EQ(dup2(pipe_ends[0], number), number);
    EXPECT_EQ(watch.wait(rt::Clock::now() + seconds{60}), Woken::blind);
    watch.end();
  }
  char read_back = 0;
  EXPECT_EQ(read(number, &read_back, 1), 1) << "it is still open, and nothing was read from it";
  EXPECT_EQ(read_back, 'x');
  close(number);
  close(pipe_ends[0]);
  close(pipe_ends[1]);
}

}  // namespace
}  // namespace cargobay::hal
