// Which port counts as the lost one, among made-up adapters.
#include "hal/port/port_identity.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Kind = PortIdentity::Kind;

PortInfo adapter(const std::string& path, const std::string& serial, int vendor = 0x0403) {
  return {.path = path, .usb_serial = serial, .usb_vendor_id = vendor, .usb_product_id = 0x6001};
}

const PortInfo kUart{.path = "/dev/ttyAMA0"};

class PortIdentityTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string make(const std::string& name) const {
    std::ofstream{folder_ / name} << "";
    return (folder_ / name).string();
  }
  static PortIdentity identity(const std::string& path, const std::vector<PortInfo>& ports) {
    const auto found = identify(path, ports);
    EXPECT_TRUE(found);
    return found ? *found : PortIdentity{};
  }
  std::optional<std::string> find(const PortIdentity& identity,
                                  const std::vector<PortInfo>& ports) {
    const auto path = find_port(identity, [&] {
      ++times_listed_;
      return ports;
    });
    why_ = path ? "" : path.failure().message;
    return path ? std::optional{*path} : std::nullopt;
  }

  std::filesystem::path folder_;
  int times_listed_ = 0;
  std::string why_;  // nothing was found
};

TEST_F(PortIdentityTest, FollowsAnAdapterToItsNewName) {
  const PortIdentity it = identity(
      "/dev/ttyUSB0", {kUart, adapter("/dev/ttyUSB0", "A1"), adapter("/dev/ttyUSB1", "B2")});
  EXPECT_EQ(it.kind, Kind::usb);
  EXPECT_EQ(find(it, {kUart, adapter("/dev/ttyUSB1", "B2"), adapter("/dev/ttyUSB2", "A1")}),
            "/dev/ttyUSB2");
}

TEST_F(PortIdentityTest, TakesNoOtherAdapterUnderTheOldName) {
  const PortIdentity it = identity("/dev/ttyUSB0", {adapter("/dev/ttyUSB0", "A1")});
  EXPECT_EQ(find(it, {}), std::nullopt);
  EXPECT_EQ(find(it, {adapter("/dev/ttyUSB0", "B2")}), std::nullopt) << "another serial number";
  EXPECT_EQ(find(it, {adapter("/dev/ttyUSB0", "A1", 0x1a86)}), std::nullopt) << "another vendor";
  EXPECT_EQ(find(it, {adapter("/dev/ttyUSB0", "")}), std::nullopt);
  PortInfo other_product = adapter("/dev/ttyUSB0", "A1");
  other_product.usb_product_id = 0x6015;
  EXPECT_EQ(find(it, {other_product}), std::nullopt);
}

TEST_F(PortIdentityTest, SaysWhatIsThereInstead) {
  const PortIdentity it = identity("/dev/ttyUSB0", {adapter("/dev/ttyUSB0", "3")});
  find(it, {});
  EXPECT_EQ(why_, "/dev/ttyUSB0 is not there");
  find(it, {adapter("/dev/ttyUSB0", "5")});
  EXPECT_THAT(why_, StartsWith("/dev/ttyUSB0 is another adapter: serial number 5 instead of 3;"));
  find(it, {adapter("/dev/ttyUSB0", "")});
  EXPECT_THAT(why_, HasSubstr("serial number none instead of 3;"));
  find(it, {adapter("/dev/ttyUSB0", "3", 0x1a86)});
  EXPECT_THAT(why_, HasSubstr("is another adapter: USB 1a86:6001 instead of 0403:6001;"));
  find(it, {PortInfo{.path = "/dev/ttyUSB0"}});
  EXPECT_THAT(why_, HasSubstr("is another adapter: not a USB adapter;"));
  find(it, {adapter("/dev/ttyUSB0", "3"), adapter("/dev/ttyUSB1", "3")});
  EXPECT_THAT(why_, HasSubstr("2 adapters look like that of /dev/ttyUSB0"));
}

// The link under /dev/serial/by-id has the serial number in its name: another adapter has another.
TEST_F(PortIdentityTest, SaysWhatIsThereInsteadOfAnAdapterWithALink) {
  PortInfo port = adapter(make("ttyUSB0"), "3");
  port.stable_path = make("usb-FTDI_3-if00-port0");
  const PortIdentity it = identity(port.path, {port});
  std::filesystem::remove(port.stable_path);
  find(it, {adapter(port.path, "5")});
  EXPECT_THAT(why_, HasSubstr("is another adapter: serial number 5 instead of 3"));
  find(it, {port});
  EXPECT_EQ(why_, port.stable_path + " is not there yet");
}

TEST_F(PortIdentityTest, FollowsTheOneAdapterOfItsKindThatHasNoSerialNumber) {
  const PortIdentity it =
      identity("/dev/ttyUSB0", {adapter("/dev/ttyUSB0", ""), adapter("/dev/ttyUSB1", "", 0x1a86)});
  EXPECT_EQ(it.kind, Kind::usb);
  EXPECT_EQ(find(it, {adapter("/dev/ttyUSB3", "")}), "/dev/ttyUSB3");
}

// The remaining one is the other robot's.
TEST_F(PortIdentityTest, KnowsOneOfTwinsByItsNameOnly) {
  const std::string ours = make("ttyUSB0");
  const PortInfo twin = adapter("/dev/ttyUSB1", "");
  const PortIdentity it = identity(ours, {adapter(ours, ""), twin});
  EXPECT_EQ(it.kind, Kind::path);
  EXPECT_EQ(find(it, {adapter(ours, ""), twin}), ours);
  std::filesystem::remove(ours);
  EXPECT_EQ(find(it, {twin}), std::nullopt);
}

TEST_F(PortIdentityTest, DoesNotGuessBetweenTwoThatLookTheSame) {
  const PortIdentity it = identity("/dev/ttyUSB0", {adapter("/dev/ttyUSB0", "")});
  EXPECT_EQ(find(it, {adapter("/dev/ttyUSB0", ""), adapter("/dev/ttyUSB1", "")}), std::nullopt);
  EXPECT_EQ(find(it, {adapter("/dev/ttyUSB1", "")}), "/dev/ttyUSB1");
}

TEST_F(PortIdentityTest, KnowsAUartByItsName) {
  const std::string path = make("ttyAMA0");
  const PortIdentity it = identity(path, {PortInfo{.path = path}, adapter("/dev/ttyUSB0", "A1")});
  EXPECT_EQ(it.kind, Kind::path);
  EXPECT_EQ(find(it, {}), path);
  EXPECT_EQ(times_listed_, 0);
}

TEST_F(PortIdentityTest, FollowsALinkWhereverItLeads) {
  const std::string link = (folder_ / "robot").string();
  std::filesystem::create_symlink(make("ttyUSB0"), link);
  const PortIdentity it = identity(link, {adapter((folder_ / "ttyUSB0").string(), "A1")});
  EXPECT_EQ(it.kind, Kind::path);
  std::filesystem::remove(folder_ / "ttyUSB0");
  EXPECT_EQ(find(it, {}), std::nullopt) << "it leads nowhere";
  std::filesystem::remove(link);
  EXPECT_EQ(find(it, {}), std::nullopt);
  std::filesystem::create_symlink(make("ttyUSB1"), link);
  EXPECT_EQ(find(it, {}), link);
}

TEST_F(PortIdentityTest, SaysWhatIsThereInsteadOfALink) {
  const std::string link = (folder_ / "usb-FTDI_3-if00-port0").string();
  const PortInfo port = adapter(make("ttyUSB0"), "3");
  std::filesystem::create_symlink(port.path, link);
  const PortIdentity it = identity(link, {port});
  EXPECT_EQ(it.kind, Kind::path) << "the link is followed, not the adapter";
  EXPECT_EQ(find(it, {}), link);
  EXPECT_EQ(times_listed_, 0);
  std::filesystem::remove(link);
  EXPECT_EQ(find(it, {adapter(port.path, "5")}), std::nullopt);
  EXPECT_EQ(why_, link + " is not there, and " + port.path +
                      " is another adapter: serial number 5 instead of 3; plug in the robot's, or "
                      "start again with this one");
  find(it, {port});
  EXPECT_EQ(why_, link + " is not there yet");
  std::filesystem::remove(port.path);
  times_listed_ = 0;
  find(it, {});
  EXPECT_EQ(why_, link + " is not there");
  EXPECT_EQ(times_listed_, 0) << "listing takes milliseconds";
}

TEST_F(PortIdentityTest, ListsThePortsOnlyOnceTheStableLinkIsBack) {
  PortInfo port = adapter("/dev/ttyUSB0", "A1");
  port.stable_path = make("usb-FTDI_A1-if00-port0");
  const PortIdentity it = identity(port.path, {port});
  std::filesystem::remove(port.stable_path);
  EXPECT_EQ(find(it, {port}), std::nullopt);
  EXPECT_EQ(times_listed_, 0);
  make("usb-FTDI_A1-if00-port0");
  EXPECT_EQ(find(it, {port}), port.path);
  EXPECT_EQ(times_listed_, 1);
}

TEST_F(PortIdentityTest, RefusesTheNumberOfAPseudoTerminal) {
  const int master = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_GE(master, 0);
  ASSERT_EQ(grantpt(master), 0);
  ASSERT_EQ(unlockpt(master), 0);
  std::string path(64, '\0');
  ASSERT_EQ(ptsname_r(master, path.data(), path.size()), 0);
  path.resize(path.find('\0'));
  const auto refused = identify(path, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.failure().message, HasSubstr("--link"));
  const std::string link = (folder_ / "robot").string();
  std::filesystem::create_symlink(path, link);
  EXPECT_TRUE(identify(link, {}));
  close(master);
}

}  // namespace
}  // namespace cargobay::hal
