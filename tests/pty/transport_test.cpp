#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hal/port/pty_transport.hpp"
#include "hal/port/tty_speed.hpp"

namespace cargobay::hal {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using Bytes = std::vector<std::uint8_t>;
using Wait = ByteStream::Wait;

// The robot's end of a port, and the settings of the port.
class Pty : public testing::Test {
 protected:
  void SetUp() override {
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_GE(master_, 0);
    ASSERT_EQ(grantpt(master_), 0);
    ASSERT_EQ(unlockpt(master_), 0);
    std::array<char, 64> name{};
    ASSERT_EQ(ptsname_r(master_, name.data(), name.size()), 0);
    path_ = name.data();
    slave_ = open(path_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_GE(slave_, 0);
  }
  void TearDown() override {
    close(slave_);
    hang_up();
  }

  void hang_up() {
    if (master_ >= 0) close(master_);
    master_ = -1;
  }
  void say(const Bytes& bytes) const {
    ASSERT_EQ(write(master_, bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  Bytes hear(std::size_t count) const {
    Bytes bytes(count);
    const ssize_t got = read(master_, bytes.data(), bytes.size());
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }
  termios settings() const {
    termios found{};
    tcgetattr(slave_, &found);
    return found;
  }
  bool is_exclusive() const {
    int exclusive = -1;
    ioctl(slave_, TIOCGEXCL, &exclusive);
    return exclusive == 1;
  }

  int master_ = -1;
  int slave_ = -1;  // to look at its settings
  std::string path_;
};

TEST_F(Pty, IsRawAndAtItsRate) {
  const auto stream = open_pty(path_, 28800);
  ASSERT_TRUE(stream) << stream.failure().message;
  EXPECT_EQ((*stream)->baud(), 28800U);
  EXPECT_EQ(tty_speed(slave_), 28800U);
  EXPECT_EQ(settings().c_lflag & static_cast<tcflag_t>(ICANON | ECHO | ISIG), 0U);
  EXPECT_EQ(settings().c_oflag & static_cast<tcflag_t>(OPOST), 0U);
  ASSERT_FALSE((*stream)->set_baud(19200));
  EXPECT_EQ(tty_speed(slave_), 19200U);
}

// No byte has a meaning to the terminal: not 3, not 4, not 13, not 17 or 19.
TEST_F(Pty, CarriesEveryByteBothWays) {
  const auto stream = open_pty(path_, 57600);
  ASSERT_TRUE(stream);
  Bytes all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  EXPECT_EQ((*stream)->write(all).count, all.size());
  EXPECT_EQ(hear(1000), all);
  say(all);
  Bytes heard;
  Bytes chunk(1000);
  while (heard.size() < all.size() && (*stream)->wait(rt::Clock::now() + 10s) == Wait::ready) {
    const auto transfer = (*stream)->read(chunk);
    heard.insert(heard.end(), chunk.begin(),
                 chunk.begin() + static_cast<std::ptrdiff_t>(transfer.count));
  }
  EXPECT_EQ(heard, all);
}

TEST_F(Pty, WakesForAWholeFrame) {
  const auto stream = open_pty(path_, 57600);
  ASSERT_TRUE(stream);
  ASSERT_FALSE((*stream)->set_wake_threshold(13));
  EXPECT_EQ((*stream)->baud(), 57600U);
  EXPECT_EQ(tty_speed(slave_), 57600U) << "and stays at its rate";
  say(Bytes(12));
  EXPECT_EQ((*stream)->wait(rt::Clock::now() + 20ms), Wait::timed_out);
  Bytes bytes(100);
  EXPECT_EQ((*stream)->read(bytes).count, 12U) << "fewer can be read all the same";
  say(Bytes(13));
  EXPECT_EQ((*stream)->wait(rt::Clock::now() + 10s), Wait::ready);
}

TEST_F(Pty, TimesOutAtADeadlineInThePast) {
  const auto stream = open_pty(path_, 57600);
  ASSERT_TRUE(stream);
  EXPECT_EQ((*stream)->wait(rt::Clock::now() - 1s), Wait::timed_out);
  say({1});
  EXPECT_EQ((*stream)->wait(rt::Clock::now() + 10s), Wait::ready);
  EXPECT_EQ((*stream)->wait(rt::Clock::now() - 1s), Wait::ready) << "what is there is there";
}

TEST_F(Pty, ReadsNothingWithoutBlocking) {
  const auto stream = open_pty(path_, 57600);
  ASSERT_TRUE(stream);
  Bytes bytes(10);
  const auto transfer = (*stream)->read(bytes);
  EXPECT_EQ(transfer.count, 0U);
  EXPECT_EQ(transfer.error, 0);
}

TEST_F(Pty, HangsUpForGood) {
  const auto stream = open_pty(path_, 57600);
  ASSERT_TRUE(stream);
  hang_up();
  for (int i = 0; i < 3; ++i) EXPECT_EQ((*stream)->wait(rt::Clock::now() + 10s), Wait::hung_up);
  EXPECT_NE((*stream)->write(Bytes{128}).error, 0);
}

TEST_F(Pty, DropsWhatCameBefore) {
  say({1, 2, 3});
  const auto stream = open_pty(path_, 57600);
  ASSERT_TRUE(stream);
  EXPECT_EQ((*stream)->wait(rt::Clock::now() + 5ms), Wait::timed_out);
}

// Nothing reads at the other end: the queue fills, and says so; nothing waits.
TEST_F(Pty, TakesWhatThereIsRoomFor) {
  const auto stream = open_pty(path_, 57600);
  ASSERT_TRUE(stream);
  const Bytes much(10'000, 128);
  std::size_t taken = 0;
  for (int i = 0; i < 100; ++i) {
    const auto transfer = (*stream)->write(much);
    taken += transfer.count;
    if (transfer.error != 0) {
      EXPECT_EQ(transfer.error, EAGAIN);
      break;
    }
  }
  EXPECT_GT(taken, 0U);
  EXPECT_LT(taken, 1'000'000U);
}

TEST_F(Pty, IsForOneAlone) {
  auto stream = open_pty(path_, 57600);
  ASSERT_TRUE(stream);
  EXPECT_TRUE(is_exclusive());
  const auto second = open_pty(path_, 19200);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.failure().code.value(), EBUSY);
  EXPECT_TRUE(is_exclusive()) << "who is refused takes nothing from who has it";
  EXPECT_EQ(tty_speed(slave_), 57600U) << "and changes nothing";
  stream->reset();
  EXPECT_FALSE(is_exclusive());
  EXPECT_TRUE(open_pty(path_, 57600));
}

// The search never finds this process among the users: an unseen process releases the port.
TEST_F(Pty, IsAskedForAgainWhereNobodyIsSeenToHaveIt) {
  auto first = open_pty(path_, 57600);
  ASSERT_TRUE(first);
  std::thread lets_go{[&first] {
    std::this_thread::sleep_for(70ms);  // the first look is over
    first->reset();
  }};
  const auto second = open_pty(path_, 57600);
  lets_go.join();
  EXPECT_TRUE(second) << second.failure().message;
}

// A user's own terminal, named by mistake.
TEST_F(Pty, IsGivenBackAsItWasFound) {
  termios before = settings();
  before.c_lflag |= static_cast<tcflag_t>(ICANON | ECHO | ISIG);
  cfsetspeed(&before, B9600);
  ASSERT_EQ(tcsetattr(slave_, TCSANOW, &before), 0);
  before = settings();
  {
    const auto stream = open_pty(path_, 57600);
    ASSERT_TRUE(stream);
    ASSERT_FALSE((*stream)->set_wake_threshold(13));
    EXPECT_NE(settings().c_lflag, before.c_lflag);
  }
  const termios after = settings();
  EXPECT_EQ(after.c_iflag, before.c_iflag);
  EXPECT_EQ(after.c_oflag, before.c_oflag);
  EXPECT_EQ(after.c_lflag, before.c_lflag);
  EXPECT_EQ(after.c_cflag, before.c_cflag);
  EXPECT_EQ(after.c_cc[VMIN], before.c_cc[VMIN]);
  EXPECT_EQ(tty_speed(slave_), 9600U);
}

}  // namespace
}  // namespace cargobay::hal
