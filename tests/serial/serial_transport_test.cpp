// libserialport's own code on a pseudo-terminal. It wants its port under /dev and under
// /sys/class/tty, so the port is named by a path that leads to one link from both; and it asks for
// modem lines, which a pseudo-terminal does not have. This program answers in the kernel's place.
#include "hal/port/serial_transport.hpp"

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/port/low_latency.hpp"
#include "hal/port/open_port.hpp"
#include "hal/port/port_lock.hpp"
#include "hal/port/pty_transport.hpp"
#include "hal/port/tty_speed.hpp"

namespace {

struct ModemLines {
  bool there = true;
  int asserted = TIOCM_RTS | TIOCM_DTR;  // as the kernel opens a port
  int serial_flags = 0;
  bool serial_settings = true;  // the driver knows TIOCSSERIAL
} modem;

}  // namespace

// The linker's names for them (ld --wrap).
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
extern "C" {
char* __wrap___realpath_chk(const char* path, char* resolved, std::size_t size);
int __wrap_ioctl(int descriptor, unsigned long request, ...);
int __real_ioctl(int descriptor, unsigned long request, void* argument);

// libserialport 0.1.2, as Debian compiles it, resolves names with this; our name must stay as it
// is.
char* __wrap___realpath_chk(const char* path, char* resolved, std::size_t size) {
  const std::string_view name{path};
  if (name.size() >= size) return nullptr;
  resolved[name.copy(resolved, size - 1)] = '\0';
  return resolved;
}

int __wrap_ioctl(int descriptor, unsigned long request, ...) {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  switch (request) {
    case TIOCMGET:
      if (!modem.there) break;
      *static_cast<int*>(argument) = modem.asserted;
      return 0;
    case TIOCMSET:
      if (!modem.there) break;
      modem.asserted = *static_cast<int*>(argument);
      return 0;
    case TIOCMBIS:
      if (!modem.there) break;
      modem.asserted |= *static_cast<int*>(argument);
      return 0;
    case TIOCMBIC:
      if (!modem.there) break;
      modem.asserted &= ~*static_cast<int*>(argument);
      return 0;
    case TIOCGSERIAL:
      if (!modem.serial_settings) break;
      static_cast<serial_struct*>(argument)->flags = modem.serial_flags;
      return 0;
    case TIOCSSERIAL: modem.serial_flags = static_cast<serial_struct*>(argument)->flags; return 0;
    default: break;
  }
  return __real_ioctl(descriptor, request, argument);
}
}
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)

namespace cargobay::hal {
namespace {

using std::chrono_literals::operator""s;
using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;
using Wait = ByteStream::Wait;

class SerialTransport : public testing::Test {
 protected:
  void SetUp() override {
    modem = {};
    std::string name = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    master_ = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_GE(master_, 0);
    ASSERT_EQ(grantpt(master_), 0);
    ASSERT_EQ(unlockpt(master_), 0);
    std::array<char, 64> pty{};
    ASSERT_EQ(ptsname_r(master_, pty.data(), pty.size()), 0);
    pty_ = pty.data();
    std::filesystem::create_symlink(pty_, folder_ / "tty");
    path_ = "/dev/../../.." + (folder_ / "tty").string();
    slave_ = open(pty_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    ASSERT_GE(slave_, 0);
  }
  void TearDown() override {
    close(slave_);
    hang_up();
    std::filesystem::remove_all(folder_);
  }
  void hang_up() {
    if (master_ >= 0) close(master_);
    master_ = -1;
  }
  termios settings() const {
    termios found{};
    tcgetattr(slave_, &found);
    return found;
  }

  std::filesystem::path folder_;
  std::string pty_;
  std::string path_;
  int master_ = -1;
  int slave_ = -1;  // to look at its settings
};

TEST_F(SerialTransport, Is8N1RawWithoutFlowControlAtItsRate) {
  const auto port = open_serial(path_, 19200);
  ASSERT_TRUE(port) << port.failure().message;
  EXPECT_EQ(tty_speed(slave_), 19200U);
  const termios now = settings();
  EXPECT_EQ(now.c_cflag & static_cast<tcflag_t>(CSIZE), static_cast<tcflag_t>(CS8));
  EXPECT_EQ(now.c_cflag & static_cast<tcflag_t>(PARENB | CSTOPB | CRTSCTS), 0U);
  EXPECT_EQ(now.c_iflag & static_cast<tcflag_t>(IXON | IXOFF | ICRNL), 0U);
  EXPECT_EQ(now.c_lflag & static_cast<tcflag_t>(ICANON | ECHO | ISIG), 0U);
  EXPECT_EQ(now.c_oflag & static_cast<tcflag_t>(OPOST), 0U);
  EXPECT_EQ(now.c_cc[VMIN], 1);
}

TEST_F(SerialTransport, CarriesBytesBothWays) {
  const auto port = open_serial(path_, 57600);
  ASSERT_TRUE(port);
  ByteStream& stream = *port->stream;
  const Bytes all{0, 3, 4, 10, 13, 17, 19, 26, 127, 255};  // what a terminal would interpret
  EXPECT_EQ(stream.write(all).count, all.size());
  Bytes heard(32);
  heard.resize(static_cast<std::size_t>(read(master_, heard.data(), heard.size())));
  EXPECT_EQ(heard, all);
  ASSERT_EQ(write(master_, all.data(), all.size()), static_cast<ssize_t>(all.size()));
  ASSERT_EQ(stream.wait(stream.now() + 1s), Wait::ready);
  Bytes got(32);
  got.resize(stream.read(got).count);
  EXPECT_EQ(got, all);
  EXPECT_TRUE(stream.drain(1s));
}

TEST_F(SerialTransport, ChangesItsRateAndKeepsItsThreshold) {
  const auto port = open_serial(path_, 57600);
  ASSERT_TRUE(port);
  ASSERT_FALSE(port->stream->set_wake_threshold(9));
  for (const std::uint32_t baud : {19200U, 28800U, 115200U}) {
    ASSERT_FALSE(port->stream->set_baud(baud));
    EXPECT_EQ(port->stream->baud(), baud);
    EXPECT_EQ(tty_speed(slave_), baud);
    EXPECT_EQ(settings().c_cc[VMIN], 9);
  }
  ASSERT_FALSE(port->stream->set_wake_threshold(1));
  EXPECT_EQ(tty_speed(slave_), 115200U) << "a new threshold keeps the rate";
}

// libserialport sets the rate, and set_wake_threshold() does again: both by its constant.
TEST_F(SerialTransport, SetsStandardRatesByTheirConstants) {
  const std::pair<std::uint32_t, speed_t> rates[] = {
      {300, B300},   {600, B600},     {1200, B1200},   {2400, B2400},   {4800, B4800},
      {9600, B9600}, {19200, B19200}, {38400, B38400}, {57600, B57600}, {115200, B115200}};
  const auto port = open_serial(path_, 57600);
  ASSERT_TRUE(port);
  for (const auto& [baud, constant] : rates) {
    ASSERT_FALSE(port->stream->set_baud(baud));
    ASSERT_FALSE(port->stream->set_wake_threshold(9));
    const termios now = settings();
    EXPECT_EQ(cfgetospeed(&now), constant) << baud;
    EXPECT_EQ(now.c_cflag & static_cast<tcflag_t>(CIBAUD), 0U) << baud;
  }
}

TEST_F(SerialTransport, RefusesASecondOpenerAndLeavesTheFirstAlone) {
  const auto first = open_serial(path_, 57600);
  ASSERT_TRUE(first);
  ASSERT_FALSE(first->stream->set_wake_threshold(9));
  const auto second = open_serial(path_, 19200);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.failure().message, HasSubstr("in use by another process"));
  EXPECT_EQ(tty_speed(slave_), 57600U);
  EXPECT_EQ(settings().c_cc[VMIN], 9);
  int exclusive = 0;
  ioctl(slave_, TIOCGEXCL, &exclusive);
  EXPECT_EQ(exclusive, 1);
}

TEST_F(SerialTransport, LeavesThePortAsItWasFound) {
  ASSERT_FALSE(set_tty_speed(slave_, 28800));
  const termios before = settings();
  {
    ASSERT_TRUE(open_serial(path_, 57600));
  }
  EXPECT_EQ(tty_speed(slave_), 28800U);
  EXPECT_EQ(settings().c_lflag, before.c_lflag);
  EXPECT_EQ(settings().c_iflag, before.c_iflag);
  int exclusive = 1;
  ioctl(slave_, TIOCGEXCL, &exclusive);
  EXPECT_EQ(exclusive, 0);
  EXPECT_TRUE(open_serial(path_, 57600)) << "and free";
}

// A pin of the robot may hang on one of them.
TEST_F(SerialTransport, SetsRtsAndDtrAndLeavesThemWhenItCloses) {
  using ModemLine = ByteStream::ModemLine;
  termios hanging_up = settings();
  hanging_up.c_cflag |= HUPCL;
  ASSERT_EQ(tcsetattr(slave_, TCSANOW, &hanging_up), 0);
  {
    const auto port = open_port(path_, 57600);
    ASSERT_TRUE(port) << port.failure().message;
    ASSERT_FALSE(port->stream->set_modem_line(ModemLine::rts, false));
    EXPECT_EQ(modem.asserted, TIOCM_DTR);
    ASSERT_FALSE(port->stream->set_modem_line(ModemLine::dtr, false));
    ASSERT_FALSE(port->stream->set_modem_line(ModemLine::rts, true));
    EXPECT_EQ(modem.asserted, TIOCM_RTS);
    ASSERT_FALSE(port->stream->set_baud(19200));
    EXPECT_EQ(modem.asserted, TIOCM_RTS) << "another rate changes neither";
    EXPECT_EQ(tty_speed(slave_), 19200U);
  }
  EXPECT_EQ(modem.asserted, TIOCM_RTS);
  EXPECT_EQ(settings().c_cflag & static_cast<tcflag_t>(HUPCL), 0U)
      << "the kernel would release both at the last close";
}

TEST_F(SerialTransport, LeavesRtsAndDtrAloneIfNothingHangsOnThem) {
  termios hanging_up = settings();
  hanging_up.c_cflag |= HUPCL;
  ASSERT_EQ(tcsetattr(slave_, TCSANOW, &hanging_up), 0);
  {
    ASSERT_TRUE(open_port(path_, 57600));
  }
  EXPECT_EQ(modem.asserted, TIOCM_RTS | TIOCM_DTR);
  EXPECT_NE(settings().c_cflag & static_cast<tcflag_t>(HUPCL), 0U) << "as it was found";
}

TEST_F(SerialTransport, SaysThatAPortHasNeitherRtsNorDtr) {
  const auto port = open_pty(pty_, 57600);
  ASSERT_TRUE(port) << port.failure().message;
  modem.there = false;
  EXPECT_TRUE((*port)->set_modem_line(ByteStream::ModemLine::rts, false));
}

TEST_F(SerialTransport, AsksTheDriverForLowLatency) {
  ASSERT_TRUE(open_serial(path_, 57600));
  EXPECT_NE(modem.serial_flags & static_cast<int>(ASYNC_LOW_LATENCY), 0);
}

TEST_F(SerialTransport, OpensWhereTheDriverHasNoLowLatency) {
  modem.serial_settings = false;
  EXPECT_TRUE(open_serial(path_, 57600));
}

TEST_F(SerialTransport, TellsThatThePortHungUp) {
  const auto port = open_serial(path_, 57600);
  ASSERT_TRUE(port);
  hang_up();
  EXPECT_EQ(port->stream->wait(port->stream->now() + 1s), Wait::hung_up);
}

TEST_F(SerialTransport, RefusesWhatTheKernelDoesNotListAsAPort) {
  const auto port = open_serial(pty_, 57600);
  ASSERT_FALSE(port);
  EXPECT_THAT(port.failure().message, HasSubstr("cargobay ports"));
}

TEST_F(SerialTransport, SaysWhatHasNoModemLines) {
  modem.there = false;
  const auto port = open_serial(path_, 57600);
  ASSERT_FALSE(port);
  EXPECT_THAT(port.failure().message, HasSubstr(path_));
  modem.there = true;
  EXPECT_TRUE(open_serial(path_, 57600)) << "nothing of it is left locked";
}

TEST_F(SerialTransport, IsTakenForAPtyWhereItIsOne) {
  modem.there = false;  // otherwise libserialport would refuse it
  const auto port = open_port((folder_ / "tty").string(), 57600);
  ASSERT_TRUE(port) << port.failure().message;
  EXPECT_EQ(tty_speed(slave_), 57600U);
}

TEST(OpenPort, SaysWhatIsNoPort) {
  for (const char* path : {"/dev/null", "/tmp", "/dev/no_such_tty"}) {
    const auto port = open_port(path, 57600);
    ASSERT_FALSE(port) << path;
    EXPECT_THAT(port.failure().message, HasSubstr(std::string{"cannot open "} + path));
  }
}

TEST(SerialPorts, AreListedSortedAndWithoutPtys) {
  std::string before;
  for (const PortInfo& port : serial_ports()) {
    EXPECT_TRUE(port.path.starts_with("/dev/")) << port.path;
    EXPECT_FALSE(port.path.starts_with("/dev/pts/"));
    EXPECT_LT(before, port.path);
    before = port.path;
  }
}

class LatencyTimer : public SerialTransport {
 protected:
  std::string write_timer(const std::string& text) {
    std::ofstream{folder_ / "latency_timer"} << text << '\n';
    return folder_.string();
  }
};

TEST_F(LatencyTimer, IsSetToAMillisecond) {
  EXPECT_EQ(shorten_latency_timer(write_timer("16")), 1);
}

TEST_F(LatencyTimer, IsLeftWhereItIsShort) {
  EXPECT_EQ(shorten_latency_timer(write_timer("1")), 1);
}

TEST_F(LatencyTimer, IsNoMatterWhereThereIsNone) {
  EXPECT_EQ(shorten_latency_timer(folder_.string()), std::nullopt);
}

}  // namespace
}  // namespace cargobay::hal
