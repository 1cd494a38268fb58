// `cargobay serve --wait`: a robot that comes later than its service.

#include <csignal>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;

class ServeWaitTest : public DriveTest {
 protected:
  void SetUp() override { port_ = folder_.path("robot"); }

  std::vector<std::string> serve_command(std::vector<std::string> more = {}) const {
    std::vector<std::string> all{"serve", "--port", port_, "--config", "/dev/null", "--no-http"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  void plug_in() {
    auto server = hal::sim::Server::open({}, {.link = port_});
    ASSERT_TRUE(server) << server.failure().message;
    server_ = std::move(*server);
    ASSERT_FALSE(server_->start());
  }
  static bool serves(Command& command) {
    return eventually([&] {
             return !command.running() || command.out().find("serving ") != std::string::npos;
           }) &&
           command.running();
  }
  static bool says(Command& command, const std::string& text) {
    return eventually([&] {
             return !command.running() || command.err().find(text) != std::string::npos;
           }) &&
           command.running();
  }

  TemporaryFolder folder_;
};

TEST_F(ServeWaitTest, FailsWithoutIt) {
  plug_in();
  server_.reset();
  Command command{serve_command()};
  EXPECT_EQ(command.exit_code(), 1) << command.err();
  plug_in();  // for the fixture, which asks its robot in the end
}

TEST_F(ServeWaitTest, ServesAPortThatIsPluggedInLater) {
  Command command{serve_command({"--wait"})};
  ASSERT_TRUE(says(command, port_)) << command.err();
  EXPECT_EQ(command.out(), "") << "it serves no robot yet";
  plug_in();
  ASSERT_TRUE(serves(command)) << command.err();
  EXPECT_EQ(mode(), oi::Mode::safe);
  command.send(SIGTERM);
  EXPECT_EQ(command.exit_code(), 128 + SIGTERM) << command.err();
  EXPECT_EQ(mode(), oi::Mode::passive);
}

TEST_F(ServeWaitTest, KnowsThatPortAgain) {
  Command command{serve_command({"--wait"})};
  ASSERT_TRUE(says(command, port_)) << command.err();
  plug_in();
  ASSERT_TRUE(serves(command)) << command.err();
  server_.reset();  // the port hangs up
  ASSERT_TRUE(says(command, "hung up")) << command.err();
  plug_in();
  ASSERT_TRUE(eventually([&] { return command.running() && mode() == oi::Mode::safe; }))
      << command.err();
}

TEST_F(ServeWaitTest, EndsWhileItWaits) {
  Command command{serve_command({"--wait"})};
  ASSERT_TRUE(says(command, port_)) << command.err();
  command.send(SIGTERM);
  EXPECT_EQ(command.exit_code(), 128 + SIGTERM) << command.err();
  plug_in();
}

}  // namespace
}  // namespace cargobay::test
