// LEDs, songs, outputs, scripts, and any other command that does not interfere with the loop.
#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <system_error>

#include "hal/c/cargobay.h"
#include "hal/c/durations.hpp"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/robot/side_command.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/parse.hpp"
#include "oi/text/command_text.hpp"
#include "oi/text/rtttl.hpp"
#include "oi/text/script_text.hpp"
#include "oi/text/song.hpp"

namespace cargobay::c {
namespace {

using hal::Request;

constexpr std::uint8_t kOutputs = 3;
constexpr std::uint32_t kMostByte = 255;
constexpr std::int64_t kNsPer64th = 1'000'000'000 / 64;

// Of a value that has been checked.
std::uint8_t byte_of(std::uint32_t value) { return static_cast<std::uint8_t>(value); }

// The code of a refusal; what this API calls the remedy is added to it.
int refused(const hal::Failure& failure) {
  if (failure.code == std::errc::operation_not_permitted)
    return fail(CARGOBAY_E_MODE, failure.message + ": cargobay_rearm()");
  if (failure.code == std::errc::no_buffer_space)
    return fail(CARGOBAY_E_FULL, failure.message + ", or with CARGOBAY_HOW_PAUSE_DRIVING");
  return fail(CARGOBAY_E_ARGUMENT, failure.message);
}

// One whole command with values in range; the loop sends it after its own.
int send(Session& session, std::span<const std::uint8_t> bytes, std::uint32_t how) {
  if (const auto alone = hal::leaves_loop_alone(bytes); !alone) return refused(alone.failure());
  if (const int failed = session.must_run(); failed != CARGOBAY_OK) return failed;
  const bool pause = (how & CARGOBAY_HOW_PAUSE_DRIVING) != 0;
  const auto request = hal::side_request(
      session.robot->cycle(), bytes, pause ? Request::WhenLong::pause : Request::WhenLong::wait);
  return request ? session.request(*request) : refused(request.failure());
}

template <typename Function>
int with(cargobay_robot* robot, const Function& function) noexcept {
  return guarded([&] {
    const RobotUse use = robots().use(robot);
    if (!use) return bad_robot(robot);
    const SessionUse session{*use};
    return session ? function(*session) : no_session();
  });
}

// A command whose values the caller has checked.
template <typename Command>
int send_command(cargobay_robot* robot, const Command& command) noexcept {
  return with(robot, [&](Session& session) {
    const auto encoded = oi::encode(command);
    if (!encoded) return bad_argument("a value is out of its range (OI p. 9 to 12)");
    return send(session, *encoded, 0);
  });
}

int bad_how() noexcept { return bad_argument("`how` has bits that this library does not know"); }
bool known_how(std::uint32_t how) {
  return (how & ~std::uint32_t{CARGOBAY_HOW_PAUSE_DRIVING}) == 0;
}

// Whole commands, each as a request of its own. All are checked before the first is taken.
int send_bytes(Session& session, std::span<const std::uint8_t> bytes, std::uint32_t how) {
  constexpr std::size_t kMostAtOnce = 124;
  if (bytes.empty()) return bad_argument("there is no command in it");
  if (bytes.size() > kMostAtOnce)
    return bad_argument("more than 124 bytes at once; send one command at a time");
  for (auto rest = bytes; !rest.empty();) {
    const oi::ParseResult parsed = oi::parse_command(rest);
    if (parsed.outcome != oi::ParseResult::Outcome::command)
      return bad_argument("the bytes are not whole commands with values in range (OI p. 7 to 16)");
    const auto alone = hal::leaves_loop_alone(rest.first(parsed.length));
    if (!alone) return refused(alone.failure());
    rest = rest.subspan(parsed.length);
  }
  for (auto rest = bytes; !rest.empty();) {
    const std::size_t length = oi::parse_command(rest).length;
    if (const int failed = send(session, rest.first(length), how); failed != CARGOBAY_OK)
      return failed;
    rest = rest.subspan(length);
  }
  return CARGOBAY_OK;
}

int store_tune(Session& session, std::uint8_t slot, const char* rtttl,
               std::span<std::int64_t> durations_ns) {
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
    if (const int failed = send(session, *encoded, CARGOBAY_HOW_PAUSE_DRIVING);
        failed != CARGOBAY_OK)
      return failed;
    if (used < durations_ns.size()) {
      durations_ns[used] =
          rt::Duration{oi::duration({song.notes.data(), song.notes.size()}).value * kNsPer64th}
              .count();
    }
    ++used;
  }
  return static_cast<int>(used);
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below
namespace oi = cargobay::oi;

extern "C" {

int cargobay_set_leds(struct cargobay_robot* robot, uint32_t leds, uint32_t power_color,
                      uint32_t power_intensity) {
  if ((leds & ~std::uint32_t{CARGOBAY_LED_PLAY | CARGOBAY_LED_ADVANCE}) != 0)
    return bad_argument("`leds` may only have CARGOBAY_LED_PLAY and CARGOBAY_LED_ADVANCE");
  if (power_color > kMostByte || power_intensity > kMostByte)
    return bad_argument("`power_color` and `power_intensity` must be 0 to 255");
  oi::BitSet<oi::Led> lit;
  if ((leds & CARGOBAY_LED_PLAY) != 0) lit = lit.with(oi::Led::play);
  if ((leds & CARGOBAY_LED_ADVANCE) != 0) lit = lit.with(oi::Led::advance);
  return send_command(robot, oi::Leds{.leds = lit,
                                      .power_color = byte_of(power_color),
                                      .power_intensity = byte_of(power_intensity)});
}

int cargobay_set_digital_outputs(struct cargobay_robot* robot, uint32_t outputs) {
  if (outputs >> kOutputs != 0) return bad_argument("`outputs` may only have bits 0 to 2");
  return send_command(robot, oi::DigitalOutputs{oi::BitSet<oi::DigitalOutput>{byte_of(outputs)}});
}

int cargobay_set_low_side_drivers(struct cargobay_robot* robot, uint32_t drivers) {
  if (drivers >> kOutputs != 0) return bad_argument("`drivers` may only have bits 0 to 2");
  return send_command(robot, oi::LowSideDrivers{oi::BitSet<oi::LowSideDriver>{byte_of(drivers)}});
}

int cargobay_set_pwm_low_side_drivers(struct cargobay_robot* robot, uint32_t driver_0,
                                      uint32_t driver_1, uint32_t driver_2) {
  constexpr std::uint32_t kMost = 128;
  if (driver_0 > kMost || driver_1 > kMost || driver_2 > kMost)
    return bad_argument("`driver_0`, `driver_1` and `driver_2` must be 0 to 128 (OI p. 10)");
  return send_command(robot, oi::PwmLowSideDrivers{.driver_0 = byte_of(driver_0),
                                                   .driver_1 = byte_of(driver_1),
                                                   .driver_2 = byte_of(driver_2)});
}

int cargobay_send_ir(struct cargobay_robot* robot, uint32_t byte) {
  if (byte > kMostByte) return bad_argument("`byte` must be 0 to 255");
  return send_command(robot, oi::SendIr{byte_of(byte)});
}

int cargobay_store_song(struct cargobay_robot* robot, uint32_t slot,
                        const struct cargobay_note* notes, size_t count) {
  if (slot >= oi::kSongSlots) return bad_argument("`slot` must be 0 to 15");
  if (notes == nullptr) return bad_argument("`notes` is NULL");
  if (count < 1 || count > oi::kMaxSongNotes)
    return bad_argument(
        "a song has 1 to 16 notes; cargobay_store_tune() spreads more over several");
  oi::Song song{.slot = byte_of(slot)};
  for (const cargobay_note& note : std::span{notes, count}) {
    const bool fits = note.number <= kMostByte && note.reserved == 0 && note.duration_ns >= 0 &&
                      note.duration_ns <= kMostByte * kNsPer64th;
    if (!fits) {
      return bad_argument(
          "a note's `number` must be 0 to 255, its `duration_ns` 0 to 3984375000, 255/64 s, and "
          "`reserved` 0");
    }
    const std::int64_t steps = (note.duration_ns + kNsPer64th / 2) / kNsPer64th;
    (void)song.notes.push_back({.number = byte_of(note.number),
                                .duration = oi::SixtyFourths{static_cast<std::uint8_t>(steps)}});
  }
  return with(robot, [&](Session& session) {
    const auto encoded = oi::encode(song);
    // 35 bytes: at 19200 baud they do not fit beside the loop's own, and a song is worth the pause.
    return send(session, *encoded, CARGOBAY_HOW_PAUSE_DRIVING);
  });
}

int cargobay_play_song(struct cargobay_robot* robot, uint32_t slot) {
  if (slot >= oi::kSongSlots) return bad_argument("`slot` must be 0 to 15");
  return send_command(robot, oi::Play{byte_of(slot)});
}

int cargobay_store_tune(struct cargobay_robot* robot, uint32_t slot, const char* rtttl,
                        int64_t* durations_ns, size_t capacity) {
  if (rtttl == nullptr) return bad_argument("`rtttl` is NULL");
  if (slot >= oi::kSongSlots) return bad_argument("`slot` must be 0 to 15");
  const std::span durations{durations_ns, durations_ns == nullptr ? 0 : capacity};
  return with(robot, [&](Session& session) {
    return store_tune(session, byte_of(slot), rtttl, durations);
  });
}

int cargobay_store_script(struct cargobay_robot* robot, const char* text, uint32_t how) {
  if (text == nullptr) return bad_argument("`text` is NULL");
  if (!known_how(how)) return bad_how();
  return with(robot, [&](Session& session) {
    oi::Script script;
    if (const auto error = oi::compile(text, script)) {
      std::array<char, 400> said{};
      const std::size_t length = oi::format_error(*error, text, said);
      return bad_argument({said.data(), length});
    }
    const auto encoded = oi::encode(script);
    return send(session, *encoded, how);  // compiled, so it can be encoded
  });
}

int cargobay_play_script(struct cargobay_robot* robot, int64_t expected_ns) {
  if (const int bad = check_duration("expected_ns", expected_ns); bad != CARGOBAY_OK) return bad;
  // Announced only if the command was accepted: the robot plays it a frame later at the earliest.
  if (const int failed = send_command(robot, oi::PlayScript{}); failed != CARGOBAY_OK)
    return failed;
  return cargobay_expect_silence(robot, expected_ns);
}

int cargobay_send_command(struct cargobay_robot* robot, const char* text, uint32_t how) {
  if (text == nullptr) return bad_argument("`text` is NULL");
  if (!known_how(how)) return bad_how();
  return with(robot, [&](Session& session) {
    std::array<std::uint8_t, 512> bytes{};
    const oi::TextResult encoded = oi::encode_text(text, bytes);
    if (encoded.error) {
      std::array<char, 400> said{};
      const std::size_t length = oi::format_error(*encoded.error, text, said);
      return bad_argument({said.data(), length});
    }
    return send_bytes(session, std::span{bytes}.first(encoded.bytes), how);
  });
}

int cargobay_send_bytes(struct cargobay_robot* robot, const uint8_t* bytes, size_t count,
                        uint32_t how) {
  if (bytes == nullptr) return bad_argument("`bytes` is NULL");
  if (!known_how(how)) return bad_how();
  return with(robot, [&](Session& session) { return send_bytes(session, {bytes, count}, how); });
}

}  // extern "C"
