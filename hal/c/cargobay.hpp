// The C++ API of Cargobay: cargobay.h with handles that close themselves, times as std::chrono, and
// errors as values. Header only: you link the C API.
//
//     auto robot = cargobay::Robot::open({.port = "/dev/ttyUSB0"});
//     if (!robot) return complain(robot.error().message);
//     robot->control([](const cargobay::State& state) -> cargobay::Wheels { ... });
//     robot->start();
//
// Every function does what the C function of the same name does, or the one named beside it.
// cargobay.h says what each function means, which errors it returns, which threads may call it, and
// whether it blocks; only the differences are documented here. Constants and plain structs are
// those of the C API; `size` is set wherever one is made or returned here.
//
// Nothing here throws. What is real-time safe in C is real-time safe here, errors included. If
// memory for a std::string or a std::vector runs out, the program ends.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
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

namespace cargobay {

using BringUp = ::cargobay_bring_up;
using Distribution = ::cargobay_distribution;
using Event = ::cargobay_event;
using Note = ::cargobay_note;
using Sensors = ::cargobay_sensors;
using State = ::cargobay_state;
using Statistics = ::cargobay_statistics;
using Truth = ::cargobay_truth;
using Wheels = ::cargobay_wheels;

// What failed. The text is a copy, so it lasts; it is not a std::string because some of the
// functions that fail must not allocate.
struct Error {
  int code = CARGOBAY_OK;   // enum cargobay_error
  char message[1024] = {};  // one line, with the remedy

  // Of the failed call just made on this thread.
  static Error last(int code) noexcept {
    Error error{.code = code};
    const char* const text = cargobay_error_message();
    std::memcpy(error.message, text, std::min(std::strlen(text), sizeof error.message - 1));
    return error;
  }
};

// A value, or the error that explains why there is none.
template <typename T>
class [[nodiscard]] Expected {
 public:
  // Implicit, for `return value;` and `return other.error();`.
  // NOLINTBEGIN(google-explicit-constructor): implicit on purpose, as said above
  Expected(T value) noexcept : content_{std::in_place_index<0>, std::move(value)} {}
  Expected(const Error& error) noexcept : content_{std::in_place_index<1>, error} {}
  // NOLINTEND(google-explicit-constructor)

  explicit operator bool() const noexcept { return content_.index() == 0; }
  // Only if there is a value.
  T& operator*() & noexcept { return *value(); }
  const T& operator*() const& noexcept { return *value(); }
  T&& operator*() && noexcept { return std::move(*value()); }
  T* operator->() noexcept { return value(); }
  const T* operator->() const noexcept { return value(); }
  // Only if there is no value.
  const Error& error() const noexcept {
    assert(!*this);
    return *std::get_if<1>(&content_);
  }
  // enum cargobay_error; CARGOBAY_OK if there is a value.
  int code() const noexcept { return *this ? CARGOBAY_OK : error().code; }

 private:
  T* value() noexcept {
    assert(*this);
    return std::get_if<0>(&content_);
  }
  const T* value() const noexcept {
    assert(*this);
    return std::get_if<0>(&content_);
  }

  std::variant<T, Error> content_;
};

// Success, or the error.
template <>
class [[nodiscard]] Expected<void> {
 public:
  Expected() noexcept = default;
  // NOLINTNEXTLINE(google-explicit-constructor): implicit, for `return other.error();`
  Expected(const Error& error) noexcept : error_{error} {}

  explicit operator bool() const noexcept { return !error_; }
  const Error& error() const noexcept {
    assert(error_);
    return *error_;
  }
  int code() const noexcept { return error_ ? error_->code : CARGOBAY_OK; }

 private:
  std::optional<Error> error_{};
};

namespace detail {

template <typename T>
T sized() noexcept {
  T value{};
  value.size = sizeof value;
  return value;
}

inline Expected<void> outcome(int code) noexcept {
  if (code < 0) return Error::last(code);
  return {};
}

// Takes `value` by reference: the call that returns the code is what fills it.
template <typename T>
Expected<T> outcome(int code, const T& value) noexcept {
  if (code < 0) return Error::last(code);
  return value;
}

// The text that a C function wrote: the function returns the full length, and truncates what does
// not fit.
inline Expected<std::string> text(int length, std::string buffer) noexcept {
  if (length < 0) return Error::last(length);
  buffer.resize(std::min(static_cast<std::size_t>(length), buffer.size() - 1));
  return buffer;
}

inline constexpr std::size_t kMostText = 8192;  // longer than any answer

inline const char* or_null(const std::string& text) noexcept {
  return text.empty() ? nullptr : text.c_str();
}

// A time that does not fit becomes a value beyond every range: CARGOBAY_E_ARGUMENT.
template <typename Rep, typename Period>
std::uint32_t count(std::chrono::duration<Rep, Period> time) noexcept {
  constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
  return time.count() < 0 || time.count() > most ? most : static_cast<std::uint32_t>(time.count());
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
  if (code < 0) return Error::last(code);
  (void)handle.release();  // just closed
  return {};
}

}  // namespace detail

// Of the library in use.
inline std::string_view version() noexcept { return cargobay_version(); }
inline std::string_view error_name(int code) noexcept { return cargobay_error_name(code); }

inline Wheels wheels_of(double velocity_mm_s, double turn_rate_rad_s,
                        double wheel_base_mm = 258.0) noexcept {
  return cargobay_wheels_of(velocity_mm_s, turn_rate_rad_s, wheel_base_mm);
}

// cargobay_describe_event().
inline std::string describe(const Event& event) noexcept {
  std::string buffer(detail::kMostText, '\0');
  const int length = cargobay_describe_event(&event, buffer.data(), buffer.size());
  auto words = detail::text(length, std::move(buffer));
  return words ? *std::move(words) : std::string{};
}

// Like struct cargobay_sim_options: 0 and "" are the default.
struct VirtualCreateOptions {
  int time = CARGOBAY_SIM_REAL;
  std::uint64_t seed = 0;
  int remainder = CARGOBAY_REMAINDER_UNKNOWN;
  std::uint32_t boot_baud = 0;
  std::string link{};
  std::string world{};
  std::chrono::duration<double> lag{0};
  double droop_left = 0.0;
  double droop_right = 0.0;
  double noise_mm_s = 0.0;
  double wheel_base_mm = 0.0;
};

// struct cargobay_sim. Declare it before the robot that uses it, so that it is destroyed after it.
class VirtualCreate {
 public:
  // cargobay_sim_open().
  static Expected<VirtualCreate> open(const VirtualCreateOptions& options = {}) noexcept {
    auto plain = detail::sized<cargobay_sim_options>();
    plain.time = options.time;
    plain.seed = options.seed;
    plain.remainder = options.remainder;
    plain.boot_baud = options.boot_baud;
    plain.link = detail::or_null(options.link);
    plain.world = detail::or_null(options.world);
    plain.lag_s = options.lag.count();
    plain.droop_left = options.droop_left;
    plain.droop_right = options.droop_right;
    plain.noise_mm_s = options.noise_mm_s;
    plain.wheel_base_mm = options.wheel_base_mm;
    cargobay_sim* handle = nullptr;
    const int code = cargobay_sim_open(&plain, &handle);
    if (code < 0) return Error::last(code);
    return VirtualCreate{handle};
  }

  // cargobay_sim_close(). The destructor does it too.
  Expected<void> close() noexcept { return detail::close(handle_); }

  // cargobay_sim_path().
  Expected<std::string> path() const noexcept {
    std::string buffer(detail::kMostText, '\0');
    const int length = cargobay_sim_path(handle(), buffer.data(), buffer.size());
    return detail::text(length, std::move(buffer));
  }

  // cargobay_sim_inject(); the answer.
  Expected<std::string> inject(const std::string& line) noexcept {
    std::string buffer(detail::kMostText, '\0');
    const int length = cargobay_sim_inject(handle(), line.c_str(), buffer.data(), buffer.size());
    return detail::text(length, std::move(buffer));
  }

  // cargobay_sim_truth().
  Expected<Truth> truth() const noexcept {
    auto value = detail::sized<Truth>();
    return detail::outcome(cargobay_sim_truth(handle(), &value), value);
  }

  // cargobay_sim_advance().
  Expected<void> advance(std::chrono::nanoseconds duration) noexcept {
    return detail::outcome(cargobay_sim_advance(handle(), duration.count()));
  }

  // For the C API; nullptr if closed or moved from.
  cargobay_sim* handle() const noexcept { return handle_.get(); }

 private:
  explicit VirtualCreate(cargobay_sim* handle) noexcept : handle_{handle} {}

  detail::Handle<cargobay_sim, cargobay_sim_close> handle_;
};

// Like struct cargobay_options: 0 and "" are the default.
struct Options {
  std::uint32_t flags = 0;       // bits of enum cargobay_flag
  std::string port{};            // set `port` or `sim`, or neither
  VirtualCreate* sim = nullptr;  // outlives the robot
  std::string config{};
  std::uint32_t baud = 0;
  int mode = 0;
  int remainder = CARGOBAY_REMAINDER_UNKNOWN;
  int priority = 0;
  int cpu = 0;
  std::chrono::milliseconds setpoint_lapse{0};
  std::chrono::microseconds control_budget{0};
  std::uint32_t control_overruns = 0;
  std::chrono::milliseconds link_timeout{0};
  std::chrono::milliseconds guard_deadline{0};
  double acceleration_mm_s2 = 0.0;
  double jerk_mm_s3 = 0.0;
  double wheel_base_mm = 0.0;
  double distance_scale = 0.0;
  double turn_scale = 0.0;
  std::string record{};
  // Must not throw.
  std::function<void(std::string_view step, std::string_view detail)> progress{};
};

// struct cargobay_histogram.
class Histogram {
 public:
  // cargobay_histogram_open().
  static Expected<Histogram> open() noexcept {
    cargobay_histogram* handle = nullptr;
    const int code = cargobay_histogram_open(&handle);
    if (code < 0) return Error::last(code);
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
    auto value = detail::sized<Distribution>();
    return detail::outcome(cargobay_histogram_get(handle(), &value), value);
  }

  // cargobay_histogram_percentile().
  Expected<std::chrono::nanoseconds> percentile(double percent) const noexcept {
    std::int64_t time_ns = 0;
    const int code = cargobay_histogram_percentile(handle(), percent, &time_ns);
    return detail::outcome(code, std::chrono::nanoseconds{time_ns});
  }

  // For the C API; nullptr if closed or moved from.
  cargobay_histogram* handle() const noexcept { return handle_.get(); }

 private:
  explicit Histogram(cargobay_histogram* handle) noexcept : handle_{handle} {}

  detail::Handle<cargobay_histogram, cargobay_histogram_close> handle_;
};

// What a loop may call once a frame.
template <typename F>
concept ControlFunction =
    std::move_constructible<F> && std::is_invocable_r_v<Wheels, F&, const State&>;

// struct cargobay_robot. May be moved while its loop runs. One thread must not destroy it, move it
// or assign to it while another uses it, nor may its own control function destroy it.
class Robot {
 public:
  static Expected<Robot> open(const Options& options = {}) noexcept {
    const cargobay_options plain = as_plain(options);
    cargobay_robot* handle = nullptr;
    const int code = cargobay_open(&plain, &handle);
    if (code < 0) return Error::last(code);
    return Robot{handle};
  }

  Robot(Robot&&) noexcept = default;
  Robot& operator=(Robot&& other) noexcept {
    if (this == &other) return *this;
    if (handle_) (void)close();  // before the function that its loop calls; no one to tell
    control_ = std::move(other.control_);
    handle_ = std::move(other.handle_);
    return *this;
  }
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;
  ~Robot() {
    if (handle_) (void)close();  // a destructor has no one to tell
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
    auto value = detail::sized<BringUp>();
    return detail::outcome(cargobay_get_bring_up(handle(), &value), value);
  }

  // cargobay_get_state().
  Expected<State> state() const noexcept {
    auto value = detail::sized<State>();
    return detail::outcome(cargobay_get_state(handle(), &value), value);
  }

  // Returns the newest state. 0: does not wait; negative: waits for ever.
  Expected<State> wait(std::chrono::nanoseconds timeout) noexcept {
    auto value = detail::sized<State>();
    return detail::outcome(cargobay_wait(handle(), timeout.count(), &value), value);
  }

  Expected<void> reset_odometry(double x_mm, double y_mm, double heading_rad) noexcept {
    return detail::outcome(cargobay_reset_odometry(handle(), x_mm, y_mm, heading_rad));
  }

  // cargobay_set_control() with anything that can be called as Wheels(const State&). It is moved to
  // memory of its own, which stays in place when the robot is moved; CARGOBAY_E_SYSTEM if there is
  // no memory. Calling it allocates nothing. It may throw: CARGOBAY_E_CONTROL.
  template <typename F>
    requires ControlFunction<std::decay_t<F>>
  Expected<void> control(F&& function) noexcept {
    using Function = std::decay_t<F>;
    auto* const kept = new (std::nothrow) Function(std::forward<F>(function));
    if (kept == nullptr) {
      return Error{.code = CARGOBAY_E_SYSTEM, .message = "no memory for the control function"};
    }
    Kept holder{static_cast<void*>(kept), [](void* it) { delete static_cast<Function*>(it); }};
    const int code = cargobay_set_control(
        handle(),
        [](void* context, const State* state, Wheels* wheels) {
          *wheels = (*static_cast<Function*>(context))(*state);
        },
        static_cast<void*>(kept));
    if (code < 0) return Error::last(code);
    control_ = std::move(holder);
    return {};
  }

  // cargobay_set_control() with none: setpoints again.
  Expected<void> control(std::nullptr_t) noexcept {
    const int code = cargobay_set_control(handle(), nullptr, nullptr);
    if (code < 0) return Error::last(code);
    control_.reset();
    return {};
  }

  Expected<void> start() noexcept { return detail::outcome(cargobay_start(handle())); }
  Expected<void> stop() noexcept { return detail::outcome(cargobay_stop(handle())); }
  Expected<void> request_stop() noexcept {
    return detail::outcome(cargobay_request_stop(handle()));
  }

  Expected<void> drive_wheels(Wheels speed) noexcept {
    return detail::outcome(cargobay_drive_wheels(handle(), speed.left_mm_s, speed.right_mm_s));
  }
  Expected<void> drive(double velocity_mm_s, double turn_rate_rad_s) noexcept {
    return detail::outcome(cargobay_drive(handle(), velocity_mm_s, turn_rate_rad_s));
  }
  Expected<void> drive_radius(double velocity_mm_s, double radius_mm) noexcept {
    return detail::outcome(cargobay_drive_radius(handle(), velocity_mm_s, radius_mm));
  }

  Expected<void> rearm() noexcept { return detail::outcome(cargobay_rearm(handle())); }
  Expected<void> expect_silence(std::chrono::nanoseconds duration) noexcept {
    return detail::outcome(cargobay_expect_silence(handle(), duration.count()));
  }

  // The oldest event that nobody took yet; std::nullopt also if the robot is closed.
  std::optional<Event> next_event() noexcept {
    auto value = detail::sized<Event>();
    if (cargobay_next_event(handle(), &value) != 1) return std::nullopt;
    return value;
  }

  // cargobay_get_sensors().
  Expected<Sensors> sensors() const noexcept {
    auto value = detail::sized<Sensors>();
    return detail::outcome(cargobay_get_sensors(handle(), &value), value);
  }

  // Bits of enum cargobay_extra.
  Expected<void> subscribe(std::uint32_t extras) noexcept {
    return detail::outcome(cargobay_subscribe(handle(), extras));
  }

  // One value of enum cargobay_packet.
  Expected<std::int32_t> query(int packet, std::chrono::nanoseconds timeout) noexcept {
    std::int32_t value = 0;
    return detail::outcome(cargobay_query(handle(), packet, timeout.count(), &value), value);
  }

  Expected<void> leds(std::uint32_t leds, std::uint8_t power_color,
                      std::uint8_t power_intensity) noexcept {
    return detail::outcome(cargobay_leds(handle(), leds, power_color, power_intensity));
  }
  Expected<void> digital_outputs(std::uint32_t outputs) noexcept {
    return detail::outcome(cargobay_digital_outputs(handle(), outputs));
  }
  Expected<void> low_side_drivers(std::uint32_t drivers) noexcept {
    return detail::outcome(cargobay_low_side_drivers(handle(), drivers));
  }
  Expected<void> pwm_low_side_drivers(std::uint8_t driver_0, std::uint8_t driver_1,
                                      std::uint8_t driver_2) noexcept {
    return detail::outcome(cargobay_pwm_low_side_drivers(handle(), driver_0, driver_1, driver_2));
  }
  Expected<void> send_ir(std::uint8_t byte) noexcept {
    return detail::outcome(cargobay_send_ir(handle(), byte));
  }

  Expected<void> song(std::uint8_t slot, std::span<const Note> notes) noexcept {
    return detail::outcome(cargobay_song(handle(), slot, notes.data(), notes.size()));
  }
  Expected<void> play_song(std::uint8_t slot) noexcept {
    return detail::outcome(cargobay_play_song(handle(), slot));
  }
  // The duration of the song in each slot used, the first being `slot`. Allocates.
  Expected<std::vector<std::chrono::nanoseconds>> tune(std::uint8_t slot,
                                                       const std::string& rtttl) noexcept {
    std::array<std::int32_t, 16> durations_64{};
    const int slots = cargobay_tune(handle(), slot, rtttl.c_str(), durations_64.data());
    if (slots < 0) return Error::last(slots);
    std::vector<std::chrono::nanoseconds> durations;
    for (const std::int32_t each : std::span{durations_64}.first(static_cast<std::size_t>(slots))) {
      durations.emplace_back(std::chrono::duration<std::int64_t, std::ratio<1, 64>>{each});
    }
    return durations;
  }

  // `how`: bits of enum cargobay_how.
  Expected<void> script(const std::string& text, std::uint32_t how = 0) noexcept {
    return detail::outcome(cargobay_script(handle(), text.c_str(), how));
  }
  Expected<void> play_script(std::chrono::nanoseconds expected) noexcept {
    return detail::outcome(cargobay_play_script(handle(), expected.count()));
  }
  Expected<void> command(const std::string& text, std::uint32_t how = 0) noexcept {
    return detail::outcome(cargobay_command(handle(), text.c_str(), how));
  }
  Expected<void> raw(std::span<const std::uint8_t> bytes, std::uint32_t how = 0) noexcept {
    return detail::outcome(cargobay_raw(handle(), bytes.data(), bytes.size(), how));
  }

  // cargobay_missing_rights().
  Expected<std::string> missing_rights() const noexcept {
    constexpr std::size_t kMostLines = 2048;
    std::string buffer(kMostLines, '\0');
    const int length = cargobay_missing_rights(handle(), buffer.data(), buffer.size());
    return detail::text(length, std::move(buffer));
  }
  // cargobay_get_statistics().
  Expected<Statistics> statistics() const noexcept {
    auto value = detail::sized<Statistics>();
    return detail::outcome(cargobay_get_statistics(handle(), &value), value);
  }

  // `measure`: enum cargobay_measure.
  Expected<void> copy_histogram(int measure, Histogram& histogram) const noexcept {
    return detail::outcome(cargobay_copy_histogram(handle(), measure, histogram.handle()));
  }

  // For the C API; nullptr if closed or moved from.
  cargobay_robot* handle() const noexcept { return handle_.get(); }

 private:
  using Kept = std::unique_ptr<void, void (*)(void*)>;

  explicit Robot(cargobay_robot* handle) noexcept : handle_{handle} {}

  // Borrows from `options`.
  static cargobay_options as_plain(const Options& options) noexcept {
    auto plain = detail::sized<cargobay_options>();
    plain.flags = options.flags;
    plain.port = detail::or_null(options.port);
    plain.sim = options.sim == nullptr ? nullptr : options.sim->handle();
    plain.config = detail::or_null(options.config);
    plain.baud = options.baud;
    plain.mode = options.mode;
    plain.remainder = options.remainder;
    plain.priority = options.priority;
    plain.cpu = options.cpu;
    plain.setpoint_lapse_ms = detail::count(options.setpoint_lapse);
    plain.control_budget_us = detail::count(options.control_budget);
    plain.control_overruns = options.control_overruns;
    plain.link_timeout_ms = detail::count(options.link_timeout);
    plain.guard_deadline_ms = detail::count(options.guard_deadline);
    plain.acceleration_mm_s2 = options.acceleration_mm_s2;
    plain.jerk_mm_s3 = options.jerk_mm_s3;
    plain.wheel_base_mm = options.wheel_base_mm;
    plain.distance_scale = options.distance_scale;
    plain.turn_scale = options.turn_scale;
    plain.record = detail::or_null(options.record);
    if (!options.progress) return plain;
    plain.progress = [](void* context, const char* step, const char* detail) noexcept {
      (*static_cast<const decltype(Options::progress)*>(context))(step, detail);
    };
    // Only read through, as above.
    plain.progress_context = const_cast<decltype(Options::progress)*>(&options.progress);
    return plain;
  }

  Kept control_{nullptr, [](void*) {}};
  // Declared after the function, so closed before it is freed: the loop calls it until then.
  detail::Handle<cargobay_robot, cargobay_close> handle_;
};

}  // namespace cargobay
