// A robot's handle: open and close, and what kind of robot it is.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>

#include "hal/bring_up/bring_up.hpp"
#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "hal/c/sized.hpp"
#include "hal/c/text.hpp"
#include "hal/c/waiting.hpp"
#include "hal/config/setting_table.hpp"
#include "hal/file/port_descriptor.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"

namespace cargobay::c {
namespace {

// How long to wait for cargobay_start() and cargobay_end() on another thread.
constexpr std::chrono::seconds kOthersEnd{3};

int open_robot(const cargobay_options& options, cargobay_robot** handle) {
  auto object = std::make_unique<RobotObject>();
  std::optional<hal::OutputFile> record;
  if (const int failed = object->opening.prepare(options, record); failed != CARGOBAY_OK)
    return failed;
  const std::unique_lock lock{object->owner(), std::try_to_lock};
  if (!lock) return moved_elsewhere();
  if (object->opening.published) {
    if (const int failed = object->publish(); failed != CARGOBAY_OK) return failed;
  }
  if (const int failed = object->open_session(); failed != CARGOBAY_OK) return failed;
  {
    const SessionUse session{*object};
    if (record) session->record_file.emplace(std::move(*record));
  }
  *handle = static_cast<cargobay_robot*>(robots().open(std::move(object)));
  if (*handle == nullptr)
    return fail(CARGOBAY_E_LIMIT, "64 robots are open; close those that are not used");
  return CARGOBAY_OK;
}

int close_robot(cargobay_robot* robot) {
  bool lost = false;
  auto closed = robots().close(robot, [&lost](RobotObject& object) {
    object.closing.store(true);
    {
      const SessionUse session{object};
      if (session) session.cycle().request_stop();
    }
    const std::unique_lock lock{object.owner(), kOthersEnd};
    const SessionUse session{object};
    if (lock && session) session->end();
    lost = !lock || (session && session->robot->lost());
    return !lost;
  });
  if (!closed) return bad_robot(robot);
  if (!lost) return CARGOBAY_OK;
  keep(std::move(closed));
  return fail(CARGOBAY_E_STALLED,
              "the control function has not returned; the handle is closed, and the robot was "
              "stopped without it, but the thread and what it uses stay: end the program");
}

cargobay_bring_up bring_up_of(const hal::Robot& robot, std::uint32_t baud) {
  const hal::BringUpReport& report = robot.bring_up_report();
  cargobay_bring_up known{};
  known.found_baud = report.found_baud;
  known.baud = baud;
  known.rate_change = static_cast<std::int32_t>(report.rate_change);
  known.powered_on = report.powered_on ? 1 : 0;
  known.resynchronised = report.resynchronised ? 1 : 0;
  known.brc_pulses =
      static_cast<std::int32_t>(std::ranges::count_if(report.brc.pulses(), [](const auto& played) {
        return played.wanted.level == gpio::Level::low;
      }));
  known.battery_mv = report.battery_mv;
  known.took_ns = report.took.count();
  return known;
}
static_assert(static_cast<int>(hal::RateChange::brc) == CARGOBAY_RATE_CHANGE_BRC);
static_assert(static_cast<int>(hal::RateChange::command) == CARGOBAY_RATE_CHANGE_COMMAND);

std::uint32_t features_of(const RobotObject& object) {
  const oi::Dialect& dialect = *object.opening.wanted.cycle.dialect;
  struct Feature {
    std::uint8_t opcode;
    std::uint32_t bit;
  };
  std::uint32_t features =
      object.in_virtual_time() ? std::uint32_t{CARGOBAY_FEATURE_VIRTUAL_TIME} : 0U;
  for (const Feature& feature : std::to_array<Feature>({
           {oi::Leds::kOpcode, CARGOBAY_FEATURE_LEDS},
           {oi::Song::kOpcode, CARGOBAY_FEATURE_SONGS},
           {oi::Script::kOpcode, CARGOBAY_FEATURE_SCRIPTS},
           {oi::DigitalOutputs::kOpcode, CARGOBAY_FEATURE_DIGITAL_OUTPUTS},
           {oi::LowSideDrivers::kOpcode, CARGOBAY_FEATURE_LOW_SIDE_DRIVERS},
           {oi::SendIr::kOpcode, CARGOBAY_FEATURE_SEND_IR},
       })) {
    if (dialect.find_command(feature.opcode) != nullptr) features |= feature.bit;
  }
  return features;
}

cargobay_info info_of(const RobotObject& object, const SessionUse& session) {
  constexpr std::string_view kModel = "iRobot Create";
  cargobay_info known{};
  known.features = features_of(object);
  known.tick_ns = rt::Duration{oi::kTick}.count();
  known.wheel_base_mm = object.wheel_base_mm();
  known.max_wheel_mm_s = oi::kMaxWheelSpeed;
  known.baud = object.opening.baud;
  known.song_slots = oi::kSongSlots;
  known.song_notes = oi::kMaxSongNotes;
  known.script_bytes = oi::kMaxScriptBytes;
  known.spare_bytes = static_cast<std::uint32_t>(session.cycle().spare_bytes());
  static_assert(kModel.size() < sizeof known.model);
  std::copy(kModel.begin(), kModel.end(), std::begin(known.model));
  return known;
}

std::int64_t ns_of(double seconds) {
  constexpr double kNsPerS = 1e9;
  return static_cast<std::int64_t>(std::llround(seconds * kNsPerS));
}

cargobay_learnt learnt_of(const hal::Robot& robot, const rt::LearntPlant& plant) {
  cargobay_learnt known{};
  known.remainder = static_cast<std::int32_t>(plant.remainder);
  known.from_earlier = robot.began_from() ? 1 : 0;
  known.moved_ns = ns_of(plant.moved_s);
  known.lag_ns = ns_of(plant.lag_s);
  known.lag_sd_ns = ns_of(plant.lag_sd_s);
  known.dead_time_ns = ns_of(plant.dead_time_s);
  known.dead_time_sd_ns = ns_of(plant.dead_time_sd_s);
  known.ramp_s2_mm = plant.ramp_s2_mm;
  known.ramp_sd_s2_mm = plant.ramp_sd_s2_mm;
  known.gain_left = plant.gain_left;
  known.gain_left_sd = plant.gain_left_sd;
  known.gain_right = plant.gain_right;
  known.gain_right_sd = plant.gain_right_sd;
  known.carried_probability = 1.0 / (1.0 + std::exp(-plant.log_odds_carried));
  return known;
}
static_assert(static_cast<int>(rt::RemainderBelief::unknown) == CARGOBAY_REMAINDER_UNKNOWN);
static_assert(static_cast<int>(rt::RemainderBelief::carried) == CARGOBAY_REMAINDER_CARRIED);
static_assert(static_cast<int>(rt::RemainderBelief::lost) == CARGOBAY_REMAINDER_LOST);

// Their texts are literals, and end in NUL.
cargobay_setting setting_of(const hal::Setting& setting) {
  cargobay_setting known{};
  const auto text = [](std::string_view words) { return words.empty() ? "" : words.data(); };
  known.table = text(setting.table);
  known.key = text(setting.key);
  known.unit = text(setting.unit);
  known.default_value = text(setting.left_out);
  known.words = text(setting.meaning);
  known.example = text(setting.example);
  if (setting.range) {
    known.least = setting.range->least;
    known.most = setting.range->most;
  }
  return known;
}

}  // namespace
}  // namespace cargobay::c

using namespace cargobay::c;  // NOLINT(google-build-using-namespace): what C sees stands below

extern "C" {

int cargobay_open(const struct cargobay_options* options, struct cargobay_robot** robot) {
  if (robot == nullptr) return bad_argument("`robot` is NULL: give the address of a pointer");
  *robot = nullptr;
  if (in_control()) return not_from_control("cargobay_open");
  cargobay_options known{};
  if (options != nullptr && !take(options, known)) {
    return bad_argument(
        "cargobay_options: set `size` to its sizeof, and unused members to 0; a newer program's "
        "options need a newer library");
  }
  const int failed = guarded([&] {
    const cargobay::hal::StandardNumbersTaken taken;
    return open_robot(known, robot);
  });
  (void)copy_text(failed == CARGOBAY_OK ? "" : last_failure(), known.message, known.message_size);
  return failed;
}

int cargobay_close(struct cargobay_robot* robot) {
  if (robot == nullptr) return CARGOBAY_OK;
  if (in_control()) return not_from_control("cargobay_close");
  return guarded([&] { return close_robot(robot); });
}

int cargobay_get_bring_up(struct cargobay_robot* robot, struct cargobay_bring_up* bring_up) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  const SessionUse session{*use};
  if (!session) return no_session();
  const cargobay_bring_up known = bring_up_of(*session->robot, use->opening.baud);
  return give(known, bring_up) ? static_cast<int>(CARGOBAY_OK) : bad_argument(kBadOut);
}

int cargobay_get_info(struct cargobay_robot* robot, struct cargobay_info* info) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  const SessionUse session{*use};
  if (!session) return no_session();
  return give(info_of(*use, session), info) ? static_cast<int>(CARGOBAY_OK) : bad_argument(kBadOut);
}

int cargobay_get_learnt(struct cargobay_robot* robot, struct cargobay_learnt* learnt) {
  const RobotUse use = robots().use(robot);
  if (!use) return bad_robot(robot);
  const SessionUse session{*use};
  if (!session) return no_session();
  const auto plant = session.cycle().learnt();
  if (!plant) return sized(learnt) ? no_frame_yet() : bad_argument(kBadOut);
  return give(learnt_of(*session->robot, *plant), learnt) ? static_cast<int>(CARGOBAY_OK)
                                                          : bad_argument(kBadOut);
}

int cargobay_get_setting(uint32_t index, struct cargobay_setting* setting) {
  const auto all = cargobay::hal::settings();
  if (!sized(setting)) return bad_argument(kBadOut);
  if (index >= all.size()) return CARGOBAY_ENDED;
  (void)give(setting_of(all[index]), setting);  // checked above
  return CARGOBAY_OK;
}

}  // extern "C"
