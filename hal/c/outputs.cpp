// LEDs, songs, outputs, scripts, and any other command that does not interfere with the loop.
#include <algorithm>
#include <array>
#include <span>
#include <string>

#include "hal/c/cargobay.h"
#include "hal/c/durations.hpp"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/parse.hpp"
#include "oi/text/command_text.hpp"
#include "oi/text/rtttl.hpp"
#include "oi/text/script_text.hpp"
#include "oi/text/song.hpp"
#include "oi/value_names.hpp"

namespace cargobay::c {
namespace {

using hal::Request;

constexpr std::uint8_t kOutputs = 3;

// What the loop sends itself, or what would take the robot out of its hands.
bool is_the_loops(const oi::CommandInfo& info) {
  using enum oi::ModeChange;
  if (info.change != none) return true;
  switch (info.opcode) {
    case oi::Drive::kOpcode:
    case oi::DriveDirect::kOpcode:
    case oi::Stream::kOpcode:
    case oi::PauseResumeStream::kOpcode:
    case oi::Sensors::kOpcode:
    case oi::QueryList::kOpcode:
    case oi::Baud::kOpcode:
    case oi::ShowScript::kOpcode:  // its answer is not a frame
    case oi::WaitTime::kOpcode:
    case oi::WaitDistance::kOpcode:
    case oi::WaitAngle::kOpcode:
    case oi::WaitEvent::kOpcode: return true;
    default: return false;
  }
}

// One whole command with values in range; the loop sends it after its own.
int send(RobotObject& object, std::span<const std::uint8_t> bytes, std::uint32_t how) {
  const oi::CommandInfo* info = oi::kCreate.find_command(bytes[0]);
  if (info == nullptr) return bad_argument("the robot has no such opcode");
  if (is_the_loops(*info)) {
    return fail(CARGOBAY_E_ARGUMENT, std::string{info->name} +
                                         " is for the loop to send, or would take the robot from "
                                         "it; use the function for that purpose");
  }
  if (const int failed = object.must_run(); failed != CARGOBAY_OK) return failed;
  hal::ControlCycle& cycle = object.robot->cycle();
  const auto state = cycle.state();
  if (state && !info->available_in(state->mode)) {
    return fail(CARGOBAY_E_MODE, std::string{info->name} + " is not obeyed in " +
                                     std::string{oi::name(state->mode)} + " mode (OI p. " +
                                     std::to_string(info->page) +
                                     "); the robot has left its own: cargobay_rearm()");
  }
  const bool pause = (how & CARGOBAY_PAUSE_DRIVING) != 0;
  const bool stands =
      state && state->command == rt::WheelSpeeds{} && state->set == rt::WheelSpeeds{};
  if (bytes.size() > cycle.spare_bytes() && !pause && state && !stands) {
    return fail(CARGOBAY_E_FULL,
                std::to_string(bytes.size()) + " bytes do not fit next to the loop's own, " +
                    std::to_string(cycle.spare_bytes()) +
                    " do; send them while the wheels are stopped, or with CARGOBAY_PAUSE_DRIVING");
  }
  Request request;
  request.kind = Request::Kind::command;
  request.when_long = pause ? Request::WhenLong::pause : Request::WhenLong::wait;
  request.size = static_cast<std::uint8_t>(bytes.size());
  std::ranges::copy(bytes, request.bytes.begin());
  return object.request(request);
}

template <typename Function>
int with(cargobay_robot* robot, const Function& function) noexcept {
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    return use ? function(*use) : bad_robot(robot);
  });
}

// A command whose values the caller has checked.
template <typename Command>
int send_command(cargobay_robot* robot, const Command& command) noexcept {
  return with(robot, [&](RobotObject& object) {
    const auto encoded = oi::encode(command);
    if (!encoded) return bad_argument("a value is out of its range (OI p. 9 to 12)");
    return send(object, *encoded, 0);
  });
}

int bad_how() noexcept { return bad_argument("`how` has bits that this library does not know"); }
bool known_how(std::uint32_t how) { return (how & ~std::uint32_t{CARGOBAY_PAUSE_DRIVING}) == 0; }

// Whole commands, each as a request of its own. All are checked before the first is taken.
int send_bytes(RobotObject& object, std::span<const std::uint8_t> bytes, std::uint32_t how) {
  constexpr std::size_t kMostAtOnce = 124;
  if (bytes.empty()) return bad_argument("there is no command in it");
  if (bytes.size() > kMostAtOnce)
    return bad_argument("more than 124 bytes at once; send one command at a time");
  for (auto rest = bytes; !rest.empty();) {
    const oi::ParseResult parsed = oi::parse_command(rest);
    if (parsed.outcome != oi::ParseResult::Outcome::command)
      return bad_argument("the bytes are not whole commands with values in range (OI p. 7 to 16)");
    if (is_the_loops(*parsed.info)) return send(object, rest.first(parsed.length), how);
    rest = rest.subspan(parsed.length);
  }
  for (auto rest = bytes; !rest.empty();) {
    const std::size_t length = oi::parse_command(rest).length;
    if (const int failed = send(object, rest.first(length), how); failed != CARGOBAY_OK)
      return failed;
    rest = rest.subspan(length);
  }
  return CARGOBAY_OK;
}

int store_tune(RobotObject& object, std::uint8_t slot, const char* rtttl, std::int32_t* durations) {
  oi::RingTone tone;
  if (const auto error = oi::read_rtttl(rtttl, tone)) {
    return bad_argument("column " + std::to_string(error->column) +
                        " of the tune: " + std::string{oi::message(error->what)});
  }
  const auto songs = oi::split({tone.notes.data(), tone.notes.size()}, slot);
  if (!songs) return bad_argument("the tune does not fit in the slots from `slot` to 15");
  std::size_t used = 0;
  for (const oi::Song& song : *songs) {
    const auto encoded = oi::encode(song);
    if (const int failed = send(object, *encoded, CARGOBAY_PAUSE_DRIVING); failed != CARGOBAY_OK)
      return failed;
    if (durations != nullptr)
      durations[used] = oi::duration({song.notes.data(), song.notes.size()}).value;
    ++used;
  }
  return static_cast<int>(used);
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below
namespace oi = cargobay::oi;

extern "C" {

int cargobay_leds(struct cargobay_robot* robot, uint32_t leds, uint8_t power_color,
                  uint8_t power_intensity) {
  if ((leds & ~std::uint32_t{CARGOBAY_LED_PLAY | CARGOBAY_LED_ADVANCE}) != 0)
    return bad_argument("`leds` may only have CARGOBAY_LED_PLAY and CARGOBAY_LED_ADVANCE");
  return send_command(robot, oi::Leds{.leds = oi::BitSet<oi::Led>{static_cast<std::uint8_t>(leds)},
                                      .power_color = power_color,
                                      .power_intensity = power_intensity});
}

int cargobay_digital_outputs(struct cargobay_robot* robot, uint32_t outputs) {
  if (outputs >> kOutputs != 0) return bad_argument("`outputs` may only have bits 0 to 2");
  return send_command(
      robot, oi::DigitalOutputs{oi::BitSet<oi::DigitalOutput>{static_cast<std::uint8_t>(outputs)}});
}

int cargobay_low_side_drivers(struct cargobay_robot* robot, uint32_t drivers) {
  if (drivers >> kOutputs != 0) return bad_argument("`drivers` may only have bits 0 to 2");
  return send_command(
      robot, oi::LowSideDrivers{oi::BitSet<oi::LowSideDriver>{static_cast<std::uint8_t>(drivers)}});
}

int cargobay_pwm_low_side_drivers(struct cargobay_robot* robot, uint8_t driver_0, uint8_t driver_1,
                                  uint8_t driver_2) {
  return send_command(robot, oi::PwmLowSideDrivers{
                                 .driver_0 = driver_0, .driver_1 = driver_1, .driver_2 = driver_2});
}

int cargobay_send_ir(struct cargobay_robot* robot, uint8_t byte) {
  return send_command(robot, oi::SendIr{byte});
}

int cargobay_song(struct cargobay_robot* robot, uint8_t slot, const struct cargobay_note* notes,
                  size_t count) {
  if (notes == nullptr) return bad_argument("`notes` is NULL");
  if (count < 1 || count > oi::kMaxSongNotes)
    return bad_argument("a song has 1 to 16 notes; cargobay_tune() spreads more over several");
  oi::Song song{.slot = slot};
  for (std::size_t i = 0; i < count; ++i) {
    (void)song.notes.push_back(
        {.number = notes[i].number, .duration = oi::SixtyFourths{notes[i].duration}});  // has room
  }
  return with(robot, [&](RobotObject& object) {
    const auto encoded = oi::encode(song);
    if (!encoded) return bad_argument("`slot` must be 0 to 15");
    // 35 bytes: at 19200 baud they do not fit beside the loop's own, and a song is worth the pause.
    return send(object, *encoded, CARGOBAY_PAUSE_DRIVING);
  });
}

int cargobay_play_song(struct cargobay_robot* robot, uint8_t slot) {
  return send_command(robot, oi::Play{slot});
}

int cargobay_tune(struct cargobay_robot* robot, uint8_t slot, const char* rtttl,
                  int32_t* durations_64) {
  if (rtttl == nullptr) return bad_argument("`rtttl` is NULL");
  if (slot >= oi::kSongSlots) return bad_argument("`slot` must be 0 to 15");
  return with(robot,
              [&](RobotObject& object) { return store_tune(object, slot, rtttl, durations_64); });
}

int cargobay_script(struct cargobay_robot* robot, const char* text, uint32_t how) {
  if (text == nullptr) return bad_argument("`text` is NULL");
  if (!known_how(how)) return bad_how();
  return with(robot, [&](RobotObject& object) {
    oi::Script script;
    if (const auto error = oi::compile(text, script)) {
      std::array<char, 400> said{};
      const std::size_t length = oi::format_error(*error, text, said);
      return bad_argument({said.data(), length});
    }
    const auto encoded = oi::encode(script);
    return send(object, *encoded, how);  // compiled, so it can be encoded
  });
}

int cargobay_play_script(struct cargobay_robot* robot, int64_t expected_ns) {
  if (const int bad = check_duration("expected_ns", expected_ns); bad != CARGOBAY_OK) return bad;
  // Announced only if the command was accepted: the robot plays it a frame later at the earliest.
  if (const int failed = send_command(robot, oi::PlayScript{}); failed != CARGOBAY_OK)
    return failed;
  return cargobay_expect_silence(robot, expected_ns);
}

int cargobay_command(struct cargobay_robot* robot, const char* text, uint32_t how) {
  if (text == nullptr) return bad_argument("`text` is NULL");
  if (!known_how(how)) return bad_how();
  return with(robot, [&](RobotObject& object) {
    std::array<std::uint8_t, 512> bytes{};
    const oi::TextResult encoded = oi::encode_text(text, bytes);
    if (encoded.error) {
      std::array<char, 400> said{};
      const std::size_t length = oi::format_error(*encoded.error, text, said);
      return bad_argument({said.data(), length});
    }
    return send_bytes(object, std::span{bytes}.first(encoded.bytes), how);
  });
}

int cargobay_raw(struct cargobay_robot* robot, const uint8_t* bytes, size_t count, uint32_t how) {
  if (bytes == nullptr) return bad_argument("`bytes` is NULL");
  if (!known_how(how)) return bad_how();
  return with(robot, [&](RobotObject& object) { return send_bytes(object, {bytes, count}, how); });
}

}  // extern "C"
