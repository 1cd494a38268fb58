// Which of the things that a user can name are read, and which are not.
#include "hal/file/read_input.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/config/config.hpp"
#include "hal/sim/world/world.hpp"

namespace cargobay::hal {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ReadInputTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) folder_ = name;
  }
  void TearDown() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream{path(name)} << text;
    return path(name);
  }
  std::string fifo() const {
    EXPECT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
    return path("fifo");
  }
  static std::string complaint(const std::string& path, const InputLimits& limits = {}) {
    const auto text = read_input(path, limits);
    return text ? "nothing: it was read" : text.failure().message;
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(ReadInputTest, ReadsFiles) {
  EXPECT_EQ(*read_input(write("file", "some\ntext"), {}), "some\ntext");
  EXPECT_EQ(*read_input(write("empty", ""), {}), "");
}

TEST_F(ReadInputTest, ReadsNothingOfNull) { EXPECT_EQ(*read_input("/dev/null", {}), ""); }

TEST_F(ReadInputTest, ReadsUpToItsLimit) {
  const std::string file = write("file", std::string(1U << 20U, 'x'));
  EXPECT_TRUE(read_input(file, {.most_bytes = std::size_t{1} << 20U}));
  write("file", std::string((1U << 20U) + 1, 'x'));
  EXPECT_THAT(complaint(file, {.most_bytes = std::size_t{1} << 20U}), HasSubstr("than 1 MiB"));
}

TEST_F(ReadInputTest, ReadsNoFurtherThanAWrongBeginning) {
  const std::string file = write("file", std::string(1U << 20U, 'x'));
  const auto text = read_input(file, {.most_bytes = std::size_t{1} << 30U, .begins_with = "CBRE"});
  ASSERT_TRUE(text);
  EXPECT_LT(text->size(), 1U << 17U);
}

TEST_F(ReadInputTest, RefusesWhatHasNoEnd) {
  EXPECT_THAT(complaint("/dev/zero"), HasSubstr("a device; name a file"));
  EXPECT_THAT(complaint("/dev/urandom"), HasSubstr("a device"));
  EXPECT_THAT(complaint("/dev/ptmx"), HasSubstr("a device"));
  EXPECT_THAT(complaint("/tmp"), HasSubstr("Is a directory; name a file"));
  EXPECT_THAT(complaint(path("none")), StartsWith("No such file or directory; name"));
}

TEST_F(ReadInputTest, RefusesAFifoThatNothingWrites) {
  EXPECT_THAT(complaint(fifo()), HasSubstr("nothing writes to"));
}

TEST_F(ReadInputTest, ReadsAFifoThatIsWritten) {
  const std::string name = fifo();
  const int reader = open(name.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  const int writer = open(name.c_str(), O_WRONLY | O_CLOEXEC);
  std::thread writes{[writer] {
    EXPECT_EQ(::write(writer, "some ", 5), 5);
    EXPECT_EQ(::write(writer, "text", 4), 4);
    close(writer);
  }};
  EXPECT_EQ(*read_input(name, {}), "some text");
  writes.join();
  close(reader);
}

// Like the shell's <(...).
TEST_F(ReadInputTest, ReadsAPipeByItsDescriptor) {
  std::array<int, 2> ends{-1, -1};
  ASSERT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
  ASSERT_EQ(::write(ends[1], "text", 4), 4);
  close(ends[1]);
  EXPECT_EQ(*read_input("/dev/fd/" + std::to_string(ends[0]), {}), "text");
  close(ends[0]);
}

TEST_F(ReadInputTest, IsHowConfigurationsAndWorldsAreRead) {
  const std::string pipe = fifo();
  for (const std::string& name : {pipe, std::string{"/dev/zero"}, std::string{"/tmp"}}) {
    const auto config = load_config(name);
    ASSERT_FALSE(config) << name;
    EXPECT_THAT(config.failure().message, StartsWith("cannot read the configuration " + name));
    const auto world = sim::World::load(name);
    ASSERT_FALSE(world) << name;
    EXPECT_THAT(world.failure().message, StartsWith("cannot read the world " + name));
  }
  write("long", std::string(kMostConfigBytes + 1, '#'));
  EXPECT_FALSE(load_config(path("long")));
  EXPECT_FALSE(sim::World::load(path("long")));
}

}  // namespace
}  // namespace cargobay::hal
