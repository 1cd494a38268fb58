/* Every function with the extremes of every argument: refused, or done as the header says; never a
 * crash, an overflow or an endless wait. A sanitizer sees what a return value does not show. */
#define _GNU_SOURCE
#include <limits.h>
#include <math.h>
#include <stdbool.h>

#include "check.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static const double kReals[] = {NAN,   -NAN,   INFINITY, -INFINITY, 0.0,    -0.0,  1.0,
                                -1.0,  1e-320, -1e-320,  1e308,     -1e308, 500.0, 500.1,
                                1e300, 1e19,   -1e19,    4.9e-324,  1.5e-5, 258.0, 1000.1};
static const int64_t kTimes[] = {INT64_MIN, INT64_MIN + 1, INT32_MIN,     -1,       0, 1,
                                 INT32_MAX, UINT32_MAX,    INT64_MAX - 1, INT64_MAX};
static const int kInts[] = {INT_MIN, INT_MIN + 1, -256, -1, 0,   1,   6,
                            7,       19,          42,   43, 255, 256, INT_MAX};
static const uint32_t kWords[] = {0,  1,  2,   3,   4,   7,   8,   10,         15,
                                  16, 31, 127, 128, 129, 255, 256, 0x7fffffff, ~UINT32_C(0)};
static const int64_t kDay = INT64_C(86400000000000);

/* A code of enum cargobay_error, 0, or a count. */
static void is_an_answer(int result) {
  CHECK(result >= CARGOBAY_E_WHEELS);
  CHECK(result >= 0 || strlen(cargobay_error_message()) > 10);
}

/* Opened with one member of its options out of range or at an extreme. */
static void opens(struct cargobay_sim* sim, size_t member, const void* value, size_t size) {
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  memcpy((char*)&options + member, value, size);
  const int result = cargobay_open(&options, &robot);
  is_an_answer(result);
  CHECK((result == CARGOBAY_OK) == (robot != NULL));
  if (robot != NULL) CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

static void takes_any_options(void) {
  struct cargobay_sim* sim = virtual_sim();
  const size_t reals[] = {offsetof(struct cargobay_options, acceleration_mm_s2),
                          offsetof(struct cargobay_options, jerk_mm_s3),
                          offsetof(struct cargobay_options, wheel_base_mm),
                          offsetof(struct cargobay_options, distance_scale),
                          offsetof(struct cargobay_options, turn_scale)};
  const size_t words[] = {offsetof(struct cargobay_options, baud),
                          offsetof(struct cargobay_options, mode),
                          offsetof(struct cargobay_options, remainder),
                          offsetof(struct cargobay_options, priority),
                          offsetof(struct cargobay_options, cpu),
                          offsetof(struct cargobay_options, control_overruns),
                          offsetof(struct cargobay_options, port_fd),
                          offsetof(struct cargobay_options, message_size)};
  const size_t times[] = {offsetof(struct cargobay_options, setpoint_lapse_ns),
                          offsetof(struct cargobay_options, control_budget_ns),
                          offsetof(struct cargobay_options, link_timeout_ns),
                          offsetof(struct cargobay_options, guard_deadline_ns)};
  for (size_t i = 0; i < COUNT(reals); ++i) {
    for (size_t k = 0; k < COUNT(kReals); ++k) opens(sim, reals[i], &kReals[k], sizeof kReals[k]);
  }
  for (size_t i = 0; i < COUNT(words); ++i) {
    for (size_t k = 0; k < COUNT(kWords); ++k) opens(sim, words[i], &kWords[k], sizeof kWords[k]);
  }
  for (size_t i = 0; i < COUNT(times); ++i) {
    for (size_t k = 0; k < COUNT(kTimes); ++k) opens(sim, times[i], &kTimes[k], sizeof kTimes[k]);
  }
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void opens_sim(size_t member, const void* value, size_t size) {
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_sim_options, options);
  SIZED(cargobay_truth, truth);
  options.time = CARGOBAY_SIM_TIME_VIRTUAL;
  memcpy((char*)&options + member, value, size);
  const int result = cargobay_sim_open(&options, &sim);
  is_an_answer(result);
  CHECK((result == CARGOBAY_OK) == (sim != NULL));
  if (sim == NULL) return;
  CHECK(cargobay_sim_advance(sim, SECONDS(0.1)) == CARGOBAY_OK);
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK && isfinite(truth.left_mm_s));
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void takes_any_sim_options(void) {
  const size_t reals[] = {offsetof(struct cargobay_sim_options, gain_left),
                          offsetof(struct cargobay_sim_options, gain_right),
                          offsetof(struct cargobay_sim_options, noise_mm_s),
                          offsetof(struct cargobay_sim_options, wheel_base_mm)};
  const size_t words[] = {offsetof(struct cargobay_sim_options, time),
                          offsetof(struct cargobay_sim_options, remainder),
                          offsetof(struct cargobay_sim_options, boot_baud)};
  for (size_t i = 0; i < COUNT(reals); ++i) {
    for (size_t k = 0; k < COUNT(kReals); ++k) opens_sim(reals[i], &kReals[k], sizeof kReals[k]);
  }
  for (size_t i = 0; i < COUNT(words); ++i) {
    for (size_t k = 0; k < COUNT(kWords); ++k) opens_sim(words[i], &kWords[k], sizeof kWords[k]);
  }
  for (size_t k = 0; k < COUNT(kTimes); ++k) {
    opens_sim(offsetof(struct cargobay_sim_options, seed), &kTimes[k], sizeof kTimes[k]);
    opens_sim(offsetof(struct cargobay_sim_options, lag_ns), &kTimes[k], sizeof kTimes[k]);
  }
}

static void speeds(struct cargobay_robot* robot) {
  for (size_t i = 0; i < COUNT(kReals); ++i) {
    for (size_t k = 0; k < COUNT(kReals); ++k) {
      const double a = kReals[i];
      const double b = kReals[k];
      const bool possible = fabs(a) <= 500.0 && fabs(b) <= 500.0;
      CHECK(cargobay_drive_wheels(robot, a, b) == (possible ? CARGOBAY_OK : CARGOBAY_E_ARGUMENT));
      is_an_answer(cargobay_drive(robot, a, b));
      is_an_answer(cargobay_drive_radius(robot, a, b));
      const struct cargobay_twist twist = {a, b};
      struct cargobay_wheels wheels = {-1.0, -1.0};
      is_an_answer(cargobay_wheels_of(robot, twist, &wheels));
      CHECK(fabs(wheels.left_mm_s) <= 500.0 && fabs(wheels.right_mm_s) <= 500.0);
      const bool near = fabs(a) <= 1e9 && fabs(b) <= 1e9;
      const int put = cargobay_reset_odometry(robot, a, b, 0.0);
      CHECK(put == (near ? CARGOBAY_OK : CARGOBAY_E_ARGUMENT) || put == CARGOBAY_E_FULL);
      is_an_answer(cargobay_reset_odometry(robot, 0.0, a, b));
    }
    CHECK(cargobay_drive_wheels(robot, 0.0, 0.0) == CARGOBAY_OK);
    CHECK(run_for(robot, 0.05) == CARGOBAY_OK);
  }
}

static void times(struct cargobay_robot* robot) {
  struct cargobay_reading reading;
  SIZED(cargobay_state, state);
  for (size_t i = 0; i < COUNT(kTimes); ++i) {
    const int64_t time = kTimes[i];
    const bool sensible = time >= 0 && time <= kDay;
    CHECK((cargobay_expect_silence(robot, time) == CARGOBAY_E_ARGUMENT) == !sensible);
    /* A tick that never comes would be waited for as long as was asked. */
    for (size_t k = 0; k < COUNT(kTimes); ++k) {
      const bool comes = kTimes[k] < 1000000;
      if (comes || (time >= 0 && time <= 1)) {
        const int got = cargobay_wait(robot, kTimes[k], time, &state);
        is_an_answer(got);
        CHECK(got != CARGOBAY_OK || state.tick > kTimes[k]);
      }
    }
    is_an_answer(cargobay_wait(robot, -1, time, NULL));
    for (size_t k = 0; k < COUNT(kWords); ++k)
      is_an_answer(cargobay_query(robot, kWords[k], time, &reading));
    CHECK((cargobay_play_script(robot, time) == CARGOBAY_E_ARGUMENT) == !sensible);
  }
  CHECK(cargobay_expect_silence(robot, kDay) == CARGOBAY_OK);
  CHECK(cargobay_expect_silence(robot, kDay + 1) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_expect_silence(robot, 0) == CARGOBAY_OK);
}

static void commands(struct cargobay_robot* robot) {
  const struct cargobay_note notes[17] = {{0, 0, 0}, {INT64_C(3984375000), 255, 0}};
  const uint8_t bytes[200] = {0};
  int64_t durations[16];
  for (size_t i = 0; i < COUNT(kWords); ++i) {
    const uint32_t word = kWords[i];
    is_an_answer(cargobay_set_leds(robot, word, 255, 255));
    is_an_answer(cargobay_set_leds(robot, 0, word, ~word));
    is_an_answer(cargobay_set_digital_outputs(robot, word));
    is_an_answer(cargobay_set_low_side_drivers(robot, word));
    is_an_answer(cargobay_set_pwm_low_side_drivers(robot, word, 0, 128));
    is_an_answer(cargobay_send_ir(robot, word));
    is_an_answer(cargobay_play_song(robot, word));
    is_an_answer(cargobay_store_song(robot, word, notes, 16));
    is_an_answer(cargobay_store_tune(robot, word, "t:d=4:c", durations, COUNT(durations)));
    is_an_answer(cargobay_store_tune(robot, word, "t:d=4:c", NULL, SIZE_MAX));
    is_an_answer(cargobay_subscribe(robot, &word, 1));
    is_an_answer(cargobay_unsubscribe(robot, &word, 1));
    is_an_answer(cargobay_store_script(robot, "leds none 0 0", word));
    is_an_answer(cargobay_send_command(robot, "leds none 0 0", word));
    is_an_answer(cargobay_send_bytes(robot, bytes, 1, word));
    CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  }
  CHECK(cargobay_store_song(robot, 0, notes, 17) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_store_song(robot, 0, notes, SIZE_MAX) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_store_song(robot, 0, NULL, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_send_bytes(robot, bytes, 0, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_send_bytes(robot, bytes, 125, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_send_bytes(robot, bytes, SIZE_MAX, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_store_script(robot, NULL, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_send_command(robot, NULL, 0) == CARGOBAY_E_ARGUMENT);
}

/* What is read: any index, tick, sequence number and count. */
static void readers(struct cargobay_robot* robot) {
  static struct cargobay_state states[256];
  struct cargobay_reading readings[64];
  uint32_t packets[64];
  SIZED(cargobay_event, event);
  for (size_t i = 0; i < COUNT(kTimes); ++i) {
    is_an_answer(cargobay_next_event(robot, kTimes[i], &event));
    for (size_t k = 0; k < COUNT(kWords); ++k) {
      memset(states, 0, sizeof states);
      states[0].size = sizeof states[0];
      is_an_answer(cargobay_get_history(robot, kTimes[i], states, kWords[k] % 257));
    }
  }
  CHECK(cargobay_get_history(robot, -1, states, SIZE_MAX) == CARGOBAY_E_ARGUMENT);
  for (size_t i = 0; i < COUNT(kWords); ++i) {
    SIZED(cargobay_setting, setting);
    for (size_t k = 0; k < COUNT(packets); ++k) packets[k] = kWords[(i + k) % COUNT(kWords)];
    is_an_answer(cargobay_get_readings(robot, packets, 64, readings));
    is_an_answer(cargobay_get_setting(kWords[i], &setting));
  }
  CHECK(cargobay_get_readings(robot, packets, SIZE_MAX, readings) == CARGOBAY_E_ARGUMENT);
}

static void small_numbers(struct cargobay_robot* robot) {
  char text[300];
  for (size_t i = 0; i < COUNT(kInts); ++i) {
    CHECK(cargobay_packet_name(kInts[i]) != NULL && cargobay_error_name(kInts[i]) != NULL);
    CHECK(cargobay_mode_name(kInts[i]) != NULL && cargobay_event_name(kInts[i]) != NULL);
    is_an_answer(cargobay_copy_histogram(robot, kInts[i], NULL));
    SIZED(cargobay_event, event);
    event.kind = kInts[i] >= 0 && kInts[i] <= CARGOBAY_EVENT_BUMP_ENDED ? kInts[i] : 0;
    event.mode = event.voltage_mv = event.charge_mah = event.capacity_mah = kInts[i];
    event.hazards = event.overcurrents = event.frames = event.bumps = (uint32_t)kInts[i];
    event.tick = event.arrival_ns = event.sequence = INT64_MIN;
    memset(event.process_name, 'x', sizeof event.process_name);
    CHECK(cargobay_describe_event(&event, text, sizeof text) >= 0);
    CHECK(cargobay_describe_event(&event, text, 1) >= 0 && text[0] == '\0');
    CHECK(cargobay_describe_event(&event, text, 0) >= 0);
    event.kind = kInts[i];
    is_an_answer(cargobay_describe_event(&event, text, sizeof text));
  }
}

/* Texts of any length, and bytes that are not text. */
static void texts(struct cargobay_robot* robot) {
  static char text[100001];
  for (int fill = 1; fill < 256; fill += 13) {
    memset(text, fill, sizeof text - 1);
    is_an_answer(cargobay_send_command(robot, text, 0));
    is_an_answer(cargobay_store_script(robot, text, 0));
    is_an_answer(cargobay_store_tune(robot, 0, text, NULL, 0));
  }
}

static void is_driven(struct cargobay_robot* robot) {
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  speeds(robot);
  times(robot);
  commands(robot);
  readers(robot);
  small_numbers(robot);
  texts(robot);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
}

static void in_virtual_time(void) {
  struct cargobay_sim* sim = virtual_sim();
  for (size_t i = 0; i < COUNT(kTimes); ++i) {
    if (kTimes[i] >= 0 && kTimes[i] <= SECONDS(10))
      CHECK(cargobay_sim_advance(sim, kTimes[i]) == CARGOBAY_OK);
    else
      CHECK_FAILS(cargobay_sim_advance(sim, kTimes[i]), CARGOBAY_E_ARGUMENT, "`duration_ns`");
  }
  CHECK_FAILS(cargobay_sim_advance(sim, kDay + 1), CARGOBAY_E_ARGUMENT, "more than a day");
  struct cargobay_robot* robot = robot_of(sim, 0);
  is_driven(robot);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void in_real_time(void) {
  char path[64];
  struct cargobay_sim* sim = NULL;
  CHECK(cargobay_sim_open(NULL, &sim) == CARGOBAY_OK);
  CHECK(cargobay_sim_get_path(sim, path, 0) > 5 && cargobay_sim_get_path(sim, path, 1) > 5);
  CHECK(cargobay_sim_get_path(sim, path, sizeof path) > 5);
  CHECK_FAILS(cargobay_sim_advance(sim, INT64_MAX), CARGOBAY_E_ARGUMENT, "more than a day");
  CHECK_FAILS(cargobay_sim_advance(sim, INT64_MIN), CARGOBAY_E_ARGUMENT, "negative");
  struct cargobay_robot* robot = robot_of(sim, 0);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  times(robot);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void histograms(void) {
  int64_t time_ns = 0;
  struct cargobay_histogram* histogram = NULL;
  SIZED(cargobay_distribution, held);
  CHECK(cargobay_histogram_open(&histogram) == CARGOBAY_OK);
  for (size_t k = 0; k < COUNT(kReals); ++k)
    is_an_answer(cargobay_histogram_get_percentile(histogram, kReals[k], &time_ns));
  CHECK(cargobay_histogram_get_percentile(histogram, 50.0, &time_ns) == CARGOBAY_OK &&
        time_ns == 0);
  for (int i = 0; i < 1000; ++i)
    CHECK(cargobay_histogram_record(histogram, INT64_MAX) == CARGOBAY_OK);
  CHECK(cargobay_histogram_get(histogram, &held) == CARGOBAY_OK);
  CHECK(held.count == 1000 && held.max_ns == kDay && held.mean_ns == (double)kDay);
  CHECK(cargobay_histogram_record(histogram, INT64_MIN) == CARGOBAY_OK);
  CHECK(cargobay_histogram_get(histogram, &held) == CARGOBAY_OK && held.min_ns == 0);
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
}

int main(void) {
  takes_any_options();
  takes_any_sim_options();
  in_virtual_time();
  in_real_time();
  histograms();
  return 0;
}
