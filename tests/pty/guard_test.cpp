// What happens to the robot if its program does not end properly: the guard's work. How long that
// takes is measured by a campaign (tests/guard).

#include "hal/guard/guard.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <thread>

#include "drive_fixture.hpp"
#include "hal/port/pty_transport.hpp"

namespace cargobay::test {
namespace {

class GuardTest : public DriveTest {
 protected:
  bool is_stopped() const {
    return eventually([this] { return mode() == oi::Mode::passive; }) && stands_still();
  }
  // Brings the robot into Full mode, turning its wheels, on a port of our own.
  std::unique_ptr<hal::ByteStream> open_and_move() {
    auto stream = hal::open_pty(port_, 57600);
    EXPECT_TRUE(stream) << stream.failure().message;
    const std::array<std::uint8_t, 7> bytes{128, 132, 145, 0, 100, 0, 100};
    EXPECT_EQ((*stream)->write(bytes).count, bytes.size());
    EXPECT_TRUE(starts_to_move());
    return std::move(*stream);
  }
  static std::unique_ptr<hal::Guard> guard_over(const hal::ByteStream& stream) {
    auto guard = hal::Guard::start(stream.terminal(), {}, 0, 57600);
    EXPECT_TRUE(guard) << guard.failure().message;
    return std::move(*guard);
  }
  static pid_t guard_of(const Command& command) {
    const std::string process = std::to_string(command.process());
    const std::string children = contents("/proc/" + process + "/task/" + process + "/children");
    return static_cast<pid_t>(std::strtol(children.c_str(), nullptr, 10));
  }
  // A thread that drives, calls this, and disappears without notice.
  static void drive_and_vanish(hal::Guard& guard, const std::function<void(hal::GuardMark)>& deed) {
    std::thread thread{[&] {
      guard.begin_driving();
      deed(guard.mark());
    }};
    thread.join();
  }
};

TEST_F(GuardTest, StopsTheRobotOfADriveThatIsKilled) {
  for (const int signal : {SIGKILL, SIGSEGV, SIGABRT}) {
    Command command{drive({"--duration", "60"})};
    ASSERT_TRUE(starts_to_move());
    command.send(signal);
    EXPECT_NE(command.exit_code(), 0) << "a sanitizer makes an exit of a fault";
    EXPECT_TRUE(is_stopped()) << signal;
  }
}

TEST_F(GuardTest, LeavesThePortToTheNext) {
  Command killed{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  killed.send(SIGKILL);
  ASSERT_TRUE(is_stopped());
  EXPECT_TRUE(eventually([this] {
    Command next{drive({"--duration", "0.3"}), kNobody};  // another user, whom TIOCEXCL would stop
    return next.exit_code() == 0;
  }));
}

// The guard is still at work, and the port is free right afterwards: no human needs to try again.
TEST_F(GuardTest, IsWaitedForByWhoOpensThePortNext) {
  for (int i = 0; i < 5; ++i) {
    Command killed{drive({"--duration", "60"})};
    ASSERT_TRUE(starts_to_move());
    killed.send(SIGKILL);
    const auto next = hal::open_pty(port_, 57600);
    EXPECT_TRUE(next) << next.failure().message;
    EXPECT_EQ(mode(), oi::Mode::passive) << "opened before the guard was done";
  }
}

TEST_F(GuardTest, StopsTheRobotOfADriveThatIsSuspended) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  command.send(SIGSTOP);
  EXPECT_TRUE(is_stopped());
  const std::size_t before = drives().size();
  command.send(SIGCONT);
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("the robot was stopped by its guard"));
  EXPECT_EQ(drives().size(), before) << "it has no more to say";
  EXPECT_EQ(mode(), oi::Mode::passive);
}

TEST_F(GuardTest, EndsWithTheDriveItWatches) {
  Command command{drive({"--duration", "0.5"})};
  ASSERT_TRUE(starts_to_move());
  EXPECT_EQ(command.exit_code(), 0);
  const auto stream = hal::open_pty(port_, 57600);  // locked as long as a guard has it
  EXPECT_TRUE(stream) << stream.failure().message;
}

// Zeros complete what is left of a command. Without them the stop would be taken for data: 145 0
// 100 and then 145 0, which is full speed back on the left.
TEST_F(GuardTest, CompletesAHalfSentCommand) {
  const auto stream = open_and_move();
  const auto guard = guard_over(*stream);
  drive_and_vanish(*guard, [&stream](hal::GuardMark mark) {
    const std::array<std::uint8_t, 3> half{145, 0, 100};
    EXPECT_TRUE(mark.begin_write(5));
    EXPECT_EQ(stream->write(half).count, half.size());
  });
  EXPECT_TRUE(is_stopped());
  for (const hal::sim::DriveRecord& record : drives()) {
    EXPECT_LE(std::abs(record.command.left_mm_s), 100.0);
    EXPECT_LE(std::abs(record.command.right_mm_s), 100.0);
  }
  EXPECT_TRUE(guard->took_robot());
  EXPECT_EQ(guard->parting(), hal::Parting::standing);
}

TEST_F(GuardTest, StopsARobotThatMissedTheFirstStop) {
  const auto stream = open_and_move();
  const auto guard = guard_over(*stream);
  server_->with_cable([](hal::sim::Cable& cable) { cable.device().take_half_command(); });
  drive_and_vanish(*guard, [](hal::GuardMark) {});
  EXPECT_TRUE(is_stopped());
}

// Only the guard itself can make this count larger.
TEST_F(GuardTest, SeldomWakesForAnOwnerThatMovesNothing) {
  const auto stream = hal::open_pty(port_, 57600);
  ASSERT_TRUE(stream) << stream.failure().message;
  const auto guard = hal::Guard::start((*stream)->terminal(),
                                       {.moves = hal::GuardOptions::Moves::nothing}, 0, 57600);
  ASSERT_TRUE(guard) << guard.failure().message;
  const std::string children =
      contents("/proc/self/task/" + std::to_string(gettid()) + "/children");
  const std::string status = "/proc/" + children.substr(0, children.find(' ')) + "/status";
  const auto sleeps = [&status] {
    constexpr std::string_view kKey = "\nvoluntary_ctxt_switches:";
    const std::string text = contents(status);
    return std::strtol(text.c_str() + text.find(kKey) + kKey.size(), nullptr, 10);
  };
  const long before = sleeps();
  const rt::TimePoint began = rt::Clock::now();
  const rt::Duration start = server_->snapshot().time;
  ASSERT_TRUE(
      eventually([&] { return server_->snapshot().time > start + std::chrono::seconds{1}; }));
  const long after = sleeps();
  EXPECT_LE(after - before, 5 + (rt::Clock::now() - began) / std::chrono::milliseconds{100});
  EXPECT_GE(after - before, 2) << "it does look after it";
}

TEST_F(GuardTest, TakesNothingFromAThreadThatLeaves) {
  const auto stream = open_and_move();
  const auto guard = guard_over(*stream);
  guard->begin_driving();
  hal::GuardMark mark = guard->mark();
  EXPECT_EQ(mark.beat(rt::Clock::now()), hal::GuardMark::Robot::ours);
  guard->end_driving();
  EXPECT_FALSE(guard->took_robot());
  guard->release();
  EXPECT_FALSE(guard->alive());
  EXPECT_EQ(mode(), oi::Mode::full) << "it is the owner's to leave";
}

TEST_F(GuardTest, LetsNothingBeSentOnceItHasTakenTheRobot) {
  const auto stream = open_and_move();
  const auto guard = guard_over(*stream);
  drive_and_vanish(*guard, [](hal::GuardMark) {});
  ASSERT_TRUE(eventually([&guard] { return guard->took_robot(); }));
  EXPECT_EQ(guard->mark().beat(rt::Clock::now()), hal::GuardMark::Robot::taken);
  EXPECT_FALSE(guard->mark().begin_write(5));
}

TEST_F(GuardTest, IsMissedWhereItDies) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  const pid_t guard = guard_of(command);
  ASSERT_GT(guard, 0);
  kill(guard, SIGKILL);
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("the guard process died or was suspended"));
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

TEST_F(GuardTest, IsMissedWhereItIsSuspended) {
  Command command{drive({"--duration", "60"})};
  ASSERT_TRUE(starts_to_move());
  const pid_t guard = guard_of(command);
  ASSERT_GT(guard, 0);
  kill(guard, SIGSTOP);
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("the guard process died or was suspended"));
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
  EXPECT_FALSE(std::filesystem::exists("/proc/" + std::to_string(guard))) << "not left behind";
}

TEST_F(GuardTest, IsNotDoneWithout) {
  setenv("CARGOBAY_GUARD", "/nonexistent", 1);  // NOLINT(concurrency-mt-unsafe): one thread asks
  Command command{drive({"--duration", "0.3"})};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("would have no guard"));
  EXPECT_EQ(server_->snapshot().device.bytes_received, 0U) << "nothing is sent without a guard";
  Command on_its_own_risk{drive({"--duration", "0.3", "--no-guard"})};
  EXPECT_EQ(on_its_own_risk.exit_code(), 0) << on_its_own_risk.err();
  unsetenv("CARGOBAY_GUARD");  // NOLINT(concurrency-mt-unsafe): as above
}

TEST_F(GuardTest, RefusesADeadlineThatTheLoopCannotKeep) {
  for (const char* bad : {"39", "10001", "nan", "-1"}) {
    Command command{drive({"--guard-deadline", bad})};
    EXPECT_EQ(command.exit_code(), 1);
    EXPECT_THAT(command.err(), OneErrorLine("is not within 40 to 10000 ms"));
  }
}

TEST(GuardProgram, DoesNothingByHand) {
  // NOLINTNEXTLINE(bugprone-command-processor,concurrency-mt-unsafe): a fixed text
  const int status = std::system(CARGOBAY_BINARY_DIR "/cargobay-guard 2> /dev/null");
  EXPECT_EQ(WEXITSTATUS(status), 2);
}

}  // namespace
}  // namespace cargobay::test
