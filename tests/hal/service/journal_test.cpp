#include "hal/service/journal.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Listens as journald does, and has started this process.
class JournalTest : public testing::Test {
 protected:
  void SetUp() override {
    sockaddr_un at{};
    at.sun_family = AF_UNIX;
    std::memcpy(at.sun_path, path_.data(), path_.size());
    socket_ = Descriptor{socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    ASSERT_EQ(bind(socket_.number(), reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
    struct stat file{};
    ASSERT_EQ(fstat(STDERR_FILENO, &file), 0);
    set(std::to_string(file.st_dev) + ":" + std::to_string(file.st_ino));
  }
  void TearDown() override {
    unsetenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe): one thread
    unlink(path_.c_str());
  }
  static void set(const std::string& stream) {
    setenv("JOURNAL_STREAM", stream.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  }

  bool tell(const std::string& text, std::vector<Journal::Field> fields = {}) const {
    return Journal{path_.c_str()}.tell(Journal::Priority::warning, text, fields);
  }
  std::vector<std::string> heard() const {
    std::vector<std::string> datagrams;
    std::array<char, 1000> bytes{};
    for (;;) {
      const ssize_t count = recv(socket_.number(), bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (count <= 0) return datagrams;
      datagrams.emplace_back(bytes.data(), static_cast<std::size_t>(count));
    }
  }

  std::string path_ = "/tmp/cargobay-journal-" + std::to_string(getpid());
  Descriptor socket_{};
};

TEST_F(JournalTest, HasTheLineWithItsFields) {
  EXPECT_TRUE(Journal{path_.c_str()}.is_there());
  EXPECT_TRUE(
      tell("the port is gone", {{"CARGOBAY_PORT", "/dev/ttyUSB0"}, {"CARGOBAY_FRAMES", "7"}}));
  EXPECT_THAT(heard(),
              ElementsAre("PRIORITY=4\nSYSLOG_IDENTIFIER=cargobay\nMESSAGE=the port is gone\n"
                          "CARGOBAY_PORT=/dev/ttyUSB0\nCARGOBAY_FRAMES=7\n"));
}

TEST_F(JournalTest, TakesNoFieldOutOfTheLinesOfAValue) {
  EXPECT_TRUE(tell("one\n_UID=0"));
  EXPECT_THAT(heard(), ElementsAre("PRIORITY=4\nSYSLOG_IDENTIFIER=cargobay\nMESSAGE\n" +
                                   std::string{"\x0a\0\0\0\0\0\0\0", 8} + "one\n_UID=0\n"));
}

TEST_F(JournalTest, HasNothingIfStandardErrorGoesElsewhere) {
  for (const char* stream : {"", "1:1", "nonsense"}) {
    set(stream);
    EXPECT_FALSE(tell("a line")) << stream;
  }
  unsetenv("JOURNAL_STREAM");  // NOLINT(concurrency-mt-unsafe): one thread
  EXPECT_FALSE(Journal{path_.c_str()}.is_there());
  EXPECT_FALSE(tell("a line"));
  EXPECT_THAT(heard(), IsEmpty());
}

TEST_F(JournalTest, IsNotWaitedFor) {
  EXPECT_FALSE(Journal{"/nobody/listens"}.tell(Journal::Priority::info, "a line", {}));
  const std::string too_long = "/" + std::string(sizeof(sockaddr_un::sun_path), 'x');
  EXPECT_FALSE(Journal{too_long.c_str()}.tell(Journal::Priority::info, "a line", {}));
  int taken = 0;
  while (tell("more than the socket takes") && taken < 5000) ++taken;
  EXPECT_LT(taken, 5000);
}

}  // namespace
}  // namespace cargobay::hal
