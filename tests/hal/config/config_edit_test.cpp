#include "hal/config/config_edit.hpp"

#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

TEST(SetValues, MakesAConfigurationOfNothing) {
  EXPECT_EQ(set_values("", "robot", {{"lag_s", "0.1"}}), "[robot]\nlag_s = 0.1\n");
}

TEST(SetValues, ReplacesAndLeavesAllElse) {
  EXPECT_EQ(set_values("# mine\nport = \"/dev/ttyUSB0\"\n\n[robot]\n# why\nlag_s = 0.2 # old\n\n"
                       "[realtime]\nlag_s = 7\n",
                       "robot", {{"lag_s", "0.1"}, {"remainder", "\"lost\""}}),
            "# mine\nport = \"/dev/ttyUSB0\"\n\n[robot]\n# why\nlag_s = 0.1  # old\n"
            "remainder = \"lost\"\n\n[realtime]\nlag_s = 7\n");
}

TEST(SetValues, AddsATableAtTheEnd) {
  EXPECT_EQ(set_values("[realtime]\npriority = 70", "robot", {{"lag_s", "0.1"}}),
            "[realtime]\npriority = 70\n\n[robot]\nlag_s = 0.1\n");
}

TEST(SetValues, IsNotFooledByComments) {
  EXPECT_EQ(set_values("[robot] # it\n# lag_s = 3\nname = \"a # b\"\n", "robot",
                       {{"name", "\"c\""}, {"lag_s", "0.1"}}),
            "[robot] # it\n# lag_s = 3\nname = \"c\"\nlag_s = 0.1\n");
}

}  // namespace
}  // namespace cargobay::hal
