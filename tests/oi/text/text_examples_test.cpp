// Examples of commands as text, both ways.
#include <ostream>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/oi/text/encoded.hpp"

namespace cargobay::oi {
namespace {

struct Example {
  std::string_view text;
  Bytes bytes;
  std::string_view canonical{};  // empty: the text itself

  friend std::ostream& operator<<(std::ostream& out, const Example& example) {
    return out << example.text;
  }
};

class Examples : public testing::TestWithParam<Example> {};

TEST_P(Examples, AreTheSameBothWays) {
  const Example& example = GetParam();
  EXPECT_EQ(bytes_of(example.text), example.bytes);
  EXPECT_EQ(round_trip(example.bytes),
            example.canonical.empty() ? example.text : example.canonical);
}

// The manual's own examples (OI p. 9 to 16).
INSTANTIATE_TEST_SUITE_P(
    OfTheManual, Examples,
    testing::Values(
        Example{"drive -200 500", {137, 255, 56, 1, 244}},
        Example{"leds advance 0 128", {139, 8, 0, 128}},
        Example{"pwm_low_side_drivers 128 0 32", {144, 32, 0, 128}},
        Example{"low_side_drivers driver_1", {138, 2}},
        Example{"query_list 9 13", {149, 2, 9, 13}, "query_list cliff_left virtual_wall"},
        Example{"stream 29 13", {148, 2, 29, 13}, "stream cliff_front_left_signal virtual_wall"},
        Example{"wait_event -5", {158, 251}, "wait_event no_bump"},
        Example{"script { drive 300 straight; wait_distance 400; drive 0 0 }",
                {152, 13, 137, 1, 44, 128, 0, 156, 1, 144, 137, 0, 0, 0, 0}},
        Example{"script { wait_event bump; wait_event no_bump; leds play 0 0; wait_event bump; "
                "wait_event no_bump; leds none 0 0; play_script }",
                {152, 17, 158, 5, 158, 251, 139, 2, 0, 0, 158, 5, 158, 251, 139, 0, 0, 0, 153}},
        Example{"script { drive 300 straight; wait_distance 400; drive 300 counter_clockwise; "
                "wait_angle 90; play_script }",
                {152, 17, 137, 1, 44, 128, 0, 156, 1, 144, 137, 1, 44, 0, 1, 157, 0, 90, 153}}));

INSTANTIATE_TEST_SUITE_P(
    OfEveryCommand, Examples,
    testing::Values(
        Example{"start", {128}}, Example{"baud 57600", {129, 10}},
        Example{"baud 10", {129, 10}, "baud 57600"}, Example{"baud 300", {129, 0}},
        Example{"control", {130}}, Example{"safe", {131}}, Example{"full", {132}},
        Example{"spot", {134}}, Example{"cover", {135}}, Example{"demo abort", {136, 255}},
        Example{"demo 255", {136, 255}, "demo abort"}, Example{"demo -1", {136, 255}, "demo abort"},
        Example{"demo banjo", {136, 9}}, Example{"drive 200 straight", {137, 0, 200, 128, 0}},
        Example{"drive 200 32768", {137, 0, 200, 128, 0}, "drive 200 straight"},
        Example{"drive 200 32767", {137, 0, 200, 127, 255}},
        Example{"drive 200 clockwise", {137, 0, 200, 255, 255}},
        Example{"drive 200 1", {137, 0, 200, 0, 1}, "drive 200 counter_clockwise"},
        Example{"drive 0xff38 0x1F4", {137, 255, 56, 1, 244}, "drive -200 500"},
        Example{"low_side_drivers driver_0,driver_2", {138, 5}},
        Example{"low_side_drivers 1", {138, 1}, "low_side_drivers driver_0"},
        Example{"low_side_drivers none", {138, 0}},
        Example{"leds play,advance 255 0", {139, 10, 255, 0}},
        Example{"leds advance,play 1 2", {139, 10, 1, 2}, "leds play,advance 1 2"},
        Example{"leds none 0 0", {139, 0, 0, 0}},
        Example{"song 0 60:32 64:32", {140, 0, 2, 60, 32, 64, 32}},
        Example{"song 15 rest:16 30:1", {140, 15, 2, 0, 16, 30, 1}},
        Example{"song 2 c4:32 A#3:1 bb3:1 g9:2",
                {140, 2, 4, 60, 32, 58, 1, 58, 1, 127, 2},
                "song 2 60:32 58:1 58:1 127:2"},
        Example{"song 1 0:8", {140, 1, 1, 0, 8}, "song 1 rest:8"}, Example{"play 3", {141, 3}},
        Example{"sensors group_6", {142, 6}}, Example{"sensors 19", {142, 19}, "sensors distance"},
        Example{"cover_and_dock", {143}}, Example{"drive_direct 100 -100", {145, 255, 156, 0, 100}},
        Example{"digital_outputs output_0,output_2", {147, 5}},
        Example{"digital_outputs 0", {147, 0}, "digital_outputs none"},
        Example{"stream none", {148, 0}},
        Example{"stream distance,angle oi_mode,",
                {148, 3, 19, 20, 35},
                "stream distance angle oi_mode"},
        Example{"query_list none", {149, 0}}, Example{"pause_resume_stream pause", {150, 0}},
        Example{"pause_resume_stream 1", {150, 1}, "pause_resume_stream resume"},
        Example{"send_ir 0xff", {151, 255}, "send_ir 255"}, Example{"script { }", {152, 0}},
        Example{"script{}", {152, 0}, "script { }"}, Example{"play_script", {153}},
        Example{"show_script", {154}}, Example{"wait_time 20", {155, 20}},
        Example{"wait_distance -32768", {156, 128, 0}},
        Example{"wait_distance 0x8000", {156, 128, 0}, "wait_distance -32768"},
        Example{"wait_angle 32767", {157, 127, 255}},
        Example{"wait_event 251", {158, 251}, "wait_event no_bump"},
        Example{"wait_event mode_passive", {158, 22}}));

}  // namespace
}  // namespace cargobay::oi
