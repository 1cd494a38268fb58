/* Every function with the extremes of every argument: refused, or done as the header says; never a
 * crash, an overflow or an endless wait. A sanitizer sees what a return value does not show. */
#define _GNU_SOURCE
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "check.h"
#include "every_function.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static const double kReals[] = {NAN,   -NAN,   INFINITY, -INFINITY, 0.0,    -0.0,  1.0,
                                -1.0,  1e-320, -1e-320,  1e308,     -1e308, 500.0, 500.1,
                                1e300, 1e19,   -1e19,    4.9e-324,  1.5e-5, 258.0, 1000.1};
static const int64_t kTimes[] = {INT64_MIN, INT64_MIN + 1, INT32_MIN,     -1,       0, 1,
                                 INT32_MAX, UINT32_MAX,    INT64_MAX - 1, INT64_MAX};
static const int kInts[] = {INT_MIN, INT_MIN + 1, -256, -1, 0,   1,   6,
                            7,       19,          42,   43, 255, 256, INT_MAX};
static const uint32_t kWords[] = {0, 1, 2, 3, 7, 8, 10, 255, 256, 0x7fffffff, ~UINT32_C(0)};
static const uint8_t kBytes[] = {0, 1, 15, 16, 127, 128, 129, 255};
static const int64_t kDay = INT64_C(86400000000000);

/* A code of enum cargobay_error, 0, or a count. */
static void is_an_answer(int result) {
  CHECK(result >= CARGOBAY_E_TIMEOUT);
  CHECK(result >= 0 || strlen(cargobay_error_message()) > 10);
}

static void refuses_other_kinds(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  struct cargobay_histogram* histogram = NULL;
  struct cargobay_robot* second = NULL;
  char here[64] = "";
  SIZED(cargobay_options, options);
  CHECK(cargobay_histogram_open(&histogram) == CARGOBAY_OK);
  every_robot_function_refuses((void*)sim, "handle of a virtual Create, not of a robot");
  every_robot_function_refuses((void*)histogram, "handle of a histogram, not of a robot");
  every_sim_function_refuses((void*)robot, "handle of a robot, not of a virtual Create");
  every_sim_function_refuses((void*)histogram, "handle of a histogram, not of a virtual Create");
  every_histogram_function_refuses((void*)robot, "handle of a robot, not of a histogram");
  every_histogram_function_refuses((void*)sim, "handle of a virtual Create, not of a histogram");
  options.flags = CARGOBAY_NO_CONFIG;
  options.sim = (void*)robot;
  CHECK_FAILS(cargobay_open(&options, &second), CARGOBAY_E_HANDLE, "not of a virtual Create");

  /* Numbers that were never handles, and memory that is not a handle. */
  every_robot_function_refuses((void*)(here + ((uintptr_t)here & 1u)), "not a handle");
  every_robot_function_refuses((void*)(uintptr_t)1, "not a handle");
  every_sim_function_refuses((void*)UINTPTR_MAX, "virtual Create");
  every_sim_function_refuses((void*)(uintptr_t)2, "not a handle");
  every_histogram_function_refuses((void*)(UINTPTR_MAX - 1), "not a handle");
  for (unsigned bit = 0; bit < 8 * sizeof(void*); ++bit) {
    const uintptr_t forged = (uintptr_t)robot ^ ((uintptr_t)1 << bit);
    CHECK(cargobay_request_stop((void*)forged) == CARGOBAY_E_HANDLE);
  }
  /* None of that has affected the real ones. */
  CHECK(cargobay_start(robot) == CARGOBAY_OK && run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
}

/* Opened with one member of its options out of range or at an extreme. */
static void opens(struct cargobay_sim* sim, size_t member, const void* value, size_t size) {
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_NO_CONFIG;
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
                          offsetof(struct cargobay_options, setpoint_lapse_ms),
                          offsetof(struct cargobay_options, control_budget_us),
                          offsetof(struct cargobay_options, control_overruns),
                          offsetof(struct cargobay_options, link_timeout_ms),
                          offsetof(struct cargobay_options, guard_deadline_ms)};
  for (size_t i = 0; i < COUNT(reals); ++i) {
    for (size_t k = 0; k < COUNT(kReals); ++k) opens(sim, reals[i], &kReals[k], sizeof kReals[k]);
  }
  for (size_t i = 0; i < COUNT(words); ++i) {
    for (size_t k = 0; k < COUNT(kWords); ++k) opens(sim, words[i], &kWords[k], sizeof kWords[k]);
  }
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void opens_sim(size_t member, const void* value, size_t size) {
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_sim_options, options);
  SIZED(cargobay_truth, truth);
  options.time = CARGOBAY_SIM_VIRTUAL;
  memcpy((char*)&options + member, value, size);
  const int result = cargobay_sim_open(&options, &sim);
  is_an_answer(result);
  CHECK((result == CARGOBAY_OK) == (sim != NULL));
  if (sim == NULL) return;
  CHECK(cargobay_sim_advance(sim, SECONDS(0.1)) == CARGOBAY_OK);
  CHECK(cargobay_sim_truth(sim, &truth) == CARGOBAY_OK && isfinite(truth.left_mm_s));
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void takes_any_sim_options(void) {
  const size_t reals[] = {offsetof(struct cargobay_sim_options, lag_s),
                          offsetof(struct cargobay_sim_options, droop_left),
                          offsetof(struct cargobay_sim_options, droop_right),
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
  for (size_t k = 0; k < COUNT(kTimes); ++k)
    opens_sim(offsetof(struct cargobay_sim_options, seed), &kTimes[k], sizeof kTimes[k]);
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
      (void)cargobay_wheels_of(a, b, kReals[(i + k) % COUNT(kReals)]);
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
  int32_t value = 0;
  SIZED(cargobay_state, state);
  for (size_t i = 0; i < COUNT(kTimes); ++i) {
    const bool sensible = kTimes[i] >= 0 && kTimes[i] <= kDay;
    CHECK((cargobay_expect_silence(robot, kTimes[i]) == CARGOBAY_E_ARGUMENT) == !sensible);
    is_an_answer(cargobay_wait(robot, kTimes[i], &state));
    is_an_answer(cargobay_wait(robot, kTimes[i], NULL));
    for (size_t k = 0; k < COUNT(kInts); ++k)
      is_an_answer(cargobay_query(robot, kInts[k], kTimes[i], &value));
    CHECK((cargobay_play_script(robot, kTimes[i]) == CARGOBAY_E_ARGUMENT) == !sensible);
  }
  CHECK(cargobay_expect_silence(robot, kDay) == CARGOBAY_OK);
  CHECK(cargobay_expect_silence(robot, kDay + 1) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_expect_silence(robot, 0) == CARGOBAY_OK);
}

static void small_numbers(struct cargobay_robot* robot) {
  const struct cargobay_note notes[17] = {{0, 0}, {255, 255}};
  char text[128];
  int32_t durations[16];
  const uint8_t bytes[200] = {0};
  for (size_t i = 0; i < COUNT(kWords); ++i) {
    is_an_answer(cargobay_leds(robot, kWords[i], 255, 255));
    is_an_answer(cargobay_digital_outputs(robot, kWords[i]));
    is_an_answer(cargobay_low_side_drivers(robot, kWords[i]));
    is_an_answer(cargobay_subscribe(robot, kWords[i]));
    is_an_answer(cargobay_script(robot, "leds none 0 0", kWords[i]));
    is_an_answer(cargobay_command(robot, "leds none 0 0", kWords[i]));
    is_an_answer(cargobay_raw(robot, bytes, 1, kWords[i]));
    CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  }
  for (size_t i = 0; i < COUNT(kBytes); ++i) {
    const uint8_t byte = kBytes[i];
    is_an_answer(cargobay_leds(robot, 0, byte, (uint8_t)(255 - byte)));
    is_an_answer(cargobay_pwm_low_side_drivers(robot, byte, 0, 128));
    is_an_answer(cargobay_send_ir(robot, byte));
    is_an_answer(cargobay_play_song(robot, byte));
    is_an_answer(cargobay_song(robot, byte, notes, 16));
    is_an_answer(cargobay_tune(robot, byte, "t:d=4:c", durations));
    is_an_answer(cargobay_tune(robot, byte, "t:d=4:c", NULL));
    CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  }
  CHECK(cargobay_song(robot, 0, notes, 17) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_song(robot, 0, notes, SIZE_MAX) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_song(robot, 0, NULL, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_raw(robot, bytes, 0, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_raw(robot, bytes, 125, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_raw(robot, bytes, SIZE_MAX, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_script(robot, NULL, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_command(robot, NULL, 0) == CARGOBAY_E_ARGUMENT);
  for (size_t i = 0; i < COUNT(kInts); ++i) {
    CHECK(cargobay_packet_name(kInts[i]) != NULL);
    CHECK(cargobay_error_name(kInts[i]) != NULL);
    is_an_answer(cargobay_copy_histogram(robot, kInts[i], NULL));
    SIZED(cargobay_event, event);
    event.kind = kInts[i] >= 0 && kInts[i] <= CARGOBAY_EVENT_BUMP_ENDED ? kInts[i] : 0;
    event.mode = event.voltage_mv = event.charge_mah = event.capacity_mah = kInts[i];
    event.hazards = event.overcurrents = event.frames = event.bumps = (uint32_t)kInts[i];
    event.tick = event.time_ns = INT64_MIN;
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
    is_an_answer(cargobay_command(robot, text, 0));
    is_an_answer(cargobay_script(robot, text, 0));
    is_an_answer(cargobay_tune(robot, 0, text, NULL));
  }
}

static void is_driven(struct cargobay_robot* robot) {
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  speeds(robot);
  times(robot);
  small_numbers(robot);
  texts(robot);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  CHECK(cargobay_stop(robot) == CARGOBAY_OK);
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
  CHECK(cargobay_sim_path(sim, path, 0) > 5 && cargobay_sim_path(sim, path, 1) > 5);
  CHECK(cargobay_sim_path(sim, path, sizeof path) > 5);
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
    is_an_answer(cargobay_histogram_percentile(histogram, kReals[k], &time_ns));
  CHECK(cargobay_histogram_percentile(histogram, 50.0, &time_ns) == CARGOBAY_OK && time_ns == 0);
  for (int i = 0; i < 1000; ++i)
    CHECK(cargobay_histogram_record(histogram, INT64_MAX) == CARGOBAY_OK);
  CHECK(cargobay_histogram_get(histogram, &held) == CARGOBAY_OK);
  CHECK(held.count == 1000 && held.max_ns == kDay && held.mean_ns == (double)kDay);
  CHECK(cargobay_histogram_record(histogram, INT64_MIN) == CARGOBAY_OK);
  CHECK(cargobay_histogram_get(histogram, &held) == CARGOBAY_OK && held.min_ns == 0);
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
}

int main(void) {
  refuses_other_kinds();
  takes_any_options();
  takes_any_sim_options();
  in_virtual_time();
  in_real_time();
  histograms();
  return 0;
}
