// Another process reads the robot's port, unlocked, during a drive.
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

#include "drive_fixture.hpp"
#include "tests/pty/shell.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// It has the port open from the beginning, like a login prompt.
std::string holding(const std::string& port) {
  return "exec 3<>" + port + "; while :; do head -c 5 <&3 >/dev/null; sleep 0.05; done";
}

// It opens the port for as long as reading takes, with a new process each time. Only root can while
// a drive has the port for itself.
std::string opening(const std::string& port) {
  return "while :; do head -c 90 " + port + " >/dev/null; sleep 0.2; done";
}

class PortSharedTest : public DriveTest {
 public:
  // The drive prints lines.
  // NOLINTNEXTLINE(concurrency-mt-unsafe): one thread
  PortSharedTest() { setenv("TERM", "dumb", 1); }
};

TEST_F(PortSharedTest, IsNamedIfItOpensThePortNowAndThen) {
  if (geteuid() != 0) GTEST_SKIP() << "only root opens a port that another process has";
  Command command{drive({"--duration", "60"}), kOnTerminal};
  ASSERT_TRUE(starts_to_move());
  const Shell thief{opening(port_)};
  EXPECT_TRUE(eventually([&] {
    (void)command.running();
    return command.out().find("head (process ") != std::string::npos;
  })) << command.out();
  thief.stop();
  command.send(SIGINT);
  (void)command.exit_code();
  const std::string& out = command.out();
  EXPECT_EQ(out.find("head (process "), out.rfind("head (process ")) << "once, not each process";
  EXPECT_TRUE(stands_still());
}

TEST_F(PortSharedTest, TheDoctorSaysThatADriveHasThePort) {
  const Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  Command doctor{{"doctor", "--port", port_}};
  EXPECT_EQ(doctor.exit_code(), 1);
  EXPECT_THAT(doctor.out(), Not(HasSubstr("you may open")));
  EXPECT_THAT(doctor.out(), HasSubstr("but not now: cargobay (process " +
                                      std::to_string(command.process()) + ") holds it"));
}

TEST_F(PortSharedTest, IsNamedWithItsNumberAndARemedy) {
  const Shell thief{holding(port_)};
  ASSERT_TRUE(eventually([&] {
    Command doctor{{"doctor", "--port", port_}};
    return doctor.exit_code() == 1 && doctor.out().find(thief.name()) != std::string::npos;
  })) << "the shell does not open the port";
  thief.stop();                                               // the bring-up is not under test
  Command command{drive({"--duration", "60"}), kOnTerminal};  // a line at a time
  ASSERT_TRUE(starts_to_move());
  EXPECT_THAT(command.out(), Not(HasSubstr(thief.name()))) << "no frame is missing";
  thief.go_on();
  EXPECT_TRUE(eventually([&] {
    (void)command.running();
    return command.out().find(thief.name() + " also has the port open") != std::string::npos;
  })) << command.out();
  EXPECT_THAT(command.out(), HasSubstr("log out there"));
  thief.stop();
  command.send(SIGINT);
  (void)command.exit_code();  // other consequences of the missing bytes are not under test
  EXPECT_TRUE(stands_still());
}

}  // namespace
}  // namespace cargobay::test
