// A port's descriptor among the user's: out of their way, recognised, not kept by children.

#include "hal/file/port_descriptor.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "drive_fixture.hpp"
#include "hal/port/pty_transport.hpp"

namespace cargobay::test {
namespace {

using hal::PortDescriptor;

int open_null() { return open("/dev/null", O_RDWR | O_CLOEXEC); }

TEST(PortDescriptor, HasANumberThatNobodyGetsByAsking) {
  const PortDescriptor port = PortDescriptor::adopt(open_null());
  EXPECT_GE(port.number(), 100);
  EXPECT_NE(fcntl(port.number(), F_GETFD) & FD_CLOEXEC, 0);
  EXPECT_TRUE(port.still_open());
}

TEST(PortDescriptor, LeavesAloneWhatOthersOpenedUnderItsNumber) {
  const TemporaryFolder folder;
  const int file = open(folder.write("user", "").c_str(), O_RDWR | O_CLOEXEC);
  int number = -1;
  {
    const PortDescriptor port = PortDescriptor::adopt(open_null());
    number = port.number();
    ASSERT_EQ(dup2(file, number), number);
    EXPECT_FALSE(port.still_open());
  }
  EXPECT_GE(fcntl(number, F_GETFD), 0) << "closed what is not its own";
  close(number);
  close(file);
}

TEST(PortDescriptor, KnowsThatItWasClosed) {
  const PortDescriptor port = PortDescriptor::adopt(open_null());
  ASSERT_EQ(close(port.number()), 0);
  EXPECT_FALSE(port.still_open());
}

// Runs `check` in a child; true if it returned true.
template <typename Check>
bool holds_in_child(const Check& check) {
  const pid_t child = fork();
  if (child == 0) _exit(check() ? 0 : 1);
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
         WEXITSTATUS(status) == 0;
}

TEST(PortDescriptor, IsNotKeptByChildren) {
  const PortDescriptor port = PortDescriptor::adopt(open_null());
  const PortDescriptor borrowed = PortDescriptor::borrow(open_null());
  EXPECT_TRUE(holds_in_child(
      [&] { return fcntl(port.number(), F_GETFD) < 0 && fcntl(borrowed.number(), F_GETFD) < 0; }));
  EXPECT_TRUE(port.still_open());
  EXPECT_TRUE(borrowed.still_open());
  close(borrowed.number());
}

class OwnedPort : public DriveTest {};

TEST_F(OwnedPort, IsFreeWhereAChildOutlivesItsParent) {
  int ready[2];  // NOLINT(cppcoreguidelines-avoid-c-arrays,modernize-avoid-c-arrays): pipe(2)'s
  ASSERT_EQ(pipe2(ready, O_CLOEXEC), 0);
  const pid_t parent = fork();
  if (parent == 0) {
    auto stream = hal::open_pty(port_, 57600);
    const pid_t child = stream ? fork() : -1;
    if (child == 0) {
      const pid_t self = getpid();
      (void)!write(ready[1], &self, sizeof self);
      pause();
    }
    pause();  // to be killed: nothing is released
  }
  pid_t child = -1;
  ASSERT_EQ(read(ready[0], &child, sizeof child), static_cast<ssize_t>(sizeof child));
  kill(parent, SIGKILL);
  ASSERT_EQ(waitpid(parent, nullptr, 0), parent);
  const auto next = hal::open_pty(port_, 57600);
  EXPECT_TRUE(next) << next.failure().message;
  kill(child, SIGKILL);
  close(ready[0]);
  close(ready[1]);
}

TEST(StandardNumbers, AreTakenForAWhile) {
  EXPECT_TRUE(holds_in_child([] {
    for (const int number : {0, 1, 2}) close(number);
    int opened = -1;
    {
      const hal::StandardNumbersTaken taken;
      opened = open_null();
    }
    return opened > 2 && fcntl(0, F_GETFD) < 0 && fcntl(1, F_GETFD) < 0 && fcntl(2, F_GETFD) < 0;
  }));
}

}  // namespace
}  // namespace cargobay::test
