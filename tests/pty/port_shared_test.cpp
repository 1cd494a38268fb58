// Another process reads the robot's port, unlocked, during a drive.
#include <spawn.h>
#include <sys/wait.h>

#include <csignal>
#include <cstdlib>
#include <string>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// A shell that has the port open from the beginning, like a login prompt, and takes some bytes now
// and then.
class Thief {
 public:
  explicit Thief(const std::string& port) {
    std::string script =
        "exec 3<>" + port + "; while :; do head -c 5 <&3 >/dev/null; sleep 0.05; done";
    std::string shell = "sh";
    std::string option = "-c";
    char* const words[] = {shell.data(), option.data(), script.data(), nullptr};
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    if (posix_spawn(&process_, "/bin/sh", nullptr, &attributes, words, environ) != 0) process_ = -1;
    posix_spawnattr_destroy(&attributes);
  }
  ~Thief() {
    if (process_ <= 0) return;
    kill(-process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  Thief(const Thief&) = delete;
  Thief& operator=(const Thief&) = delete;

  std::string name() const { return "sh (process " + std::to_string(process_) + ")"; }
  void stop() const { kill(-process_, SIGSTOP); }
  void go_on() const { kill(-process_, SIGCONT); }

 private:
  pid_t process_ = -1;
};

class PortSharedTest : public DriveTest {};

TEST_F(PortSharedTest, IsNamedWithItsNumberAndARemedy) {
  const Thief thief{port_};
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
