// `cargobay teleop` and `top`: through a service of their own and through that of `cargobay serve`.
// However a person's command ends, the robot stands.
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command.hpp"
#include "feed_fixture.hpp"
#include "temporary_path.hpp"

namespace cargobay::test {
namespace {

using testing::HasSubstr;
using testing::Not;

// A command on a terminal of its own, and a finger on one of its keys.
class Person {
 public:
  explicit Person(std::vector<std::string> arguments)
      : command_{std::move(arguments), {.output = Command::Setup::Output::terminal}} {}

  Command& command() { return command_; }
  // Until `condition`, or for too long.
  template <typename Condition>
  bool holds(std::string_view key, Condition condition) {
    return eventually([&] {
      command_.type(key);
      poll(nullptr, 0, 30);  // as often as a terminal repeats it
      return !command_.running() || condition();
    });
  }
  bool shows(const std::string& text) {
    return eventually([&] {
      (void)command_.running();
      return command_.out().find(text) != std::string::npos;
    });
  }

 private:
  Command command_;
};

class TeleopTest : public DriveTest {
 protected:
  void SetUp() override {
    setenv("TERM", "xterm", 1);  // NOLINT(concurrency-mt-unsafe): one thread
    DriveTest::SetUp();
  }
  bool rolls() const { return server_->snapshot().truth.speeds.left_mm_s > 100.0; }
  std::vector<std::string> teleop(std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"teleop", "--port", port_, "--config", "/dev/null"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  // Owns the robot until the end of the test.
  void serve_robot() {
    service_ = std::make_unique<Command>(
        std::vector<std::string>{"serve", "--port", port_, "--config", "/dev/null", "--no-http"});
    ASSERT_TRUE(eventually([&] {
      return !service_->running() || service_->out().find("serving ") != std::string::npos;
    }));
    ASSERT_TRUE(service_->running()) << service_->err();
  }
  std::unique_ptr<Command> service_{};
};

TEST_F(TeleopTest, DrivesWhileAKeyIsHeldAndStandsWhenItIsNot) {
  Person person{teleop()};
  ASSERT_TRUE(person.holds("w", [&] { return rolls(); })) << person.command().err();
  ASSERT_TRUE(person.command().running()) << person.command().err();
  // The finger is off the key.
  EXPECT_TRUE(eventually([&] { return stands_still(); }));
  EXPECT_TRUE(person.command().running());
  person.command().type("q");
  EXPECT_EQ(person.command().exit_code(), 0) << person.command().err();
  EXPECT_TRUE(stands_still());
  EXPECT_EQ(mode(), oi::Mode::passive) << "a robot of our own is left as a drive leaves it";
}

TEST_F(TeleopTest, TheSpaceBarEndsWhatAKeyBegan) {
  Person person{teleop()};
  ASSERT_TRUE(person.holds("\x1b[A", [&] { return rolls(); })) << person.command().err();
  person.command().type(" ");
  EXPECT_TRUE(eventually([&] { return stands_still(); }));
  const std::size_t before = drives().size();
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(person.holds("w ", [] { return true; }) && rolls());
  const auto all = drives();
  EXPECT_TRUE(std::all_of(all.begin() + static_cast<std::ptrdiff_t>(before), all.end(),
                          [](const auto& each) { return each.command.left_mm_s <= 0.0; }));
}

struct Ending {
  const char* name;
  int signal;  // 0: its terminal goes away
};
// By googletest's rules.
// NOLINTNEXTLINE(readability-identifier-naming)
void PrintTo(const Ending& ending, std::ostream* out) { *out << ending.name; }

class TeleopEndTest : public TeleopTest, public testing::WithParamInterface<Ending> {
 protected:
  static void end(Command& command) {
    if (GetParam().signal == 0) {
      command.close_terminal();
    } else {
      command.send(GetParam().signal);
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Each, TeleopEndTest,
                         testing::Values(Ending{"terminal_gone", 0}, Ending{"interrupted", SIGINT},
                                         Ending{"terminated", SIGTERM},
                                         Ending{"control_z", SIGTSTP}, Ending{"killed", SIGKILL},
                                         Ending{"suspended", SIGSTOP}),
                         [](const auto& each) { return each.param.name; });

TEST_P(TeleopEndTest, LeavesItsOwnRobotStanding) {
  Person person{teleop()};
  ASSERT_TRUE(person.holds("w", [&] { return rolls(); })) << person.command().err();
  end(person.command());
  EXPECT_TRUE(eventually([&] { return stands_still(); }));
}

TEST_P(TeleopEndTest, LeavesTheRobotOfAServiceStandingAndItsLeaseFree) {
  serve_robot();
  Person person{teleop()};
  ASSERT_TRUE(person.holds("w", [&] { return rolls(); })) << person.command().err();
  end(person.command());
  EXPECT_TRUE(eventually([&] { return stands_still(); }));
  // One that hangs keeps its lease for some seconds; then anybody may have it.
  ASSERT_TRUE(eventually([&] {
    Person next{teleop()};
    const bool steers =
        next.holds("d", [&] { return server_->snapshot().truth.speeds.left_mm_s > 20.0; });
    return steers && next.command().running();
  }));
  EXPECT_EQ(mode(), oi::Mode::safe) << "the service still drives it";
}

TEST_F(TeleopTest, TakesTheLeaseOnlyWhenToldTo) {
  serve_robot();
  Person first{teleop()};
  ASSERT_TRUE(first.shows("You steer"));
  Command refused{teleop(), {.output = Command::Setup::Output::terminal}};
  EXPECT_EQ(refused.exit_code(), 1);
  EXPECT_THAT(refused.err(), HasSubstr("--take takes it from them"));
  EXPECT_THAT(refused.err(), HasSubstr("teleop on "));
  Person second{teleop({"--take"})};
  ASSERT_TRUE(second.shows("You steer"));
  EXPECT_TRUE(first.shows("t takes it from them"));
  // The keys of the first one move nothing now.
  for (int i = 0; i < 20; ++i) first.command().type("w");
  ASSERT_TRUE(
      second.holds("s", [&] { return server_->snapshot().truth.speeds.left_mm_s < -100.0; }));
  // A stop is everyone's.
  ASSERT_TRUE(eventually([&] {
    first.command().type(" ");
    return first.command().running() && second.command().running() && stands_still();
  }));
}

// Its own name says nothing: another machine may have one with the same number.
TEST_F(TeleopTest, NoticesThatOneOfItsNameSteers) {
  serve_robot();
  Person person{teleop()};
  ASSERT_TRUE(person.holds("w", [&] { return rolls(); })) << person.command().err();
  Watcher watcher{port_};
  const json name = watcher.next("holder")["name"];
  ASSERT_EQ(watcher.ask({{"do", "hold"}, {"name", name}, {"take", true}})["ok"], true);
  EXPECT_TRUE(person.shows("t takes it from them")) << name;
  EXPECT_TRUE(eventually([&] { return stands_still(); }));
  for (int i = 0; i < 20; ++i) person.command().type("w");
  EXPECT_EQ(watcher.ask({{"do", "drive"}, {"left_mm_s", 0}, {"right_mm_s", 0}})["ok"], true);
  EXPECT_TRUE(stands_still());
}

TEST_F(TeleopTest, RefusesARobotThatDrivesByItself) {
  Command drive{{"drive", "--port", port_, "--duration", "600", "--config", "/dev/null"}};
  ASSERT_TRUE(starts_to_move());
  Command command{teleop(), {.output = Command::Setup::Output::terminal}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), HasSubstr("drives " + port_ + " by itself"));
  EXPECT_TRUE(drive.running());
}

TEST_F(TeleopTest, SaysWhyItsOwnRobotCannotBeDriven) {
  const TemporaryFolder folder;
  Command command{{"teleop", "--port", folder.path("nothing"), "--config", "/dev/null"},
                  kOnTerminal};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), HasSubstr("no such port"));
}

// What is typed while it hangs was meant for then.
TEST_F(TeleopTest, ForgetsWhatWasTypedWhileItWasSuspended) {
  serve_robot();
  Person person{teleop()};
  ASSERT_TRUE(person.holds("w", [&] { return rolls(); })) << person.command().err();
  person.command().send(SIGSTOP);
  ASSERT_TRUE(eventually([&] { return stands_still(); }));
  for (int i = 0; i < 10; ++i) person.command().type("w");
  const std::size_t before = drives().size();
  person.command().send(SIGCONT);
  const auto half_a_second = server_->snapshot().time + std::chrono::milliseconds{500};
  ASSERT_TRUE(eventually(
      [&] { return person.command().running() && server_->snapshot().time > half_a_second; }));
  const auto all = drives();
  EXPECT_TRUE(std::all_of(all.begin() + static_cast<std::ptrdiff_t>(before), all.end(),
                          [](const auto& each) { return each.command.left_mm_s == 0.0; }));
}

TEST_F(TeleopTest, NeedsATerminal) {
  Command command{teleop()};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), HasSubstr("needs a terminal"));
  EXPECT_TRUE(drives().empty());
}

TEST_F(TeleopTest, TopPrintsLinesWithoutATerminal) {
  serve_robot();
  Command top{{"top", "--port", port_, "--config", "/dev/null"}};
  ASSERT_TRUE(eventually([&] {
    (void)top.running();
    return std::ranges::count(top.out(), '\n') >= 2;
  }));
  top.send(SIGINT);
  EXPECT_EQ(top.exit_code(), 0) << top.err();
  EXPECT_THAT(top.out(), HasSubstr("safe"));
  EXPECT_THAT(top.out(), HasSubstr("steered by nobody"));
  EXPECT_THAT(top.out(), Not(HasSubstr("\x1b")));
}

TEST_F(TeleopTest, TopEndsWithTheServiceAndSaysWhy) {
  serve_robot();
  Person top{{"top", "--port", port_, "--config", "/dev/null"}};
  ASSERT_TRUE(top.shows("good"));
  service_->send(SIGTERM);
  EXPECT_EQ(top.command().exit_code(), 1);
  EXPECT_THAT(top.command().err(), HasSubstr("has ended"));
}

}  // namespace
}  // namespace cargobay::test
