// The rate of a terminal as seen by the programs at its two ends.
#include "hal/port/tty_speed.hpp"

#include <fcntl.h>
#include <termios.h>
#include <unistd.h>

#include <memory>

#include <gtest/gtest.h>

#include "hal/port/pty_transport.hpp"
#include "hal/sim/line/pty_port.hpp"
#include "oi/dialect.hpp"
#include "tests/pty/serial_client.hpp"

namespace cargobay::hal {
namespace {

using sim::PtyPort;
using sim::test::SerialClient;

// The termios constant for the rate; B0 if there is none.
speed_t constant_of(std::uint32_t baud) {
  switch (baud) {
    case 300: return B300;
    case 600: return B600;
    case 1200: return B1200;
    case 2400: return B2400;
    case 4800: return B4800;
    case 9600: return B9600;
    case 19200: return B19200;
    case 38400: return B38400;
    case 57600: return B57600;
    case 115200: return B115200;
    default: return B0;
  }
}

termios settings(int descriptor) {
  termios found{};
  EXPECT_EQ(tcgetattr(descriptor, &found), 0);
  return found;
}

// The bits with the rate of input: if clear, it is that of output, whoever sets that.
constexpr tcflag_t kInputRate = static_cast<tcflag_t>(CIBAUD);

std::unique_ptr<PtyPort> port_at(std::uint32_t baud) {
  auto port = PtyPort::open("", baud);
  return port ? std::move(*port) : nullptr;
}

// A terminal at this rate: with its constant, if it has one, for programs that ask for that.
void expect_rate(int descriptor, std::uint32_t baud) {
  EXPECT_EQ(tty_speed(descriptor), baud);
  const termios found = settings(descriptor);
  EXPECT_EQ(found.c_cflag & kInputRate, 0U) << baud;
  if (constant_of(baud) == B0) return;
  EXPECT_EQ(cfgetospeed(&found), constant_of(baud)) << baud;
  EXPECT_EQ(cfgetispeed(&found), constant_of(baud)) << baud;
}

TEST(TtySpeed, IsSeenAtBothEndsByItsConstant) {
  const auto port = port_at(57600);
  ASSERT_TRUE(port);
  const SerialClient client{port->path()};
  for (const std::uint32_t baud : oi::kCreate.baud_rates) {
    ASSERT_TRUE(client.set_baud(baud));
    expect_rate(port->descriptor(), baud);
    expect_rate(client.descriptor(), baud);
  }
}

TEST(TtySpeed, IsSeenByItsConstantWhoeverOpensThePort) {
  for (const std::uint32_t baud : oi::kCreate.baud_rates) {
    const auto port = port_at(57600);
    ASSERT_TRUE(port);
    const auto stream = open_pty(port->path(), baud);
    ASSERT_TRUE(stream) << stream.failure().message;
    expect_rate(port->descriptor(), baud);
    ASSERT_FALSE((*stream)->set_wake_threshold(16));
    expect_rate(port->descriptor(), baud);
  }
}

TEST(TtySpeed, OfAVirtualCreateIsSeenByItsConstant) {
  for (const std::uint32_t baud : oi::kCreate.baud_rates) {
    const auto port = port_at(baud);
    ASSERT_TRUE(port);
    expect_rate(port->descriptor(), baud);
  }
}

// From either form to either.
TEST(TtySpeed, ComesBackWithThePort) {
  for (const std::uint32_t found : {9600U, 14400U, 57600U}) {
    const auto port = port_at(found);
    ASSERT_TRUE(port);
    for (const std::uint32_t used : {28800U, 115200U}) {
      ASSERT_TRUE(open_pty(port->path(), used));
      expect_rate(port->descriptor(), found);
    }
  }
}

TEST(TtySpeed, ReadsWhatTermiosSet) {
  const auto port = port_at(28800);
  ASSERT_TRUE(port);
  const SerialClient client{port->path(), 28800};
  termios wanted = settings(client.descriptor());
  cfsetspeed(&wanted, B19200);
  ASSERT_EQ(tcsetattr(client.descriptor(), TCSANOW, &wanted), 0);
  EXPECT_EQ(port->host_baud(), 19200U);
}

TEST(TtySpeed, FailsWithoutATerminal) {
  const int descriptor = open("/dev/null", O_RDWR | O_CLOEXEC);
  EXPECT_FALSE(tty_speed(descriptor));
  EXPECT_EQ(set_tty_speed(descriptor, 57600), std::errc::inappropriate_io_control_operation);
  close(descriptor);
}

}  // namespace
}  // namespace cargobay::hal
