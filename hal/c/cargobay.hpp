// The C++ API of Cargobay: cargobay.h with handles that close themselves, typed values, times as
// std::chrono, and errors as values. Header only: you link the C API.
//
//     auto robot = cargobay::Robot::open({.port = "/dev/ttyUSB0"});
//     if (!robot) return complain(robot.error().message);
//     robot->set_control([](const cargobay::State& state) -> cargobay::Output { ... });
//     robot->start();
//
// Every function does what the C function of the same name does, or the one named beside it; what
// looks is called get_... there. cargobay.h says what each function means, which errors it returns,
// which threads may call it, and whether it blocks; only the differences are documented here.
// Members, too, are those of C, in the same order; times lose their _ns, and there is no `size`.
//
// Nothing here throws. What is real-time safe in C is real-time safe here, errors included. If
// memory for a std::string, a std::vector or a std::function runs out, the program ends.
#pragma once

#if __cplusplus < 202002L
#error "cargobay.hpp needs C++20 or later: compile with -std=c++20, or use cargobay.h"
#else  // and nothing of it, or the compiler would complain of each line

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iterator>
#include <memory>
#include <new>
#include <optional>
#include <ratio>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "cargobay.h"

// One program may be linked from objects that were compiled against different versions of this
// header. The linker merges inline functions and instances of templates that have the same name, so
// two versions of a struct must be two types: std::vector<State> of one is not that of the other.
// That is what the namespace is for, and why no struct that grows is an alias of C's. A function of
// your own that takes a State from an object of the other version does not link.
static_assert(CARGOBAY_VERSION_MAJOR == 0 && CARGOBAY_VERSION_MINOR == 1,
              "each minor version has an inline namespace of its own: rename it");
namespace cargobay {
inline namespace v0_1 {

// --- enumerations: C's, in its order --------------------------------------------------------

// enum cargobay_error.
enum class ErrorCode : int {
  ok = CARGOBAY_OK,
  argument = CARGOBAY_E_ARGUMENT,
  handle = CARGOBAY_E_HANDLE,
  state = CARGOBAY_E_STATE,
  thread = CARGOBAY_E_THREAD,
  unsupported = CARGOBAY_E_UNSUPPORTED,
  control = CARGOBAY_E_CONTROL,
  config = CARGOBAY_E_CONFIG,
  file = CARGOBAY_E_FILE,
  rights = CARGOBAY_E_RIGHTS,
  memory = CARGOBAY_E_MEMORY,
  limit = CARGOBAY_E_LIMIT,
  system = CARGOBAY_E_SYSTEM,
  no_port = CARGOBAY_E_NO_PORT,
  busy = CARGOBAY_E_BUSY,
  access = CARGOBAY_E_ACCESS,
  pin = CARGOBAY_E_PIN,
  unplugged = CARGOBAY_E_UNPLUGGED,
  silent = CARGOBAY_E_SILENT,
  unconfirmed = CARGOBAY_E_UNCONFIRMED,
  mode = CARGOBAY_E_MODE,
  stalled = CARGOBAY_E_STALLED,
  guard = CARGOBAY_E_GUARD,
  full = CARGOBAY_E_FULL,
  timeout = CARGOBAY_E_TIMEOUT,
  no_frame = CARGOBAY_E_NO_FRAME,
  cancelled = CARGOBAY_E_CANCELLED,
  wheels = CARGOBAY_E_WHEELS,
};

// enum cargobay_sim_time. `virtual` is a keyword.
enum class SimTime : std::int32_t {
  real_time = CARGOBAY_SIM_TIME_REAL,
  virtual_time = CARGOBAY_SIM_TIME_VIRTUAL,
};

// enum cargobay_remainder.
enum class Remainder : std::int32_t {
  find_out = CARGOBAY_REMAINDER_FIND_OUT,
  unknown = CARGOBAY_REMAINDER_UNKNOWN,
  carried = CARGOBAY_REMAINDER_CARRIED,
  lost = CARGOBAY_REMAINDER_LOST,
};

// enum cargobay_mode.
enum class Mode : std::int32_t {
  off = CARGOBAY_MODE_OFF,
  passive = CARGOBAY_MODE_PASSIVE,
  safe = CARGOBAY_MODE_SAFE,
  full = CARGOBAY_MODE_FULL,
};

// enum cargobay_flag.
enum class Flag : std::uint32_t {
  require_realtime = CARGOBAY_FLAG_REQUIRE_REALTIME,
  no_realtime = CARGOBAY_FLAG_NO_REALTIME,
  no_guard = CARGOBAY_FLAG_NO_GUARD,
  hold_on_mode_loss = CARGOBAY_FLAG_HOLD_ON_MODE_LOSS,
  open_loop = CARGOBAY_FLAG_OPEN_LOOP,
  pin_cpu = CARGOBAY_FLAG_PIN_CPU,
  no_config = CARGOBAY_FLAG_NO_CONFIG,
  no_learnt = CARGOBAY_FLAG_NO_LEARNT,
  forget = CARGOBAY_FLAG_FORGET,
  hold_heading = CARGOBAY_FLAG_HOLD_HEADING,
  drive_on = CARGOBAY_FLAG_DRIVE_ON,
  publish = CARGOBAY_FLAG_PUBLISH,
};

// enum cargobay_rate_change.
enum class RateChange : std::int32_t {
  none = CARGOBAY_RATE_CHANGE_NONE,
  brc = CARGOBAY_RATE_CHANGE_BRC,
  command = CARGOBAY_RATE_CHANGE_COMMAND,
};

// enum cargobay_feature.
enum class Feature : std::uint32_t {
  leds = CARGOBAY_FEATURE_LEDS,
  songs = CARGOBAY_FEATURE_SONGS,
  scripts = CARGOBAY_FEATURE_SCRIPTS,
  digital_outputs = CARGOBAY_FEATURE_DIGITAL_OUTPUTS,
  low_side_drivers = CARGOBAY_FEATURE_LOW_SIDE_DRIVERS,
  send_ir = CARGOBAY_FEATURE_SEND_IR,
  virtual_time = CARGOBAY_FEATURE_VIRTUAL_TIME,
};

// enum cargobay_hazard.
enum class Hazard : std::uint32_t {
  wheel_drop_left = CARGOBAY_HAZARD_WHEEL_DROP_LEFT,
  wheel_drop_right = CARGOBAY_HAZARD_WHEEL_DROP_RIGHT,
  wheel_drop_front = CARGOBAY_HAZARD_WHEEL_DROP_FRONT,
  cliff_left = CARGOBAY_HAZARD_CLIFF_LEFT,
  cliff_front_left = CARGOBAY_HAZARD_CLIFF_FRONT_LEFT,
  cliff_front_right = CARGOBAY_HAZARD_CLIFF_FRONT_RIGHT,
  cliff_right = CARGOBAY_HAZARD_CLIFF_RIGHT,
  charger = CARGOBAY_HAZARD_CHARGER,
};

// enum cargobay_bump.
enum class Bump : std::uint32_t { left = CARGOBAY_BUMP_LEFT, right = CARGOBAY_BUMP_RIGHT };

// enum cargobay_button.
enum class Button : std::uint32_t {
  play = CARGOBAY_BUTTON_PLAY,
  advance = CARGOBAY_BUTTON_ADVANCE,
};

// enum cargobay_overcurrent.
enum class Overcurrent : std::uint32_t {
  wheel_left = CARGOBAY_OVERCURRENT_WHEEL_LEFT,
  wheel_right = CARGOBAY_OVERCURRENT_WHEEL_RIGHT,
  low_side_driver_0 = CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_0,
  low_side_driver_1 = CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_1,
  low_side_driver_2 = CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_2,
};

// enum cargobay_wheel.
enum class Wheel : std::uint32_t { left = CARGOBAY_WHEEL_LEFT, right = CARGOBAY_WHEEL_RIGHT };

// enum cargobay_limit.
enum class Limit : std::uint32_t {
  speed = CARGOBAY_LIMIT_SPEED,
  acceleration = CARGOBAY_LIMIT_ACCELERATION,
};

// enum cargobay_finding.
enum class Finding : std::int32_t {
  nothing = CARGOBAY_FINDING_NOTHING,
  still = CARGOBAY_FINDING_STILL,
  reversed = CARGOBAY_FINDING_REVERSED,
  few = CARGOBAY_FINDING_FEW,
  jumps = CARGOBAY_FINDING_JUMPS,
};

// enum cargobay_output_kind.
enum class OutputKind : std::int32_t {
  wheels = CARGOBAY_OUTPUT_WHEELS,
  twist = CARGOBAY_OUTPUT_TWIST,
  setpoint = CARGOBAY_OUTPUT_SETPOINT,
};

// enum cargobay_event_kind.
enum class EventKind : std::int32_t {
  mode_lost = CARGOBAY_EVENT_MODE_LOST,
  rearmed = CARGOBAY_EVENT_REARMED,
  rearm_failed = CARGOBAY_EVENT_REARM_FAILED,
  battery_low = CARGOBAY_EVENT_BATTERY_LOW,
  battery_recovered = CARGOBAY_EVENT_BATTERY_RECOVERED,
  overcurrent_began = CARGOBAY_EVENT_OVERCURRENT_BEGAN,
  overcurrent_ended = CARGOBAY_EVENT_OVERCURRENT_ENDED,
  charging_began = CARGOBAY_EVENT_CHARGING_BEGAN,
  charging_ended = CARGOBAY_EVENT_CHARGING_ENDED,
  frames_lost = CARGOBAY_EVENT_FRAMES_LOST,
  silence_began = CARGOBAY_EVENT_SILENCE_BEGAN,
  silence_ended = CARGOBAY_EVENT_SILENCE_ENDED,
  setpoint_lapsed = CARGOBAY_EVENT_SETPOINT_LAPSED,
  control_refused = CARGOBAY_EVENT_CONTROL_REFUSED,
  bump_began = CARGOBAY_EVENT_BUMP_BEGAN,
  bump_ended = CARGOBAY_EVENT_BUMP_ENDED,
  port_shared = CARGOBAY_EVENT_PORT_SHARED,
  wheel_stuck = CARGOBAY_EVENT_WHEEL_STUCK,
  counters_implausible = CARGOBAY_EVENT_COUNTERS_IMPLAUSIBLE,
  limit_began = CARGOBAY_EVENT_LIMIT_BEGAN,
  limit_ended = CARGOBAY_EVENT_LIMIT_ENDED,
};

// enum cargobay_packet.
enum class Packet : std::uint32_t {
  bumps_and_wheel_drops = CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS,
  wall = CARGOBAY_PACKET_WALL,
  cliff_left = CARGOBAY_PACKET_CLIFF_LEFT,
  cliff_front_left = CARGOBAY_PACKET_CLIFF_FRONT_LEFT,
  cliff_front_right = CARGOBAY_PACKET_CLIFF_FRONT_RIGHT,
  cliff_right = CARGOBAY_PACKET_CLIFF_RIGHT,
  virtual_wall = CARGOBAY_PACKET_VIRTUAL_WALL,
  overcurrents = CARGOBAY_PACKET_OVERCURRENTS,
  unused_1 = CARGOBAY_PACKET_UNUSED_1,
  unused_2 = CARGOBAY_PACKET_UNUSED_2,
  infrared_byte = CARGOBAY_PACKET_INFRARED_BYTE,
  buttons = CARGOBAY_PACKET_BUTTONS,
  distance = CARGOBAY_PACKET_DISTANCE,
  angle = CARGOBAY_PACKET_ANGLE,
  charging_state = CARGOBAY_PACKET_CHARGING_STATE,
  voltage = CARGOBAY_PACKET_VOLTAGE,
  current = CARGOBAY_PACKET_CURRENT,
  battery_temperature = CARGOBAY_PACKET_BATTERY_TEMPERATURE,
  battery_charge = CARGOBAY_PACKET_BATTERY_CHARGE,
  battery_capacity = CARGOBAY_PACKET_BATTERY_CAPACITY,
  wall_signal = CARGOBAY_PACKET_WALL_SIGNAL,
  cliff_left_signal = CARGOBAY_PACKET_CLIFF_LEFT_SIGNAL,
  cliff_front_left_signal = CARGOBAY_PACKET_CLIFF_FRONT_LEFT_SIGNAL,
  cliff_front_right_signal = CARGOBAY_PACKET_CLIFF_FRONT_RIGHT_SIGNAL,
  cliff_right_signal = CARGOBAY_PACKET_CLIFF_RIGHT_SIGNAL,
  digital_inputs = CARGOBAY_PACKET_DIGITAL_INPUTS,
  analog_signal = CARGOBAY_PACKET_ANALOG_SIGNAL,
  charging_sources = CARGOBAY_PACKET_CHARGING_SOURCES,
  oi_mode = CARGOBAY_PACKET_OI_MODE,
  song_number = CARGOBAY_PACKET_SONG_NUMBER,
  song_playing = CARGOBAY_PACKET_SONG_PLAYING,
  stream_packets = CARGOBAY_PACKET_STREAM_PACKETS,
  requested_velocity = CARGOBAY_PACKET_REQUESTED_VELOCITY,
  requested_radius = CARGOBAY_PACKET_REQUESTED_RADIUS,
  requested_right_velocity = CARGOBAY_PACKET_REQUESTED_RIGHT_VELOCITY,
  requested_left_velocity = CARGOBAY_PACKET_REQUESTED_LEFT_VELOCITY,
};

// enum cargobay_led.
enum class Led : std::uint32_t { play = CARGOBAY_LED_PLAY, advance = CARGOBAY_LED_ADVANCE };

// enum cargobay_how.
enum class How : std::uint32_t { pause_driving = CARGOBAY_HOW_PAUSE_DRIVING };

// enum cargobay_measure.
enum class Measure : int {
  period = CARGOBAY_MEASURE_PERIOD,
  frame_to_command = CARGOBAY_MEASURE_FRAME_TO_COMMAND,
};

// An enumeration of bits.
template <typename Bit>
concept BitEnum =
    std::same_as<Bit, Flag> || std::same_as<Bit, Feature> || std::same_as<Bit, Hazard> ||
    std::same_as<Bit, Bump> || std::same_as<Bit, Button> || std::same_as<Bit, Overcurrent> ||
    std::same_as<Bit, Wheel> || std::same_as<Bit, Limit> || std::same_as<Bit, Led> ||
    std::same_as<Bit, How>;

// Any number of bits of one enumeration: `Flag::no_config | Flag::no_guard`. Those that this header
// does not know are kept.
template <BitEnum Bit>
class Bits {
 public:
  constexpr Bits() noexcept = default;
  // NOLINTNEXTLINE(google-explicit-constructor): one bit is a set of bits
  constexpr Bits(Bit bit) noexcept : bits_{static_cast<std::uint32_t>(bit)} {}
  // As C has them.
  constexpr explicit Bits(std::uint32_t bits) noexcept : bits_{bits} {}

  // Whether there is any.
  constexpr explicit operator bool() const noexcept { return bits_ != 0; }
  constexpr bool has(Bit bit) const noexcept {
    return (bits_ & static_cast<std::uint32_t>(bit)) != 0;
  }
  constexpr std::uint32_t bits() const noexcept { return bits_; }

  constexpr Bits& operator|=(Bits others) noexcept {
    bits_ |= others.bits_;
    return *this;
  }
  friend constexpr Bits operator|(Bits some, Bits others) noexcept {
    return Bits{some.bits_ | others.bits_};
  }
  friend constexpr Bits operator&(Bits some, Bits others) noexcept {
    return Bits{some.bits_ & others.bits_};
  }
  friend constexpr bool operator==(Bits, Bits) noexcept = default;

 private:
  std::uint32_t bits_ = 0;
};

template <BitEnum Bit>
constexpr Bits<Bit> operator|(Bit one, Bit other) noexcept {
  return Bits<Bit>{one} | other;
}

using Flags = Bits<Flag>;
using Features = Bits<Feature>;
using Hazards = Bits<Hazard>;
using Bumps = Bits<Bump>;
using Buttons = Bits<Button>;
using Overcurrents = Bits<Overcurrent>;
using WheelSet = Bits<Wheel>;
using Limits = Bits<Limit>;
using Leds = Bits<Led>;

// --- errors ---------------------------------------------------------------------------------

// What failed. The text is a copy, so it lasts; it is not a std::string because some of the
// functions that fail must not allocate.
struct Error {
  ErrorCode code = ErrorCode::ok;
  char message[1024] = {};  // one line, with the remedy

  // Of the failed call just made on this thread.
  static Error last(int code) noexcept {
    Error error{.code = ErrorCode{code}};
    const char* const text = cargobay_error_message();
    std::memcpy(error.message, text, std::min(std::strlen(text), sizeof error.message - 1));
    return error;
  }
};

// For `return Unexpected{other.error()};`, as std::unexpected.
class Unexpected {
 public:
  explicit Unexpected(const Error& error) noexcept : error_{error} {}
  const Error& error() const noexcept { return error_; }

 private:
  Error error_;
};

// A value, or the error that explains why there is none: what std::expected<T, Error> is in C++23,
// and nothing that it is not. It is not an alias of that even if there is one: objects compiled as
// C++20 and as C++23 may be linked together.
template <typename T>
class [[nodiscard]] Expected {
 public:
  // NOLINTBEGIN(google-explicit-constructor): for `return value;` and `return Unexpected{error};`
  template <typename U = T>
    requires(!std::same_as<std::remove_cvref_t<U>, Expected> &&
             !std::same_as<std::remove_cvref_t<U>, Unexpected> && std::is_convertible_v<U, T>)
  Expected(U&& value) noexcept : content_{std::in_place_index<0>, std::forward<U>(value)} {}
  Expected(const Unexpected& none) noexcept : content_{std::in_place_index<1>, none.error()} {}
  // NOLINTEND(google-explicit-constructor)

  bool has_value() const noexcept { return content_.index() == 0; }
  explicit operator bool() const noexcept { return has_value(); }
  // Only if there is a value.
  T& operator*() & noexcept { return *value_or_null(); }
  const T& operator*() const& noexcept { return *value_or_null(); }
  T&& operator*() && noexcept { return std::move(*value_or_null()); }
  T* operator->() noexcept { return value_or_null(); }
  const T* operator->() const noexcept { return value_or_null(); }
  // Only if there is no value.
  const Error& error() const noexcept {
    assert(!has_value());
    return *std::get_if<1>(&content_);
  }

  template <typename U>
  T value_or(U&& other) const& noexcept {
    return has_value() ? **this : static_cast<T>(std::forward<U>(other));
  }
  template <typename U>
  T value_or(U&& other) && noexcept {
    return has_value() ? *std::move(*this) : static_cast<T>(std::forward<U>(other));
  }

 private:
  T* value_or_null() noexcept {
    assert(has_value());
    return std::get_if<0>(&content_);
  }
  const T* value_or_null() const noexcept {
    assert(has_value());
    return std::get_if<0>(&content_);
  }

  std::variant<T, Error> content_;
};

// Success, or the error.
template <>
class [[nodiscard]] Expected<void> {
 public:
  Expected() noexcept = default;
  // NOLINTNEXTLINE(google-explicit-constructor): for `return Unexpected{error};`
  Expected(const Unexpected& none) noexcept : error_{none.error()} {}

  bool has_value() const noexcept { return !error_; }
  explicit operator bool() const noexcept { return has_value(); }
  const Error& error() const noexcept {
    assert(error_);
    return *error_;
  }

 private:
  std::optional<Error> error_{};
};

// What a wait brought: a value; or none, because the loop was asked to end, or because of an error.
//
//     const auto state = robot.wait(tick, 1s);
//     if (!state) return state.outcome();
//     print(state->x_mm);
template <typename T>
class [[nodiscard]] Waited {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): for `return value;` and the like
  Waited(Expected<std::optional<T>> content) noexcept : content_{std::move(content)} {}

  explicit operator bool() const noexcept { return content_ && *content_; }
  // Only if there is a value.
  const T& operator*() const noexcept { return **content_; }
  const T* operator->() const noexcept { return &**content_; }

  // CARGOBAY_ENDED: none will come, and nothing went wrong.
  bool ended() const noexcept { return content_ && !*content_; }
  // Why there is no value: success if the loop was asked to end, else the error. Success, too, if
  // there is a value.
  Expected<void> outcome() const noexcept {
    if (!content_) return Unexpected{content_.error()};
    return {};
  }
  ErrorCode code() const noexcept { return content_ ? ErrorCode::ok : content_.error().code; }

 private:
  Expected<std::optional<T>> content_;
};

// --- structs --------------------------------------------------------------------------------

// struct cargobay_wheels.
struct Wheels {
  double left_mm_s = 0.0;
  double right_mm_s = 0.0;
};

// struct cargobay_twist.
struct Twist {
  double velocity_mm_s = 0.0;
  double turn_rate_rad_s = 0.0;
};

// struct cargobay_truth.
struct Truth {
  Mode mode{};
  std::chrono::nanoseconds sim_time{0};
  double left_mm_s = 0.0;
  double right_mm_s = 0.0;
  double x_mm = 0.0;
  double y_mm = 0.0;
  double heading_rad = 0.0;
  std::int32_t commanded_left_mm_s = 0;
  std::int32_t commanded_right_mm_s = 0;
};

// struct cargobay_bring_up.
struct BringUp {
  std::uint32_t found_baud = 0;
  std::uint32_t baud = 0;
  RateChange rate_change{};
  bool powered_on = false;
  bool resynchronised = false;
  std::int32_t brc_pulses = 0;
  std::int32_t battery_mv = 0;
  std::chrono::nanoseconds took{0};
};

// struct cargobay_info.
struct Info {
  Features features{};
  std::chrono::nanoseconds tick{0};
  double wheel_base_mm = 0.0;
  double max_wheel_mm_s = 0.0;
  std::uint32_t baud = 0;
  std::uint32_t song_slots = 0;
  std::uint32_t song_notes = 0;
  std::uint32_t script_bytes = 0;
  std::uint32_t spare_bytes = 0;
  char model[32] = {};
};

// struct cargobay_learnt.
struct Learnt {
  Remainder remainder{};
  bool from_earlier = false;
  std::chrono::nanoseconds moved{0};
  std::chrono::nanoseconds lag{0};
  std::chrono::nanoseconds lag_sd{0};
  std::chrono::nanoseconds dead_time{0};
  std::chrono::nanoseconds dead_time_sd{0};
  double ramp_s2_mm = 0.0;
  double ramp_sd_s2_mm = 0.0;
  double gain_left = 0.0;
  double gain_left_sd = 0.0;
  double gain_right = 0.0;
  double gain_right_sd = 0.0;
  double carried_probability = 0.0;
};

// struct cargobay_setting.
struct Setting {
  std::string_view table{};
  std::string_view key{};
  std::string_view unit{};
  std::string_view default_value{};
  std::string_view words{};
  std::string_view example{};
  double least = 0.0;
  double most = 0.0;
};

// struct cargobay_state.
struct State {
  Mode mode{};
  std::int64_t tick = -1;
  std::chrono::nanoseconds robot_time{0};
  std::chrono::nanoseconds elapsed{0};
  std::chrono::nanoseconds arrival{0};
  Wheels target{};
  Wheels limited{};
  Wheels estimate{};
  Wheels command{};
  double velocity_mm_s = 0.0;
  double turn_rate_rad_s = 0.0;
  double x_mm = 0.0;
  double y_mm = 0.0;
  double heading_rad = 0.0;
  double distance_mm = 0.0;
  std::array<double, 9> covariance{};
  Remainder remainder{};
  bool setpoint_lapsed = false;
  Hazards hazards{};
  Bumps bumps{};
  Buttons buttons{};
  std::int32_t battery_mv = 0;
  Limits limits{};
};

// struct cargobay_end_report.
struct EndReport {
  bool ended = false;
  ErrorCode code{};
  std::int32_t control_result = 0;
  Hazards hazards{};
  bool passive_seen = false;
  bool guard_lost = false;
  char message[512] = {};
};

// struct cargobay_event.
struct Event {
  EventKind kind{};
  std::int64_t sequence = 0;
  std::int64_t tick = 0;
  std::chrono::nanoseconds arrival{0};
  Mode mode{};
  Hazards hazards{};
  Overcurrents overcurrents{};
  std::uint32_t frames = 0;
  Bumps bumps{};
  std::int32_t voltage_mv = 0;
  std::int32_t charge_mah = 0;
  std::int32_t capacity_mah = 0;
  std::int32_t process = 0;
  WheelSet wheels{};
  char process_name[16] = {};
  Finding finding{};
  Limits limits{};
  Wheels wanted{};
  Wheels got{};
};

// struct cargobay_reading.
struct Reading {
  std::int64_t tick = -1;
  std::chrono::nanoseconds arrival{0};
  std::int32_t value = 0;
  Packet packet = Packet::bumps_and_wheel_drops;
};

// struct cargobay_note.
struct Note {
  std::chrono::nanoseconds duration{0};
  std::uint32_t number = 0;
};

// struct cargobay_statistics.
struct Statistics {
  std::int32_t scheduler = 0;
  std::int32_t priority = 0;
  bool memory_locked = false;
  std::int64_t ticks = 0;
  std::uint64_t frames_good = 0;
  std::uint64_t frames_bad = 0;
  std::uint64_t frames_lost = 0;
  std::uint64_t frames_late = 0;
  std::uint64_t overruns_wait = 0;
  std::uint64_t overruns_read = 0;
  std::uint64_t overruns_control = 0;
  std::uint64_t overruns_write = 0;
  std::uint64_t controls_refused = 0;
  std::uint64_t commands_unsent = 0;
  std::uint64_t commands_withheld = 0;
  std::uint64_t events = 0;
};

// struct cargobay_distribution.
struct Distribution {
  std::uint64_t count = 0;
  std::chrono::nanoseconds min{0};
  std::chrono::nanoseconds p50{0};
  std::chrono::nanoseconds p90{0};
  std::chrono::nanoseconds p99{0};
  std::chrono::nanoseconds p999{0};
  std::chrono::nanoseconds max{0};
  std::chrono::duration<double, std::nano> mean{0.0};
};

// --- conversion -----------------------------------------------------------------------------

namespace detail {

using std::chrono::nanoseconds;

// Templates of the standard library are never given C's structs here: two versions of
// std::array<cargobay_state, 8> have one name.
template <typename Plain>
Plain sized() noexcept {
  Plain plain{};
  plain.size = sizeof plain;
  return plain;
}

inline std::string_view view(const char* text) noexcept {
  return text == nullptr ? std::string_view{} : text;
}

inline Wheels typed(const cargobay_wheels& plain) noexcept {
  return {.left_mm_s = plain.left_mm_s, .right_mm_s = plain.right_mm_s};
}

inline cargobay_wheels plain_of(Wheels wheels) noexcept {
  return {.left_mm_s = wheels.left_mm_s, .right_mm_s = wheels.right_mm_s};
}

inline cargobay_twist plain_of(Twist twist) noexcept {
  return {.velocity_mm_s = twist.velocity_mm_s, .turn_rate_rad_s = twist.turn_rate_rad_s};
}

inline Truth typed(const cargobay_truth& plain) noexcept {
  return {.mode = Mode{plain.mode},
          .sim_time = nanoseconds{plain.sim_time_ns},
          .left_mm_s = plain.left_mm_s,
          .right_mm_s = plain.right_mm_s,
          .x_mm = plain.x_mm,
          .y_mm = plain.y_mm,
          .heading_rad = plain.heading_rad,
          .commanded_left_mm_s = plain.commanded_left_mm_s,
          .commanded_right_mm_s = plain.commanded_right_mm_s};
}

inline BringUp typed(const cargobay_bring_up& plain) noexcept {
  return {.found_baud = plain.found_baud,
          .baud = plain.baud,
          .rate_change = RateChange{plain.rate_change},
          .powered_on = plain.powered_on != 0,
          .resynchronised = plain.resynchronised != 0,
          .brc_pulses = plain.brc_pulses,
          .battery_mv = plain.battery_mv,
          .took = nanoseconds{plain.took_ns}};
}

inline Info typed(const cargobay_info& plain) noexcept {
  Info info{.features = Features{plain.features},
            .tick = nanoseconds{plain.tick_ns},
            .wheel_base_mm = plain.wheel_base_mm,
            .max_wheel_mm_s = plain.max_wheel_mm_s,
            .baud = plain.baud,
            .song_slots = plain.song_slots,
            .song_notes = plain.song_notes,
            .script_bytes = plain.script_bytes,
            .spare_bytes = plain.spare_bytes};
  std::memcpy(info.model, plain.model, sizeof info.model);
  return info;
}

inline Learnt typed(const cargobay_learnt& plain) noexcept {
  return {.remainder = Remainder{plain.remainder},
          .from_earlier = plain.from_earlier != 0,
          .moved = nanoseconds{plain.moved_ns},
          .lag = nanoseconds{plain.lag_ns},
          .lag_sd = nanoseconds{plain.lag_sd_ns},
          .dead_time = nanoseconds{plain.dead_time_ns},
          .dead_time_sd = nanoseconds{plain.dead_time_sd_ns},
          .ramp_s2_mm = plain.ramp_s2_mm,
          .ramp_sd_s2_mm = plain.ramp_sd_s2_mm,
          .gain_left = plain.gain_left,
          .gain_left_sd = plain.gain_left_sd,
          .gain_right = plain.gain_right,
          .gain_right_sd = plain.gain_right_sd,
          .carried_probability = plain.carried_probability};
}

inline Setting typed(const cargobay_setting& plain) noexcept {
  return {.table = view(plain.table),
          .key = view(plain.key),
          .unit = view(plain.unit),
          .default_value = view(plain.default_value),
          .words = view(plain.words),
          .example = view(plain.example),
          .least = plain.least,
          .most = plain.most};
}

inline State typed(const cargobay_state& plain) noexcept {
  State state{.mode = Mode{plain.mode},
              .tick = plain.tick,
              .robot_time = nanoseconds{plain.robot_time_ns},
              .elapsed = nanoseconds{plain.elapsed_ns},
              .arrival = nanoseconds{plain.arrival_ns},
              .target = typed(plain.target),
              .limited = typed(plain.limited),
              .estimate = typed(plain.estimate),
              .command = typed(plain.command),
              .velocity_mm_s = plain.velocity_mm_s,
              .turn_rate_rad_s = plain.turn_rate_rad_s,
              .x_mm = plain.x_mm,
              .y_mm = plain.y_mm,
              .heading_rad = plain.heading_rad,
              .distance_mm = plain.distance_mm,
              .remainder = Remainder{plain.remainder},
              .setpoint_lapsed = plain.setpoint_lapsed != 0,
              .hazards = Hazards{plain.hazards},
              .bumps = Bumps{plain.bumps},
              .buttons = Buttons{plain.buttons},
              .battery_mv = plain.battery_mv,
              .limits = Limits{plain.limits}};
  std::memcpy(state.covariance.data(), plain.covariance, sizeof plain.covariance);
  return state;
}

// What the library passes to a control function may be shorter than this header's struct: what it
// lacks is 0.
inline State known(const cargobay_state& given) noexcept {
  cargobay_state plain{};
  std::memcpy(&plain, &given, std::min<std::size_t>(given.size, sizeof plain));
  return typed(plain);
}

inline EndReport typed(const cargobay_end_report& plain) noexcept {
  EndReport report{.ended = plain.ended != 0,
                   .code = ErrorCode{plain.code},
                   .control_result = plain.control_result,
                   .hazards = Hazards{plain.hazards},
                   .passive_seen = plain.passive_seen != 0,
                   .guard_lost = plain.guard_lost != 0};
  std::memcpy(report.message, plain.message, sizeof report.message);
  return report;
}

inline Event typed(const cargobay_event& plain) noexcept {
  Event event{.kind = EventKind{plain.kind},
              .sequence = plain.sequence,
              .tick = plain.tick,
              .arrival = nanoseconds{plain.arrival_ns},
              .mode = Mode{plain.mode},
              .hazards = Hazards{plain.hazards},
              .overcurrents = Overcurrents{plain.overcurrents},
              .frames = plain.frames,
              .bumps = Bumps{plain.bumps},
              .voltage_mv = plain.voltage_mv,
              .charge_mah = plain.charge_mah,
              .capacity_mah = plain.capacity_mah,
              .process = plain.process,
              .wheels = WheelSet{plain.wheels},
              .finding = Finding{plain.finding},
              .limits = Limits{plain.limits},
              .wanted = typed(plain.wanted),
              .got = typed(plain.got)};
  std::memcpy(event.process_name, plain.process_name, sizeof event.process_name);
  return event;
}

inline cargobay_event plain_of(const Event& event) noexcept {
  auto plain = sized<cargobay_event>();
  plain.kind = static_cast<std::int32_t>(event.kind);
  plain.sequence = event.sequence;
  plain.tick = event.tick;
  plain.arrival_ns = event.arrival.count();
  plain.mode = static_cast<std::int32_t>(event.mode);
  plain.hazards = event.hazards.bits();
  plain.overcurrents = event.overcurrents.bits();
  plain.frames = event.frames;
  plain.bumps = event.bumps.bits();
  plain.voltage_mv = event.voltage_mv;
  plain.charge_mah = event.charge_mah;
  plain.capacity_mah = event.capacity_mah;
  plain.process = event.process;
  plain.wheels = event.wheels.bits();
  plain.finding = static_cast<std::int32_t>(event.finding);
  plain.limits = event.limits.bits();
  plain.wanted = plain_of(event.wanted);
  plain.got = plain_of(event.got);
  std::memcpy(plain.process_name, event.process_name, sizeof plain.process_name);
  return plain;
}

inline Reading typed(const cargobay_reading& plain) noexcept {
  return {.tick = plain.tick,
          .arrival = nanoseconds{plain.arrival_ns},
          .value = plain.value,
          .packet = Packet{plain.packet}};
}

inline Statistics typed(const cargobay_statistics& plain) noexcept {
  return {.scheduler = plain.scheduler,
          .priority = plain.priority,
          .memory_locked = plain.memory_locked != 0,
          .ticks = plain.ticks,
          .frames_good = plain.frames_good,
          .frames_bad = plain.frames_bad,
          .frames_lost = plain.frames_lost,
          .frames_late = plain.frames_late,
          .overruns_wait = plain.overruns_wait,
          .overruns_read = plain.overruns_read,
          .overruns_control = plain.overruns_control,
          .overruns_write = plain.overruns_write,
          .controls_refused = plain.controls_refused,
          .commands_unsent = plain.commands_unsent,
          .commands_withheld = plain.commands_withheld,
          .events = plain.events};
}

inline Distribution typed(const cargobay_distribution& plain) noexcept {
  return {.count = plain.count,
          .min = nanoseconds{plain.min_ns},
          .p50 = nanoseconds{plain.p50_ns},
          .p90 = nanoseconds{plain.p90_ns},
          .p99 = nanoseconds{plain.p99_ns},
          .p999 = nanoseconds{plain.p999_ns},
          .max = nanoseconds{plain.max_ns},
          .mean = std::chrono::duration<double, std::nano>{plain.mean_ns}};
}

// Packets as C wants them. Too many become one more than it allows.
class PacketNumbers {
 public:
  explicit PacketNumbers(std::span<const Packet> packets) noexcept
      : count_{std::min(packets.size(), std::size(numbers_))} {
    for (std::size_t i = 0; i < count_; ++i) numbers_[i] = static_cast<std::uint32_t>(packets[i]);
  }
  const std::uint32_t* data() const noexcept { return numbers_; }
  std::size_t size() const noexcept { return count_; }

  static constexpr std::size_t kMost = 64;

 private:
  std::uint32_t numbers_[kMost + 1] = {};
  std::size_t count_;
};

// --- outcomes -------------------------------------------------------------------------------

inline Unexpected failure(int code) noexcept { return Unexpected{Error::last(code)}; }

inline Expected<void> outcome(int code) noexcept {
  if (code < 0) return failure(code);
  return {};
}

// What a C function fills in.
template <typename Handle, typename Plain>
auto fetched(int (*get)(Handle*, Plain*), Handle* handle) noexcept
    -> Expected<decltype(typed(Plain{}))> {
  auto plain = sized<Plain>();
  if (const int code = get(handle, &plain); code < 0) return failure(code);
  return typed(plain);
}

// What a C function that waits has filled in.
template <typename Plain>
auto waited(int code, const Plain& plain) noexcept -> Waited<decltype(typed(plain))> {
  using Content = Expected<std::optional<decltype(typed(plain))>>;
  if (code < 0) return Content{failure(code)};
  if (code == CARGOBAY_ENDED) return Content{std::nullopt};
  return Content{typed(plain)};
}

// The text that a C function wrote: the function returns the full length, and truncates what does
// not fit.
inline Expected<std::string> text(int length, std::string buffer) noexcept {
  if (length < 0) return failure(length);
  buffer.resize(std::min(static_cast<std::size_t>(length), buffer.size() - 1));
  return buffer;
}

inline constexpr std::size_t kMostText = 8192;  // longer than any answer

inline const char* or_null(const std::string& text) noexcept {
  return text.empty() ? nullptr : text.c_str();
}

template <auto kClose>
struct Closer {
  template <typename T>
  void operator()(T* handle) const noexcept {
    (void)kClose(handle);  // a destructor has no one to tell
  }
};

template <typename T, auto kClose>
using Handle = std::unique_ptr<T, Closer<kClose>>;

// A failure leaves the handle as it was.
template <typename T, auto kClose>
Expected<void> close(Handle<T, kClose>& handle) noexcept {
  const int code = kClose(handle.get());
  if (code < 0) return failure(code);
  (void)handle.release();  // just closed
  return {};
}

// One step through what a reader gets, for its begin().
template <typename Reader>
class Step {
 public:
  using value_type = std::remove_cvref_t<decltype(std::declval<Reader&>().current())>;
  using difference_type = std::ptrdiff_t;

  Step() noexcept = default;
  explicit Step(Reader& reader) noexcept : reader_{&reader} { reader_->take_next(); }

  const value_type& operator*() const noexcept { return reader_->current(); }
  const value_type* operator->() const noexcept { return &reader_->current(); }
  Step& operator++() noexcept {
    reader_->take_next();
    return *this;
  }
  void operator++(int) noexcept { ++*this; }
  friend bool operator==(const Step& step, std::default_sentinel_t) noexcept {
    return !step.reader_->has_current();
  }

 private:
  Reader* reader_ = nullptr;
};

}  // namespace detail

// --- names ----------------------------------------------------------------------------------

// Of the library in use. All these end with a NUL.
inline std::string_view version() noexcept { return cargobay_version(); }
inline std::uint32_t version_number() noexcept { return cargobay_version_number(); }
inline std::string_view error_name(ErrorCode code) noexcept {
  return cargobay_error_name(static_cast<int>(code));
}
inline std::string_view mode_name(Mode mode) noexcept {
  return cargobay_mode_name(static_cast<int>(mode));
}
inline std::string_view event_name(EventKind kind) noexcept {
  return cargobay_event_name(static_cast<int>(kind));
}
inline std::string_view packet_name(Packet packet) noexcept {
  return cargobay_packet_name(static_cast<int>(packet));
}

// cargobay_describe_event().
inline std::string describe(const Event& event) noexcept {
  const cargobay_event plain = detail::plain_of(event);
  std::string buffer(detail::kMostText, '\0');
  const int length = cargobay_describe_event(&plain, buffer.data(), buffer.size());
  return detail::text(length, std::move(buffer)).value_or(std::string{});
}

// cargobay_get_setting(); std::nullopt after the last.
inline std::optional<Setting> setting(std::uint32_t index) noexcept {
  auto plain = detail::sized<cargobay_setting>();
  if (cargobay_get_setting(index, &plain) != CARGOBAY_OK) return std::nullopt;
  return detail::typed(plain);
}

// --- virtual Create -------------------------------------------------------------------------

class Sim;

// Like struct cargobay_sim_options: 0 and "" are the default.
struct SimOptions {
  SimTime time = SimTime::real_time;
  std::uint64_t seed = 0;
  Remainder remainder = Remainder::unknown;
  std::uint32_t boot_baud = 0;
  std::string link{};
  std::string world{};
  Sim* beside = nullptr;  // outlives this one
  std::string plant{};
  std::chrono::nanoseconds lag{0};
  double gain_left = 0.0;
  double gain_right = 0.0;
  double noise_mm_s = 0.0;
  double wheel_base_mm = 0.0;
};

// struct cargobay_sim. Declare it before the robot that uses it and before those `beside` it, so
// that it is destroyed after them.
class Sim {
 public:
  // cargobay_sim_open().
  static Expected<Sim> open(const SimOptions& options = {}) noexcept {
    // NULL would mean a world of its own.
    if (options.beside != nullptr && options.beside->handle() == nullptr) {
      return Unexpected{
          Error{.code = ErrorCode::handle, .message = "the virtual Create `beside` is closed"}};
    }
    auto plain = detail::sized<cargobay_sim_options>();
    plain.time = static_cast<std::int32_t>(options.time);
    plain.seed = options.seed;
    plain.remainder = static_cast<std::int32_t>(options.remainder);
    plain.boot_baud = options.boot_baud;
    plain.link = detail::or_null(options.link);
    plain.world = detail::or_null(options.world);
    plain.beside = options.beside != nullptr ? options.beside->handle() : nullptr;
    plain.plant = detail::or_null(options.plant);
    plain.lag_ns = options.lag.count();
    plain.gain_left = options.gain_left;
    plain.gain_right = options.gain_right;
    plain.noise_mm_s = options.noise_mm_s;
    plain.wheel_base_mm = options.wheel_base_mm;
    cargobay_sim* handle = nullptr;
    if (const int code = cargobay_sim_open(&plain, &handle); code < 0) return detail::failure(code);
    return Sim{handle};
  }

  // cargobay_sim_close(). The destructor does it too.
  Expected<void> close() noexcept { return detail::close(handle_); }

  // cargobay_sim_get_path().
  Expected<std::string> path() const noexcept {
    std::string buffer(detail::kMostText, '\0');
    const int length = cargobay_sim_get_path(handle(), buffer.data(), buffer.size());
    return detail::text(length, std::move(buffer));
  }

  // cargobay_sim_inject(); the answer.
  Expected<std::string> inject(const std::string& line) noexcept {
    std::string buffer(detail::kMostText, '\0');
    const int length = cargobay_sim_inject(handle(), line.c_str(), buffer.data(), buffer.size());
    return detail::text(length, std::move(buffer));
  }

  // cargobay_sim_get_truth().
  Expected<Truth> truth() const noexcept {
    return detail::fetched(cargobay_sim_get_truth, handle());
  }

  // cargobay_sim_advance().
  Expected<void> advance(std::chrono::nanoseconds duration) noexcept {
    return detail::outcome(cargobay_sim_advance(handle(), duration.count()));
  }

  // For the C API; nullptr if closed or moved from.
  cargobay_sim* handle() const noexcept { return handle_.get(); }

 private:
  explicit Sim(cargobay_sim* handle) noexcept : handle_{handle} {}

  detail::Handle<cargobay_sim, cargobay_sim_close> handle_;
};

// --- histogram ------------------------------------------------------------------------------

// struct cargobay_histogram.
class Histogram {
 public:
  // cargobay_histogram_open().
  static Expected<Histogram> open() noexcept {
    cargobay_histogram* handle = nullptr;
    if (const int code = cargobay_histogram_open(&handle); code < 0) return detail::failure(code);
    return Histogram{handle};
  }

  // cargobay_histogram_close(). The destructor does it too.
  Expected<void> close() noexcept { return detail::close(handle_); }

  // cargobay_histogram_record().
  Expected<void> record(std::chrono::nanoseconds time) noexcept {
    return detail::outcome(cargobay_histogram_record(handle(), time.count()));
  }

  // cargobay_histogram_get().
  Expected<Distribution> distribution() const noexcept {
    return detail::fetched(cargobay_histogram_get, handle());
  }

  // cargobay_histogram_get_percentile().
  Expected<std::chrono::nanoseconds> percentile(double percent) const noexcept {
    std::int64_t time_ns = 0;
    const int code = cargobay_histogram_get_percentile(handle(), percent, &time_ns);
    if (code < 0) return detail::failure(code);
    return std::chrono::nanoseconds{time_ns};
  }

  // For the C API; nullptr if closed or moved from.
  cargobay_histogram* handle() const noexcept { return handle_.get(); }

 private:
  explicit Histogram(cargobay_histogram* handle) noexcept : handle_{handle} {}

  detail::Handle<cargobay_histogram, cargobay_histogram_close> handle_;
};

// --- readers --------------------------------------------------------------------------------

// The states of a robot, one after the other, for one thread. The loop below ends when none comes.
//
//     auto states = robot.states(1s);
//     for (const State& state : states) print(state.x_mm);
//     return states.outcome();
//
// Each step is a wait() after the state before it, so a body that takes longer than a frame misses
// some: skipped() says how many, and Robot::history() has them. A second `for` goes on where the
// first one was left.
class States {
 public:
  States(cargobay_robot* robot, std::int64_t after_tick, std::chrono::nanoseconds timeout) noexcept
      : robot_{robot}, timeout_{timeout}, tick_{after_tick} {}

  detail::Step<States> begin() noexcept { return detail::Step{*this}; }
  std::default_sentinel_t end() const noexcept { return {}; }

  // What the steps do, and what they give.
  void take_next() noexcept {
    auto plain = detail::sized<cargobay_state>();
    const int code = cargobay_wait(robot_, tick_, timeout_.count(), &plain);
    newest_ = detail::waited(code, plain);
    if (!newest_) return;
    skipped_ = tick_ < 0 ? 0 : newest_->tick - tick_ - 1;
    tick_ = newest_->tick;
  }
  bool has_current() const noexcept { return static_cast<bool>(newest_); }
  const State& current() const noexcept { return *newest_; }

  // Ticks between the current state and the one before it; 0 at the first.
  std::int64_t skipped() const noexcept { return skipped_; }
  // Why no more states came: success if the loop was asked to end, else the error.
  Expected<void> outcome() const noexcept { return newest_.outcome(); }

 private:
  cargobay_robot* robot_;  // a handle: the library recognises one that was closed
  std::chrono::nanoseconds timeout_;
  std::int64_t tick_;
  std::int64_t skipped_ = 0;
  Waited<State> newest_{Expected<std::optional<State>>{std::nullopt}};
};

// The events of a robot, one after the other, for one thread. A `for` over them ends when there is
// none for now; the next one goes on after it.
//
//     auto events = robot.events();
//     for (const Event& event : events) print(describe(event));
class Events {
 public:
  Events(cargobay_robot* robot, std::int64_t after_sequence) noexcept
      : robot_{robot}, sequence_{after_sequence} {}

  detail::Step<Events> begin() noexcept { return detail::Step{*this}; }
  std::default_sentinel_t end() const noexcept { return {}; }

  // What the steps do, and what they give.
  void take_next() noexcept {
    auto plain = detail::sized<cargobay_event>();
    event_.reset();
    if (cargobay_next_event(robot_, sequence_, &plain) != 1) return;
    event_ = detail::typed(plain);
    skipped_ = event_->sequence - sequence_ - 1;
    sequence_ = event_->sequence;
  }
  bool has_current() const noexcept { return event_.has_value(); }
  const Event& current() const noexcept { return *event_; }

  // Events between the current one and the one before it, which the library no longer has.
  std::int64_t skipped() const noexcept { return skipped_; }

 private:
  cargobay_robot* robot_;  // a handle: the library recognises one that was closed
  std::int64_t sequence_;
  std::int64_t skipped_ = 0;
  std::optional<Event> event_{};
};

// --- robot ----------------------------------------------------------------------------------

// Like struct cargobay_options: 0 and "" are the default.
struct Options {
  Flags flags{};
  std::string port{};  // set `port`, `sim` or `port_fd`, or none
  Sim* sim = nullptr;  // outlives the robot
  std::string config{};
  std::string settings{};
  std::string record{};
  // Returns true to go on and false to give up: the other way round than in C, where 0 goes on.
  // Both texts end with a NUL. The robot keeps a copy. Must not throw.
  std::function<bool(std::string_view step, std::string_view detail)> progress{};
  std::uint32_t control_overruns = 0;
  std::int32_t port_fd = 0;
  std::uint32_t baud = 0;
  Mode mode = Mode::safe;
  Remainder remainder = Remainder::unknown;
  std::int32_t priority = 0;
  std::int32_t cpu = 0;
  std::chrono::nanoseconds setpoint_lapse{0};
  std::chrono::nanoseconds control_budget{0};
  std::chrono::nanoseconds link_timeout{0};
  std::chrono::nanoseconds guard_deadline{0};
  double acceleration_mm_s2 = 0.0;
  double jerk_mm_s3 = 0.0;
  double wheel_base_mm = 0.0;
  double distance_scale = 0.0;
  double turn_scale = 0.0;
};

// What a control function wants, or that it has finished: 0, 1 or a negative number in C.
class Output {
 public:
  // NOLINTBEGIN(google-explicit-constructor): so that a control function may return these
  Output(Wheels wheels) noexcept : wheels_{wheels} {}
  Output(Twist twist) noexcept : kind_{OutputKind::twist}, twist_{twist} {}
  // NOLINTEND(google-explicit-constructor)

  // CARGOBAY_OUTPUT_SETPOINT.
  static Output setpoint() noexcept { return Output{OutputKind::setpoint, 0}; }
  // The loop ends as asked.
  static Output finished() noexcept { return Output{OutputKind::wheels, 1}; }
  // The loop ends with CARGOBAY_E_CONTROL. `reason`, for EndReport::control_result, is below 0;
  // anything else becomes -1.
  static Output failed(int reason) noexcept {
    return Output{OutputKind::wheels, reason < 0 ? reason : -1};
  }

  // For the C API: what a cargobay_control returns after filling `output` with this.
  int fill(cargobay_output& output) const noexcept {
    output.kind = static_cast<std::int32_t>(kind_);
    output.wheels = detail::plain_of(wheels_);
    output.twist = detail::plain_of(twist_);
    return result_;
  }

 private:
  Output(OutputKind kind, int result) noexcept : kind_{kind}, result_{result} {}

  OutputKind kind_ = OutputKind::wheels;
  int result_ = 0;
  Wheels wheels_{};
  Twist twist_{};
};

// What a loop may call once a frame: it returns an Output, or Wheels, or a Twist.
template <typename F>
concept ControlFunction =
    std::move_constructible<F> && std::is_invocable_r_v<Output, F&, const State&>;

// struct cargobay_robot. May be moved while its loop runs. One thread must not destroy it, move it
// or assign to it while another uses it, nor may its own control function destroy it.
class Robot {
 public:
  static Expected<Robot> open(const Options& options = {}) noexcept {
    // NULL would mean another robot.
    if (options.sim != nullptr && options.sim->handle() == nullptr) {
      return Unexpected{
          Error{.code = ErrorCode::handle, .message = "the virtual Create `sim` is closed"}};
    }
    Robot robot;
    if (options.progress) robot.progress_ = std::make_unique<Progress>(options.progress);
    const cargobay_options plain = as_plain(options, robot.progress_.get());
    cargobay_robot* handle = nullptr;
    if (const int code = cargobay_open(&plain, &handle); code < 0) return detail::failure(code);
    robot.handle_.reset(handle);
    return robot;
  }

  Robot(Robot&&) noexcept = default;
  Robot& operator=(Robot&& other) noexcept {
    if (this == &other) return *this;
    (void)close();  // before the function that its loop calls; no one to tell
    control_ = std::move(other.control_);
    progress_ = std::move(other.progress_);
    handle_ = std::move(other.handle_);
    return *this;
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  ~Robot() {
    (void)close();  // a destructor has no one to tell
  }

  // The destructor does it too, and blocks as long. After CARGOBAY_E_STALLED the robot is closed,
  // and the control function, which has not returned, is never freed.
  Expected<void> close() noexcept {
    const int code = cargobay_close(handle());
    const bool stalled = code == CARGOBAY_E_STALLED;
    if (code == CARGOBAY_OK || stalled) (void)handle_.release();
    if (stalled) (void)control_.release();
    return detail::outcome(code);
  }

  // cargobay_get_bring_up().
  Expected<BringUp> bring_up() const noexcept {
    return detail::fetched(cargobay_get_bring_up, handle());
  }
  // cargobay_get_info().
  Expected<Info> info() const noexcept { return detail::fetched(cargobay_get_info, handle()); }
  // cargobay_get_learnt().
  Expected<Learnt> learnt() const noexcept {
    return detail::fetched(cargobay_get_learnt, handle());
  }
  // cargobay_get_state().
  Expected<State> state() const noexcept { return detail::fetched(cargobay_get_state, handle()); }

  // `after_tick`: -1, as in a State{}, is any; `timeout`: 0 does not wait, a negative one waits for
  // ever.
  Waited<State> wait(std::int64_t after_tick, std::chrono::nanoseconds timeout) noexcept {
    auto plain = detail::sized<cargobay_state>();
    const int code = cargobay_wait(handle(), after_tick, timeout.count(), &plain);
    return detail::waited(code, plain);
  }
  // The same, for a loop over the states.
  States states(std::chrono::nanoseconds timeout, std::int64_t after_tick = -1) noexcept {
    return {handle(), after_tick, timeout};
  }

  // cargobay_get_history(); returns how many it wrote. If `states` has room for more than 8, it is
  // read in pieces; a frame that arrives meanwhile is among them.
  Expected<std::size_t> history(std::int64_t after_tick, std::span<State> states) const noexcept {
    constexpr std::size_t kPiece = 8;
    std::size_t written = 0;
    for (;;) {
      cargobay_state piece[kPiece] = {};
      const std::size_t room = std::min(states.size() - written, kPiece);
      piece[0] = detail::sized<cargobay_state>();
      const int count = cargobay_get_history(handle(), after_tick, piece, room);
      if (count < 0) return detail::failure(count);
      for (int i = 0; i < count; ++i) states[written++] = detail::typed(piece[i]);
      if (static_cast<std::size_t>(count) < room || written == states.size()) return written;
      after_tick = states[written - 1].tick;
    }
  }

  // cargobay_get_fd().
  Expected<int> fd() const noexcept {
    const int descriptor = cargobay_get_fd(handle());
    if (descriptor < 0) return detail::failure(descriptor);
    return descriptor;
  }

  Expected<void> reset_odometry(double x_mm, double y_mm, double heading_rad) noexcept {
    return detail::outcome(cargobay_reset_odometry(handle(), x_mm, y_mm, heading_rad));
  }

  // The function is moved to memory of its own, which stays in place when the robot is moved;
  // CARGOBAY_E_MEMORY if there is none. Calling it allocates nothing; it gets a copy of C's state.
  // It may throw: CARGOBAY_E_CONTROL. The one before it is freed here if it will not be called any
  // more, and after CARGOBAY_E_STALLED, which means that it has not returned, never.
  template <typename F>
    requires ControlFunction<std::decay_t<F>>
  Expected<void> set_control(F&& function) noexcept {
    using Function = std::decay_t<F>;
    auto* const kept = new (std::nothrow) Function(std::forward<F>(function));
    if (kept == nullptr) {
      return Unexpected{
          Error{.code = ErrorCode::memory, .message = "no memory for the control function"}};
    }
    Kept holder{static_cast<void*>(kept), [](void* it) { delete static_cast<Function*>(it); }};
    const int code = cargobay_set_control(
        handle(),
        [](void* context, const cargobay_state* state, cargobay_output* output) {
          const State known = detail::known(*state);
          const Output wanted = std::invoke(*static_cast<Function*>(context), known);
          return wanted.fill(*output);
        },
        static_cast<void*>(kept));
    return replace_control(code, std::move(holder));
  }

  // Setpoints again.
  Expected<void> set_control(std::nullptr_t) noexcept {
    const int code = cargobay_set_control(handle(), nullptr, nullptr);
    return replace_control(code, no_control());
  }

  Expected<void> start() noexcept { return detail::outcome(cargobay_start(handle())); }
  Expected<void> end() noexcept { return detail::outcome(cargobay_end(handle())); }
  // May be called in a signal handler, too.
  Expected<void> request_end() noexcept {
    if (const int code = cargobay_request_end(handle()); code < 0) {
      return Unexpected{Error{.code = ErrorCode{code}, .message = "this robot is closed"}};
    }
    return {};
  }
  // cargobay_get_end().
  Expected<EndReport> end_report() const noexcept {
    return detail::fetched(cargobay_get_end, handle());
  }
  Expected<void> save_recording(const std::string& path) noexcept {
    return detail::outcome(cargobay_save_recording(handle(), path.c_str()));
  }

  Expected<void> drive_wheels(Wheels speed) noexcept {
    return detail::outcome(cargobay_drive_wheels(handle(), speed.left_mm_s, speed.right_mm_s));
  }
  Expected<void> drive(double velocity_mm_s, double turn_rate_rad_s) noexcept {
    return detail::outcome(cargobay_drive(handle(), velocity_mm_s, turn_rate_rad_s));
  }
  Expected<void> drive(Twist twist) noexcept {
    return drive(twist.velocity_mm_s, twist.turn_rate_rad_s);
  }
  Expected<void> drive_radius(double velocity_mm_s, double radius_mm) noexcept {
    return detail::outcome(cargobay_drive_radius(handle(), velocity_mm_s, radius_mm));
  }
  Expected<void> stop() noexcept { return detail::outcome(cargobay_stop(handle())); }
  Expected<Wheels> wheels_of(Twist twist) const noexcept {
    cargobay_wheels plain{};
    const int code = cargobay_wheels_of(handle(), detail::plain_of(twist), &plain);
    if (code < 0) return detail::failure(code);
    return detail::typed(plain);
  }
  Expected<void> rearm() noexcept { return detail::outcome(cargobay_rearm(handle())); }
  Expected<void> expect_silence(std::chrono::nanoseconds duration) noexcept {
    return detail::outcome(cargobay_expect_silence(handle(), duration.count()));
  }

  // std::nullopt if there is none, and if the robot is closed.
  std::optional<Event> next_event(std::int64_t after_sequence) const noexcept {
    auto plain = detail::sized<cargobay_event>();
    if (cargobay_next_event(handle(), after_sequence, &plain) != 1) return std::nullopt;
    return detail::typed(plain);
  }
  // The same, for a loop over the events.
  Events events(std::int64_t after_sequence = 0) const noexcept {
    return {handle(), after_sequence};
  }

  // cargobay_get_readings(); both spans have the same length, else CARGOBAY_E_ARGUMENT.
  Expected<void> readings(std::span<const Packet> packets,
                          std::span<Reading> values) const noexcept {
    if (packets.size() != values.size()) {
      return Unexpected{
          Error{.code = ErrorCode::argument, .message = "each packet needs room for its reading"}};
    }
    const detail::PacketNumbers numbers{packets};
    cargobay_reading plain[detail::PacketNumbers::kMost + 1];
    const int code = cargobay_get_readings(handle(), numbers.data(), numbers.size(), plain);
    if (code < 0) return detail::failure(code);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = detail::typed(plain[i]);
    return {};
  }
  // The same: `const auto [wall, voltage] = *robot.readings(Packet::wall, Packet::voltage);`
  template <std::same_as<Packet>... Packets>
    requires(sizeof...(Packets) > 0)
  Expected<std::array<Reading, sizeof...(Packets)>> readings(Packets... packets) const noexcept {
    std::array<Reading, sizeof...(Packets)> values;
    const auto read = readings(std::array{packets...}, values);
    if (!read) return Unexpected{read.error()};
    return values;
  }
  Expected<Reading> reading(Packet packet) const noexcept {
    const auto one = readings(packet);
    if (!one) return Unexpected{one.error()};
    return one->front();
  }

  Expected<void> subscribe(std::span<const Packet> packets) noexcept {
    const detail::PacketNumbers numbers{packets};
    return detail::outcome(cargobay_subscribe(handle(), numbers.data(), numbers.size()));
  }
  template <std::same_as<Packet>... Packets>
    requires(sizeof...(Packets) > 0)
  Expected<void> subscribe(Packets... packets) noexcept {
    return subscribe(std::array{packets...});
  }
  Expected<void> unsubscribe(std::span<const Packet> packets) noexcept {
    const detail::PacketNumbers numbers{packets};
    return detail::outcome(cargobay_unsubscribe(handle(), numbers.data(), numbers.size()));
  }
  template <std::same_as<Packet>... Packets>
    requires(sizeof...(Packets) > 0)
  Expected<void> unsubscribe(Packets... packets) noexcept {
    return unsubscribe(std::array{packets...});
  }

  Waited<Reading> query(Packet packet, std::chrono::nanoseconds timeout) noexcept {
    cargobay_reading plain{};
    const auto number = static_cast<std::uint32_t>(packet);
    const int code = cargobay_query(handle(), number, timeout.count(), &plain);
    return detail::waited(code, plain);
  }

  Expected<void> set_leds(Leds leds, std::uint32_t power_color,
                          std::uint32_t power_intensity) noexcept {
    return detail::outcome(cargobay_set_leds(handle(), leds.bits(), power_color, power_intensity));
  }
  Expected<void> set_digital_outputs(std::uint32_t outputs) noexcept {
    return detail::outcome(cargobay_set_digital_outputs(handle(), outputs));
  }
  Expected<void> set_low_side_drivers(std::uint32_t drivers) noexcept {
    return detail::outcome(cargobay_set_low_side_drivers(handle(), drivers));
  }
  Expected<void> set_pwm_low_side_drivers(std::uint32_t driver_0, std::uint32_t driver_1,
                                          std::uint32_t driver_2) noexcept {
    return detail::outcome(
        cargobay_set_pwm_low_side_drivers(handle(), driver_0, driver_1, driver_2));
  }
  Expected<void> send_ir(std::uint32_t byte) noexcept {
    return detail::outcome(cargobay_send_ir(handle(), byte));
  }

  Expected<void> store_song(std::uint32_t slot, std::span<const Note> notes) noexcept {
    constexpr std::size_t kMost = 16;
    cargobay_note plain[kMost + 1] = {};  // too many become one more than C allows
    const std::size_t count = std::min(notes.size(), std::size(plain));
    for (std::size_t i = 0; i < count; ++i) {
      plain[i] = {notes[i].duration.count(), notes[i].number, 0};
    }
    return detail::outcome(cargobay_store_song(handle(), slot, plain, count));
  }
  Expected<void> play_song(std::uint32_t slot) noexcept {
    return detail::outcome(cargobay_play_song(handle(), slot));
  }
  // The duration of the song in each slot used, the first being `slot`. Allocates.
  Expected<std::vector<std::chrono::nanoseconds>> store_tune(std::uint32_t slot,
                                                             const std::string& rtttl) noexcept {
    std::array<std::int64_t, 16> durations_ns{};
    const int used_slots = cargobay_store_tune(handle(), slot, rtttl.c_str(), durations_ns.data(),
                                               durations_ns.size());
    if (used_slots < 0) return detail::failure(used_slots);
    const auto used = std::span{durations_ns}.first(static_cast<std::size_t>(used_slots));
    return std::vector<std::chrono::nanoseconds>(used.begin(), used.end());
  }

  Expected<void> store_script(const std::string& text, Bits<How> how = {}) noexcept {
    return detail::outcome(cargobay_store_script(handle(), text.c_str(), how.bits()));
  }
  Expected<void> play_script(std::chrono::nanoseconds expected) noexcept {
    return detail::outcome(cargobay_play_script(handle(), expected.count()));
  }
  Expected<void> send_command(const std::string& text, Bits<How> how = {}) noexcept {
    return detail::outcome(cargobay_send_command(handle(), text.c_str(), how.bits()));
  }
  Expected<void> send_bytes(std::span<const std::uint8_t> bytes, Bits<How> how = {}) noexcept {
    return detail::outcome(cargobay_send_bytes(handle(), bytes.data(), bytes.size(), how.bits()));
  }

  // cargobay_get_statistics().
  Expected<Statistics> statistics() const noexcept {
    return detail::fetched(cargobay_get_statistics, handle());
  }
  // cargobay_get_missing_rights().
  Expected<std::string> missing_rights() const noexcept {
    std::string buffer(detail::kMostText, '\0');
    const int length = cargobay_get_missing_rights(handle(), buffer.data(), buffer.size());
    return detail::text(length, std::move(buffer));
  }
  Expected<void> copy_histogram(Measure measure, Histogram& histogram) const noexcept {
    const int number = static_cast<int>(measure);
    return detail::outcome(cargobay_copy_histogram(handle(), number, histogram.handle()));
  }

  // For the C API; nullptr if closed or moved from.
  cargobay_robot* handle() const noexcept { return handle_.get(); }

 private:
  using Kept = std::unique_ptr<void, void (*)(void*)>;
  using Progress = decltype(Options::progress);

  Robot() noexcept = default;

  static Kept no_control() noexcept {
    return {nullptr, [](void*) {}};
  }

  // After cargobay_set_control() returned `code`.
  Expected<void> replace_control(int code, Kept next) noexcept {
    if (code == CARGOBAY_E_STALLED) (void)control_.release();  // a thread is still in it
    if (code == CARGOBAY_OK || code == CARGOBAY_E_STALLED) control_ = std::move(next);
    return detail::outcome(code);
  }

  // Borrows from `options`, and `progress` for the life of the robot.
  static cargobay_options as_plain(const Options& options, Progress* progress) noexcept {
    auto plain = detail::sized<cargobay_options>();
    plain.flags = options.flags.bits();
    plain.port = detail::or_null(options.port);
    plain.sim = options.sim == nullptr ? nullptr : options.sim->handle();
    plain.config = detail::or_null(options.config);
    plain.settings = detail::or_null(options.settings);
    plain.record = detail::or_null(options.record);
    plain.control_overruns = options.control_overruns;
    plain.port_fd = options.port_fd;
    plain.baud = options.baud;
    plain.mode = static_cast<std::int32_t>(options.mode);
    plain.remainder = static_cast<std::int32_t>(options.remainder);
    plain.priority = options.priority;
    plain.cpu = options.cpu;
    plain.setpoint_lapse_ns = options.setpoint_lapse.count();
    plain.control_budget_ns = options.control_budget.count();
    plain.link_timeout_ns = options.link_timeout.count();
    plain.guard_deadline_ns = options.guard_deadline.count();
    plain.acceleration_mm_s2 = options.acceleration_mm_s2;
    plain.jerk_mm_s3 = options.jerk_mm_s3;
    plain.wheel_base_mm = options.wheel_base_mm;
    plain.distance_scale = options.distance_scale;
    plain.turn_scale = options.turn_scale;
    if (progress == nullptr) return plain;
    plain.progress = [](void* context, const char* step, const char* detail) noexcept {
      return (*static_cast<Progress*>(context))(step, detail) ? 0 : 1;
    };
    plain.progress_context = progress;
    return plain;
  }

  Kept control_ = no_control();
  std::unique_ptr<Progress> progress_{};
  // Declared after the functions, so closed before they are freed: the loop calls them until then.
  detail::Handle<cargobay_robot, cargobay_close> handle_{};
};

}  // namespace v0_1
}  // namespace cargobay

#endif
