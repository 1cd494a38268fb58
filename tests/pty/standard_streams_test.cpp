// Commands without a standard input, output or error; with one that nothing reads; and signals
// then.

#include <fcntl.h>

#include <array>
#include <csignal>

#include "drive_fixture.hpp"

namespace cargobay::test {
namespace {

using Words = std::vector<std::string>;

struct Spoken {
  const char* name;
  Words arguments;  // the port follows them
};

std::ostream& operator<<(std::ostream& out, const Spoken& spoken) { return out << spoken.name; }

class ClosedStreamsTest : public DriveTest, public testing::WithParamInterface<Spoken> {};

// The port would get the lowest free number.
TEST_P(ClosedStreamsTest, NeverBecomeThePort) {
  for (unsigned bits = 1; bits < 8; ++bits) {
    serve({});
    std::vector<std::string> words = GetParam().arguments;
    words.insert(words.end(), {"--port", port_});
    const std::array<bool, 3> closed{(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0};
    Command command{words, Setup{.closed = closed}};
    EXPECT_EQ(command.exit_code(), closed[1] ? 1 : 0) << bits << command.err();
    if (closed[1] && !closed[2]) {
      EXPECT_THAT(command.err(), OneErrorLine("cannot write to standard output"));
    }
    EXPECT_EQ(server_->snapshot().device.unknown_opcodes, 0U) << bits;
    EXPECT_GT(server_->snapshot().device.bytes_received, 0U) << bits;
    EXPECT_TRUE(stands_still()) << bits;
  }
}

const Spoken kCommands[]{
    {"Drive", {"drive", "--duration", "0.3"}},
    {"Bringup", {"bringup"}},
    {"Sensors", {"sensors", "--once"}},
    {"Send", {"send", "start; safe; sensors oi_mode; start"}},
};

INSTANTIATE_TEST_SUITE_P(Each, ClosedStreamsTest, testing::ValuesIn(kCommands),
                         [](const auto& tested) { return std::string{tested.param.name}; });

class UnreadOutputTest : public DriveTest, public testing::WithParamInterface<int> {
 protected:
  static constexpr Setup kUnread{.output = Setup::Output::unread};
};

TEST_P(UnreadOutputTest, DoesNotHoldUpTheEndOfSensors) {
  Command command{{"sensors", "--json", "--port", port_}, kUnread};
  ASSERT_TRUE(eventually([this] { return server_->snapshot().device.bytes_sent > 3000; }));
  command.send(GetParam());
  EXPECT_NE(command.exit_code(), Command::kHangs);
}

// `send` has no guard here: it has to stop the wheels itself.
TEST_P(UnreadOutputTest, DoesNotHoldUpTheStopOfSend) {
  Command command{
      {"send", "--port", port_, "--listen", "60", "start; safe; drive 200 straight; stream 0"},
      kUnread};
  ASSERT_TRUE(starts_to_move());
  ASSERT_TRUE(eventually([this] { return server_->snapshot().device.bytes_sent > 6000; }));
  command.send(GetParam());
  EXPECT_NE(command.exit_code(), Command::kHangs);
  EXPECT_TRUE(stands_still());
}

TEST_P(UnreadOutputTest, DoesNotHoldUpTheEndOfADrive) {
  const TemporaryFolder folder;
  const std::string fifo = folder.path("fifo");
  ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
  const int reader = open(fifo.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  Command command{drive({"--duration", "60", "--json", fifo}), kUnread};
  ASSERT_TRUE(starts_to_move());
  command.send(GetParam());
  EXPECT_EQ(command.exit_code(),
            128 + GetParam());  // it was blocked, so the thread ended it
  close(reader);
  EXPECT_EQ(mode(), oi::Mode::passive);
  EXPECT_TRUE(stands_still());
}

INSTANTIATE_TEST_SUITE_P(Each, UnreadOutputTest, testing::Values(SIGINT, SIGTERM),
                         [](const auto& tested) {
                           return std::string{"SIG"} + sigabbrev_np(tested.param);
                         });

TEST(StandardStreams, AreCheckedWhereHelpIsAskedFor) {
  Command command{{"--help"}, {.closed = {false, true, false}}};
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), OneErrorLine("cannot write to standard output"));
}

}  // namespace
}  // namespace cargobay::test
