// What goes into the library from C++ and what comes back: options, commands, measurements.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "hal/c/cargobay.hpp"

namespace {

using cargobay::ErrorCode;
using cargobay::Flag;
using cargobay::Options;
using cargobay::State;
using namespace std::chrono_literals;

// Unlike enumerations do not mix, neither with each other nor with numbers.
template <typename A, typename B>
concept Mixes = requires(A a, B b) { a | b; } || requires(A a, B b) { a & b; } ||
                requires(A a, B b) { a == b; } || requires(A a, B b) { a.has(b); } ||
                std::is_convertible_v<B, A>;
static_assert(Mixes<cargobay::Flags, Flag> && Mixes<Flag, Flag>);
static_assert(!Mixes<cargobay::Flags, cargobay::Hazard> && !Mixes<Flag, cargobay::Hazard>);
static_assert(!Mixes<cargobay::Hazards, cargobay::Bump> && !Mixes<cargobay::Bumps, int>);
static_assert(!Mixes<cargobay::Bumps, cargobay::Buttons> && !Mixes<Flag, int>);
static_assert(!Mixes<cargobay::Mode, ErrorCode> && !Mixes<cargobay::Mode, int>);
static_assert(!Mixes<cargobay::Packet, cargobay::Hazard> && !Mixes<cargobay::Packet, int>);

void check(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "not so: %s\n  last error: %s\n", what, cargobay_error_message());
  std::exit(1);  // NOLINT(concurrency-mt-unsafe): as C tests do it
}

void check(const cargobay::Expected<void>& outcome, const char* what) {
  check(outcome.has_value(), what);
}

cargobay::Expected<cargobay::Sim> virtual_sim() {
  return cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
}

void run(cargobay::Robot& robot, int frames) {
  auto states = robot.states(5s, robot.state().value_or(State{}).tick);
  for (auto state = states.begin(); state != states.end() && --frames > 0;) ++state;
  check(states.outcome(), "the loop goes on");
}

// Each is refused by its own name, so each has reached the library.
void options_arrive() {
  auto sim = virtual_sim();
  const std::vector<std::pair<Options, std::string_view>> wrong{
      {{.flags = cargobay::Flags{1U << 31U}}, "`flags`"},
      {{.port = "/dev/null", .sim = &*sim}, "one of `port`"},
      {{.sim = &*sim, .config = "/no/such/file"}, "/no/such/file"},
      {{.sim = &*sim, .settings = "no = 1"}, "no"},
      {{.sim = &*sim, .record = "/no/such/file"}, "/no/such/file"},
      {{.sim = &*sim, .control_overruns = 1'000'001}, "`control_overruns`"},
      {{.port_fd = 2}, "`port_fd`"},
      {{.sim = &*sim, .baud = 12345}, "`baud`"},
      {{.sim = &*sim, .mode = cargobay::Mode::passive}, "`mode`"},
      {{.sim = &*sim, .remainder = cargobay::Remainder{7}}, "`remainder`"},
      {{.sim = &*sim, .priority = 99}, "`priority`"},
      {{.flags = Flag::pin_cpu, .sim = &*sim, .cpu = 1024}, "`cpu`"},
      {{.sim = &*sim, .setpoint_lapse = 1ms}, "`setpoint_lapse_ns`"},
      {{.sim = &*sim, .control_budget = 1us}, "`control_budget_ns`"},
      {{.sim = &*sim, .link_timeout = 1ms}, "`link_timeout_ns`"},
      {{.sim = &*sim, .guard_deadline = 1ms}, "`guard_deadline_ns`"},
      {{.sim = &*sim, .acceleration_mm_s2 = 0.5}, "`acceleration_mm_s2`"},
      {{.sim = &*sim, .jerk_mm_s3 = 0.5}, "`jerk_mm_s3`"},
      {{.sim = &*sim, .wheel_base_mm = 1.0}, "`wheel_base_mm`"},
      {{.sim = &*sim, .distance_scale = 3.0}, "`distance_scale`"},
      {{.sim = &*sim, .turn_scale = 3.0}, "`turn_scale`"},
  };
  for (const auto& [options, words] : wrong) {
    const auto robot = cargobay::Robot::open(options);
    check(!robot && std::string_view{robot.error().message}.find(words) != std::string_view::npos,
          std::string{words}.c_str());
  }
  const auto robot = cargobay::Robot::open(
      {.sim = &*sim, .settings = "[robot]\nwheel_base_mm = 300", .mode = cargobay::Mode::full});
  check(robot && robot->info()->wheel_base_mm == 300.0, "settings count");
  check(sim->truth()->mode == cargobay::Mode::full, "so does the mode");
}

void sim_options_arrive() {
  using cargobay::SimOptions;
  const std::vector<std::pair<SimOptions, std::string_view>> wrong{
      {{.time = cargobay::SimTime{2}}, "`time`"},
      {{.remainder = cargobay::Remainder{7}}, "`remainder`"},
      {{.boot_baud = 12345}, "`boot_baud`"},
      {{.time = cargobay::SimTime::virtual_time, .link = "/tmp/none"}, "pseudo-terminal"},
      {{.world = "/no/such/file"}, "/no/such/file"},
      {{.lag = 1us}, "`lag_ns`"},
      {{.gain_left = 2.0}, "`gain_left`"},
      {{.gain_right = 2.0}, "`gain_right`"},
      {{.noise_mm_s = 101.0}, "`noise_mm_s`"},
      {{.wheel_base_mm = 1.0}, "`wheel_base_mm`"},
      {{.plant = "sloth"}, "`plant`"},
  };
  for (const auto& [options, words] : wrong) {
    const auto sim = cargobay::Sim::open(options);
    check(!sim && std::string_view{sim.error().message}.find(words) != std::string_view::npos,
          std::string{words}.c_str());
  }
  const auto sim = virtual_sim();
  check(sim->path().error().code == ErrorCode::unsupported, "virtual time has no pseudo-terminal");
  auto other = virtual_sim();
  check(other->advance(3s) && other->truth()->sim_time == 3s, "time passes as told");
}

void reports_progress() {
  auto sim = virtual_sim();
  int steps = 0;
  const auto open = [&](int most) {
    return cargobay::Robot::open(
        {.sim = &*sim, .progress = [&steps, most](std::string_view step, std::string_view) {
           check(!step.empty(), "it says which step");
           return ++steps < most;
         }});
  };
  check(open(2).error().code == ErrorCode::cancelled && steps == 2, "false gives up");
  auto robot = open(1'000'000);
  const int before = steps;
  check(robot && robot->start() && robot->end() && before > 2, "true goes on");
  check(robot->start() && steps > before, "the robot has kept it for its second start");
  check(robot->bring_up()->baud == 57600 && robot->bring_up()->took > 0s, "it has been brought up");
}

void sends_commands() {
  auto sim = virtual_sim();
  auto robot = cargobay::Robot::open({.sim = &*sim});
  check(robot && robot->start(), "it starts");
  run(*robot, 10);
  const auto says = [&](const char* words) {
    run(*robot, 10);
    return sim->inject("state")->find(words) != std::string::npos;
  };
  check(robot->set_leds(cargobay::Led::play | cargobay::Led::advance, 10, 200), "LEDs");
  check(says(R"("power_color":10,"power_intensity":200)"), "are set");
  check(robot->set_digital_outputs(5) && robot->set_pwm_low_side_drivers(1, 2, 128), "outputs");
  check(says(R"("digital_out":5,"low_side_driver":[1,2,128])"), "are set");
  const std::vector<std::uint8_t> bytes{138, 2};
  check(robot->send_bytes(bytes) && says(R"("low_side_driver":[0,128,0])"), "bytes are sent");
  check(robot->set_low_side_drivers(0) && robot->send_ir(130) && says(R"("ir_sent":130)"), "IR");
  check(robot->send_command("leds none 0 64") && says(R"("power_intensity":64)"), "text is sent");

  const std::vector<cargobay::Note> notes{{.duration = 250ms, .number = 60}, {.duration = 2s}};
  check(robot->store_song(3, notes) && robot->play_song(3), "a song");
  run(*robot, 10);
  check(robot->query(cargobay::Packet::song_number, 1s)->value == 3, "is played");
  check(robot->query(cargobay::Packet::song_playing, 1s)->value == 1, "as it says");
  run(*robot, 70);
  check(robot->query(cargobay::Packet::song_playing, 1s)->value == 1, "for as long as it takes");
  run(*robot, 80);
  check(robot->query(cargobay::Packet::song_playing, 1s)->value == 0, "and no longer");
  const std::vector<cargobay::Note> too_many(100);
  check(robot->store_song(3, too_many).error().code == ErrorCode::argument, "16 notes at most");
  check(robot->store_song(3, {}).error().code == ErrorCode::argument, "one at least");
  const auto tune =
      robot->store_tune(4, "t:d=8,o=5,b=120:c,d,e,f,g,a,b,c6,d6,e6,f6,g6,a6,b6,c7,d7,e7");
  check(tune && *tune == std::vector<std::chrono::nanoseconds>{4s, 250ms}, "a tune in two songs");

  check(robot->store_script("drive 200 straight; wait_distance 200; drive 0 straight"), "a script");
  run(*robot, 20);
  check(robot->play_script(4s) && robot->expect_silence(5s), "is played");
  run(*robot, 200);
  check(sim->truth()->x_mm > 180.0, "and drives");
  check(robot->reset_odometry(1000.0, -500.0, 1.5), "the odometry");
  run(*robot, 1);
  check(std::abs(robot->state()->x_mm - 1000.0) < 1.0, "starts elsewhere");
}

void measures() {
  auto sim = virtual_sim();
  auto robot = cargobay::Robot::open({.sim = &*sim});
  check(robot && robot->start(), "it starts");
  check(robot->fd().error().code == ErrorCode::unsupported, "virtual time has no descriptor");
  run(*robot, 200);
  const auto info = robot->info();
  check(info->tick == 15ms && info->max_wheel_mm_s == 500.0 && info->song_notes == 16, "it knows");
  check(info->features.has(cargobay::Feature::leds) && std::string{info->model} == "iRobot Create",
        "what robot it is");
  const auto counted = robot->statistics();
  check(counted->frames_good >= 199 && counted->frames_bad == 0 && counted->ticks >= 199, "frames");
  check(robot->missing_rights()->empty(), "nothing was refused in virtual time");
  auto histogram = cargobay::Histogram::open();
  check(robot->copy_histogram(cargobay::Measure::period, *histogram), "its periods");
  const auto held = histogram->distribution();
  check(held && held->count >= 198 && std::chrono::abs(held->p50 - 15ms) < 200us, "are of 15 ms");
  check(std::chrono::abs(held->mean - 15ms) < 1ms && held->min <= held->p50 &&
            held->p999 <= held->max,
        "on the average");
  check(histogram->record(10min) && histogram->distribution()->max == 10min, "it takes more");
  check(*histogram->percentile(100.0) >= 595s, "of which this is the longest");
  check(histogram->close() && histogram->record(1s).error().code == ErrorCode::handle,
        "until then");
  const auto file = std::filesystem::temp_directory_path() /
                    ("cargobay-cpp-commands-" + std::to_string(getpid()));
  check(robot->save_recording(file.string()), "a recording");
  check(std::filesystem::file_size(file) > 1000 && std::filesystem::remove(file), "is written");
  const auto unwritten = robot->save_recording("/no/such/folder/file");
  check(unwritten.error().code == ErrorCode::file, "or not");
}

void names() {
  check(cargobay::version_number() == CARGOBAY_VERSION_NUMBER, "the version");
  check(cargobay::error_name(ErrorCode::busy) == "CARGOBAY_E_BUSY", "the name of a code");
  check(cargobay::mode_name(cargobay::Mode::safe) == "safe", "of a mode");
  check(cargobay::event_name(cargobay::EventKind::mode_lost) == "mode_lost", "of an event");
  check(cargobay::packet_name(cargobay::Packet::wall_signal) == "wall_signal", "of a packet");
  std::uint32_t count = 0;
  bool found = false;
  for (; const auto setting = cargobay::setting(count); ++count) {
    found = found || (setting->table == "robot" && setting->key == "wheel_base_mm" &&
                      setting->unit == "mm" && setting->least == 50.0 && setting->most == 1000.0);
  }
  check(found && count > 8, "what can be set");
}

}  // namespace

int main() {
  options_arrive();
  sim_options_arrive();
  reports_progress();
  sends_commands();
  measures();
  names();
}
