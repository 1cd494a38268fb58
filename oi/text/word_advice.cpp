#include "oi/text/word_advice.hpp"

#include <algorithm>
#include <array>
#include <span>

#include "oi/packet_table.hpp"
#include "oi/text/nearest_name.hpp"
#include "oi/text/text_number.hpp"
#include "oi/value_names.hpp"

namespace cargobay::oi {
namespace {

struct Advice {
  std::string_view words;  // with blanks between
  std::string_view advice;
};

constexpr std::string_view kOfOtherModels =
    "that is of the Create 2 and the Roomba; the Create of 2006 has nothing like it";

constexpr std::string_view kToStop =
    "to stop the wheels, write: stop; to end a demo: demo abort; to end both, into Passive mode: "
    "start";

constexpr Advice kForCommands[]{
    {"halt brake freeze estop emergency abort cancel end quit exit kill idle standby rest sit stay "
     "park",
     kToStop},
    {"passive passive_mode relax release disarm disable",
     "Passive is the mode that Start brings: start"},
    {"off power power_off turn_off switch_off shutdown sleep hibernate",
     "no command switches the Create off: press its power button, or wire its power toggle "
     "(docs/wiring.md); start leaves it in Passive mode"},
    {"wake wake_up on power_on turn_on switch_on boot",
     "no byte wakes a Create that is off: press its power button, or wire its power toggle "
     "(docs/wiring.md); then: start"},
    {"reset reboot restart hard_reset soft_reset",
     "the manual has no reset: switch the robot off and on by its power button; start ends what it "
     "does and makes it Passive. Some robots know soft_reset, which is not in the manual; cargobay "
     "send has it"},
    {"reset_odometry reset_odom zero", "distance and angle count from their last reading"},
    {"dock seek_dock force_seeking_dock find_dock go_dock go_home home return return_to_base base "
     "come_home charge recharge cover_dock dock_cover",
     "docking is a demo here, and drives the robot: cover_and_dock"},
    {"clean vacuum max max_clean spot_clean sweep",
     "cleaning is a demo here, which drives the robot over the floor without a brush: cover"},
    {"motors motor pwm pwm_motors motors_on motors_off vacuum_motor brush side_brush main_brush",
     "the Roomba's motors (138) are low_side_drivers here, and pwm_low_side_drivers sets their "
     "power; to stop the wheels, write: stop"},
    {"go move run walk forward forwards ahead fwd backward backwards back bwd reverse rev left "
     "right turn turn_left turn_right rotate spin circle curve arc steer straight cruise fast "
     "faster slow slower accelerate speed velocity set_speed set_velocity wheel wheels "
     "drive_wheels drive_pwm drive_straight twist cmd_vel teleop",
     "motion is the speeds of both wheels, in mm/s: drive_direct LEFT RIGHT; to end it: stop"},
    {"beep buzz horn alarm sound sing music melody tone tones notes play_song song_play play_tune "
     "rtttl ringtone",
     "store notes with song SLOT NOTE:DURATION ..., or a ring tone with tune SLOT RTTTL; then: "
     "play SLOT"},
    {"light lights lamp led_on led_off leds_on leds_off",
     "write: leds NAMES COLOR INTENSITY, such as leds play 0 255"},
    {"battery status state info read get data sensor_data telemetry bump bumps bumper bumpers "
     "cliff cliffs wheel_drop wheel_drops button volts amps temperature charging encoder odometry "
     "odom pose position",
     "values are read with: sensors PACKET, such as sensors battery_charge; sensors 6 is all"},
    {"firmware version firmware_version date build",
     "no command of the manual asks for that. Some robots know firmware_date, which is not in it; "
     "cargobay send has it"},
    {"id name ping",
     "no command of the manual asks for that; to see that the robot answers: sensors oi_mode"},
    {"mode get_mode which_mode set_mode safe_mode full_mode",
     "it is read with: sensors oi_mode; start, safe and full set it"},
    {"query request poll ask", "one packet is read with sensors PACKET, several with query_list"},
    {"start_stream stream_start begin_stream", "write: stream PACKET ..., such as stream distance"},
    {"pause stop_stream pause_stream", "write: pause_resume_stream pause"},
    {"resume continue resume_stream", "write: pause_resume_stream resume"},
    {"baudrate set_baud", "write: baud RATE, such as baud 57600"},
    {"wait delay pause_ms wait_ms sleep_ms time",
     "a script can wait: wait_time, wait_distance, wait_angle, wait_event"},
    {"output outputs digital_output gpio",
     "write: digital_outputs NAMES, such as digital_outputs output_0"},
    {"ir infrared emit", "write: send_ir BYTE"},
    {"raw hex opcode raw_bytes",
     "write: bytes BYTE ..., such as bytes 142 7; outside scripts, cargobay send and encode have "
     "it"},
    {"oi init initialize initialise connect open begin hello", "the first command is: start"},
    {"help man commands list", "the commands are listed in docs/protocol.md"},
    {"schedule set_day_time day_time digit_leds digit_leds_raw digit_leds_ascii schedule_leds "
     "scheduling_leds push_buttons light_bumper encoder_counts encoders",
     kOfOtherModels},
};

struct ValueAdvice {
  std::string_view arguments;  // their names, with blanks between
  Advice advice;
};

constexpr ValueAdvice kForValues[]{
    {"packet", {"all everything", "packet 6 has all"}},
    {"demo", {"stop halt off none end quit cancel kill start", "to end a demo, write: demo abort"}},
    {"velocity left right radius", {"stop halt off none", "to stop the wheels, write: stop"}},
    {"radius",
     {"left right l r", "a positive radius curves to the left, a negative one to the right"}},
};

bool has_word(std::string_view words, std::string_view wanted) {
  while (!words.empty()) {
    const std::size_t blank = std::min(words.find(' '), words.size());
    if (is_spelt_alike(words.substr(0, blank), wanted)) return true;
    words.remove_prefix(std::min(blank + 1, words.size()));
  }
  return false;
}

// From the table; empty if the word is not in it.
std::string_view listed_advice(std::string_view word) {
  for (const Advice& each : kForCommands) {
    if (has_word(each.words, word)) return each.advice;
  }
  return {};
}

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

}  // namespace

std::string_view command_advice(std::string_view word) {
  // halt! and off() are halt and off.
  while (!word.empty() && !is_letter_or_digit(word.back())) word.remove_suffix(1);
  for (const CommandInfo& info : kCommands) {
    if (is_spelt_alike(info.key, word)) return {};  // a command of ours, misspelt
  }
  if (const std::string_view advice = listed_advice(word); !advice.empty()) return advice;
  if (parse_integer(word)) return listed_advice("raw");
  const auto is_named = [word](const auto& each) {
    if constexpr (requires { each.key; }) {
      return is_spelt_alike(each.key, word);
    } else {
      return is_spelt_alike(each.name, word);
    }
  };
  // full_stop, stop_driving; but stopp is a misspelling.
  NearestName stop{word};
  stop.consider(kStopKey);
  const bool asks_to_stop = word.find(kStopKey) < word.size() && stop.name().empty();
  if (asks_to_stop) return kToStop;
  if (std::ranges::any_of(kPackets, is_named))
    return "that is a packet; it is read with: sensors PACKET";
  if (std::ranges::any_of(kValueNames<DemoNumber>, is_named))
    return "that is a demo, which drives the robot: demo NAME";
  return {};
}

std::string_view command_advice(std::string_view word, std::string_view next) {
  std::array<char, 40> both{};  // longer than any word in the table
  const bool fits = !next.empty() && word.size() + next.size() <= both.size();
  if (fits) {
    auto* const end =
        std::copy(next.begin(), next.end(), std::copy(word.begin(), word.end(), both.begin()));
    const std::string_view joined{both.data(), static_cast<std::size_t>(end - both.begin())};
    if (const std::string_view advice = listed_advice(joined); !advice.empty()) return advice;
  }
  return command_advice(word);
}

std::string_view value_advice(const ArgumentInfo& argument, std::string_view word) {
  for (const ValueAdvice& each : kForValues) {
    if (has_word(each.arguments, argument.name) && has_word(each.advice.words, word))
      return each.advice.advice;
  }
  return {};
}

}  // namespace cargobay::oi
