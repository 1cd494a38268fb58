#include "gpio/find_line.hpp"

#include <cerrno>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::gpio {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Kind = LineError::Kind;

// As on a Pi: the SoC's chip, an expander, and one more with the expander's label.
std::vector<ChipInfo> machine() {
  ChipInfo soc{.path = "/dev/gpiochip0", .name = "gpiochip0", .label = "pinctrl-bcm2835"};
  soc.lines.resize(54);
  soc.lines[17].name = "GPIO17";
  soc.lines[18] = {.name = "GPIO18", .used = true, .consumer = "lirc"};
  soc.lines[19] = {.name = "GPIO19", .used = true};
  ChipInfo expander{.path = "/dev/gpiochip1", .name = "gpiochip1", .label = "expander"};
  expander.lines.resize(8);
  expander.lines[3].name = "NC";
  expander.lines[4].name = "NC";
  ChipInfo other = expander;
  other.path = "/dev/gpiochip2";
  other.name = "gpiochip2";
  return {soc, expander, other};
}

class FindLine : public testing::Test {
 protected:
  std::optional<FoundLine> find(const LineAddress& address) {
    return find_line(chips_, address, error_);
  }
  void expect_found(const LineAddress& address, const std::string& path, unsigned offset) {
    const auto found = find(address);
    ASSERT_TRUE(found) << explain(error_);
    EXPECT_EQ(found->chip_path, path);
    EXPECT_EQ(found->offset, offset);
  }
  // The one line that explains why there is no such line.
  std::string complaint(const LineAddress& address, Kind kind) {
    EXPECT_FALSE(find(address));
    EXPECT_EQ(error_.kind, kind);
    const std::string text = explain(error_);
    EXPECT_THAT(text, Not(HasSubstr("\n")));
    return text;
  }
  std::vector<ChipInfo> chips_ = machine();
  LineError error_;
};

TEST_F(FindLine, TakesLabelNameOrPathAndOffsetOrName) {
  expect_found({"pinctrl-bcm2835", "17"}, "/dev/gpiochip0", 17);
  expect_found({"pinctrl-bcm2835", "GPIO17"}, "/dev/gpiochip0", 17);
  expect_found({"gpiochip2", "7"}, "/dev/gpiochip2", 7);
  expect_found({"/dev/gpiochip1", "0"}, "/dev/gpiochip1", 0);
}

TEST_F(FindLine, FindsANameOnAnyChip) { expect_found({"", "GPIO17"}, "/dev/gpiochip0", 17); }

TEST_F(FindLine, TellsWhichChipsThereAre) {
  EXPECT_THAT(complaint({"pinctrl-bcm2711", "17"}, Kind::no_such_chip),
              AllOf(HasSubstr("pinctrl-bcm2711"), HasSubstr("gpiochip0 [pinctrl-bcm2835]")));
}

TEST_F(FindLine, TakesNoChipNumber) { complaint({"0", "17"}, Kind::no_such_chip); }

TEST_F(FindLine, TellsWhatAnAmbiguousLabelMayMean) {
  EXPECT_THAT(complaint({"expander", "1"}, Kind::ambiguous_chip),
              HasSubstr("name one of them: gpiochip1, gpiochip2"));
}

TEST_F(FindLine, TellsHowManyLinesThereAre) {
  EXPECT_THAT(complaint({"pinctrl-bcm2835", "54"}, Kind::no_such_line),
              AllOf(HasSubstr("no line 54"), HasSubstr("with 54 lines"), HasSubstr("pins")));
  complaint({"pinctrl-bcm2835", "-1"}, Kind::no_such_line);
  complaint({"pinctrl-bcm2835", "17x"}, Kind::no_such_line);
  complaint({"pinctrl-bcm2835", ""}, Kind::no_such_line);
}

TEST_F(FindLine, TellsWhatAnAmbiguousNameMayMean) {
  EXPECT_THAT(complaint({"gpiochip1", "NC"}, Kind::ambiguous_line),
              HasSubstr("/dev/gpiochip1 line 3, /dev/gpiochip1 line 4"));
}

TEST_F(FindLine, TellsWhoHoldsTheLine) {
  EXPECT_THAT(complaint({"pinctrl-bcm2835", "GPIO18"}, Kind::busy), HasSubstr("in use by lirc"));
  EXPECT_THAT(complaint({"pinctrl-bcm2835", "19"}, Kind::busy), HasSubstr("does not name"));
}

TEST_F(FindLine, TellsWhichGroupMayUseTheChip) {
  for (ChipInfo& chip : chips_) {
    chip = {.path = chip.path, .name = chip.name, .error = EACCES, .group = "gpio"};
  }
  EXPECT_THAT(complaint({"gpiochip0", "17"}, Kind::no_permission),
              AllOf(HasSubstr("/dev/gpiochip0"), HasSubstr("sudo adduser $USER gpio")));
  EXPECT_THAT(complaint({"pinctrl-bcm2835", "17"}, Kind::no_permission), HasSubstr("gpio"));
}

TEST_F(FindLine, TellsTheUdevRuleWhereOnlyRootMay) {
  chips_ = {{.path = "/dev/gpiochip0", .name = "gpiochip0", .error = EACCES, .group = "root"}};
  EXPECT_THAT(complaint({"gpiochip0", "17"}, Kind::no_permission),
              AllOf(HasSubstr("60-cargobay.rules"), HasSubstr("udevadm")));
}

TEST_F(FindLine, TellsThatThereIsNoChip) {
  chips_.clear();
  EXPECT_THAT(complaint({"pinctrl-bcm2835", "17"}, Kind::no_chips), HasSubstr("no GPIO chip"));
}

TEST_F(FindLine, TellsThatAChipIsBroken) {
  chips_ = {{.path = "/dev/gpiochip0", .name = "gpiochip0", .error = EIO}};
  EXPECT_THAT(complaint({"gpiochip0", "17"}, Kind::system), HasSubstr("Input/output error"));
}

TEST_F(FindLine, ExplainsARefusedRequest) {
  const LineAddress address{"gpiochip0", "18"};
  const FoundLine found{.chip_path = "/dev/gpiochip0", .offset = 18};
  EXPECT_EQ(refused(chips_, address, found, EBUSY).kind, Kind::busy);
  EXPECT_EQ(refused(chips_, address, found, EBUSY).holder, "lirc");
  EXPECT_EQ(refused(chips_, address, found, EPERM).kind, Kind::no_permission);
  EXPECT_THAT(explain(refused(chips_, address, found, ENODEV)), HasSubstr("No such device"));
}

}  // namespace
}  // namespace cargobay::gpio
