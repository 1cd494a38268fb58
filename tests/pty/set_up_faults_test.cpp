// The commonest faults of setting up a port, each with the message that a new user is to find it
// by: the whole command, on a pseudo-terminal. Those of wiring are in virtual time
// (tests/hal/bring_up/wiring_faults_test.cpp).
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <functional>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// What another device at the other end does with what it is sent.
class OtherDevice {
 public:
  using Answer = std::function<std::string(std::string_view)>;

  explicit OtherDevice(Answer answer)
      : master_{posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)}, answer_{std::move(answer)} {
    std::array<char, 64> name{};
    if (grantpt(master_) != 0 || unlockpt(master_) != 0 ||
        ptsname_r(master_, name.data(), name.size()) != 0)
      return;
    path_ = name.data();
    slave_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);  // so that polling can wait
    termios settings{};
    tcgetattr(slave_, &settings);
    cfmakeraw(&settings);
    tcsetattr(slave_, TCSANOW, &settings);
    thread_ = std::thread{[this] { run(); }};
  }
  ~OtherDevice() {
    ending_ = true;
    if (thread_.joinable()) thread_.join();
    close(slave_);
    close(master_);
  }
  OtherDevice(const OtherDevice&) = delete;
  OtherDevice& operator=(const OtherDevice&) = delete;

  const std::string& path() const { return path_; }

 private:
  void run() {
    while (!ending_) {
      pollfd master{.fd = master_, .events = POLLIN, .revents = 0};
      if (poll(&master, 1, 20) <= 0) continue;
      std::array<char, 512> bytes{};
      const ssize_t count = read(master_, bytes.data(), bytes.size());
      if (count <= 0) continue;
      const std::string text = answer_({bytes.data(), static_cast<std::size_t>(count)});
      if (write(master_, text.data(), text.size()) < 0) return;
    }
  }

  int master_ = -1;
  int slave_ = -1;
  Answer answer_;
  std::string path_;
  std::atomic<bool> ending_ = false;
  std::thread thread_;
};

std::string complaint_of(const std::vector<std::string>& arguments,
                         const Command::Setup& setup = {}) {
  Command command{arguments, setup};
  EXPECT_EQ(command.exit_code(), 1);
  std::printf("%s", command.err().c_str());
  EXPECT_THAT(command.err(), OneErrorLine(""));
  return command.err();
}

TEST(SetUpFaults, ALoopbackPlug) {
  const OtherDevice plug{[](std::string_view bytes) { return std::string{bytes}; }};
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"drive"}, {"sensors", "--json"}, {"sensors", "--packets", "7"}, {"send", "start"}}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"--port", plug.path()});
    EXPECT_THAT(complaint_of(all),
                HasSubstr("what is sent at 57600 baud comes back, and no robot answers"))
        << words[0];
  }
}

TEST(SetUpFaults, TheConsoleOfAnotherComputer) {
  const OtherDevice console{
      [](std::string_view typed) { return std::string{typed} + "\r\nraspberrypi login: "; }};
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"drive"}, {"sensors"}, {"send", "sensors", "7"}}) {
    std::vector<std::string> all = words;
    all.insert(all.begin() + 1, {"--port", console.path()});
    const std::string text = complaint_of(all);
    EXPECT_THAT(text, HasSubstr("a login prompt is at this port and no robot")) << words[0];
    EXPECT_THAT(text, Not(HasSubstr("may be moving"))) << words[0];
  }
}

TEST(SetUpFaults, APortThatIsNotThere) {
  EXPECT_THAT(complaint_of({"drive", "--port", "/dev/ttyUSB77"}),
              HasSubstr("no such port; plug the cable in, or list the ports with: cargobay ports"));
}

TEST(SetUpFaults, APortThatTheUserMayNotOpen) {
  const OtherDevice port{[](std::string_view) { return std::string{}; }};
  ASSERT_EQ(chmod(port.path().c_str(), 0600), 0);
  if (geteuid() != 0) GTEST_SKIP() << "only root has ports that others may not open";
  EXPECT_THAT(
      complaint_of({"drive", "--port", port.path()}, {.user = Command::Setup::User::nobody}),
      HasSubstr("permission denied; join the group that owns it (sudo adduser $USER "
                "dialout) and log in again"));
}

// Opening and closing the port moves RTS and DTR, whatever the command does in between.
TEST(SetUpFaults, APowerTogglesInverterOnDtr) {
  const OtherDevice port{[](std::string_view) { return std::string{}; }};
  const TemporaryFolder folder;
  const std::string file = folder.path("c.toml");
  std::ofstream{file} << "port = '" << port.path()
                      << "'\n[pins.power]\nline = 'dtr'\nactive_low = true\n";
  for (const char* const command : {"drive", "sensors"}) {
    EXPECT_THAT(complaint_of({command, "--config", file}),
                HasSubstr("switch the robot on or off each time that the port is opened"));
  }
  EXPECT_THAT(complaint_of({"send", "--config", file, "start"}), HasSubstr("each time that"));
}

TEST(SetUpFaults, BrcOnRtsOfAPortThatHasNone) {
  const OtherDevice port{[](std::string_view) { return std::string{}; }};
  const std::string text =
      complaint_of({"bringup", "--port", port.path(), "--baud", "19200", "--brc-line", "rts"});
  EXPECT_THAT(text, HasSubstr("RTS or DTR of the port cannot be set"));
  EXPECT_THAT(text, Not(HasSubstr("may be moving"))) << "nothing was sent";
}

}  // namespace
}  // namespace cargobay::test
