/* Every function of the C API in virtual time, and what the virtual Create makes of it. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdbool.h>
#include <unistd.h>

#include "check.h"

static bool near(double value, double wanted, double tolerance) {
  return fabs(value - wanted) <= tolerance;
}

/* Whether the answer to the virtual Create's `state` contains these words. */
static bool sim_says(struct cargobay_sim* sim, const char* words) {
  char answer[4096];
  CHECK(cargobay_sim_inject(sim, "state", answer, sizeof answer) > 0);
  if (strstr(answer, words) != NULL) return true;
  fprintf(stderr, "%s\n", answer);
  return false;
}

static void drives_by_setpoints(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  UNSEEN(state);
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(next_state(robot, &state) == CARGOBAY_OK && state.tick == 0);
  CHECK(state.mode == CARGOBAY_MODE_SAFE);
  for (int i = 0; i < 200; ++i) {
    CHECK(cargobay_drive_wheels(robot, 200.0, 200.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  CHECK(near(state.limited.left_mm_s, 200.0, 0.001) && near(state.target.right_mm_s, 200.0, 0.001));
  CHECK(near(state.estimate.left_mm_s, truth.left_mm_s, 10.0));
  CHECK(near(truth.left_mm_s, 200.0, 8.0) && near(truth.right_mm_s, 200.0, 8.0));
  CHECK(near(state.velocity_mm_s, 200.0, 10.0) && near(state.turn_rate_rad_s, 0.0, 0.08));
  /* This state's own command is still on its way. */
  CHECK(near(truth.commanded_left_mm_s, state.command.left_mm_s, 10.0));
  CHECK(near(state.x_mm, truth.x_mm, 5.0) && near(state.y_mm, truth.y_mm, 15.0));
  CHECK(near(state.distance_mm, state.x_mm, 5.0) && state.covariance[0] > 0.0);
  /* Row by row, symmetric; driving ahead, the heading's error correlates with that of y. */
  CHECK(state.covariance[1] == state.covariance[3] && state.covariance[2] == state.covariance[6]);
  CHECK(state.covariance[5] == state.covariance[7] && state.covariance[5] > 0.0);
  CHECK(state.covariance[4] > 0.0 && state.covariance[8] > 0.0);
  CHECK(state.arrival_ns > 0 && state.robot_time_ns == state.tick * 15000000);
  CHECK(state.battery_mv > 10000 && state.hazards == 0 && state.bumps == 0);
  CHECK(state.remainder == CARGOBAY_REMAINDER_CARRIED && state.setpoint_lapsed == 0);

  /* It is not renewed. */
  CHECK(run_for(robot, 1.0) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK);
  CHECK(state.setpoint_lapsed == 1 && state.command.left_mm_s == 0.0);

  for (int i = 0; i < 100; ++i) {
    CHECK(cargobay_drive(robot, 0.0, 1.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(near(state.target.left_mm_s, -129.0, 0.01) && near(state.target.right_mm_s, 129.0, 0.01));
  CHECK(near(state.turn_rate_rad_s, 1.0, 0.1));
  for (int i = 0; i < 100; ++i) {
    CHECK(cargobay_drive_radius(robot, 150.0, 1000.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(near(state.target.left_mm_s, 150.0 * (1.0 - 0.129), 0.01));
  CHECK(cargobay_drive_radius(robot, 150.0, INFINITY) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK);
  CHECK(state.target.left_mm_s == state.target.right_mm_s);
  CHECK(cargobay_drive_radius(robot, 100.0, 0.0) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK);
  CHECK(state.target.left_mm_s == -100.0 && state.target.right_mm_s == 100.0);

  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK); /* a second time: the same */
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  CHECK(truth.mode == CARGOBAY_MODE_PASSIVE && truth.commanded_left_mm_s == 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static int turns_in_place(void* context, const struct cargobay_state* state,
                          struct cargobay_output* output) {
  int* calls = context;
  ++*calls;
  output->kind = CARGOBAY_OUTPUT_TWIST;
  if (state->heading_rad < 3.0) output->twist.turn_rate_rad_s = 1.0;
  return 0;
}

static void drives_by_a_control_function(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  int calls = 0;
  SIZED(cargobay_truth, truth);
  SIZED(cargobay_statistics, counted);
  CHECK(cargobay_set_control(robot, turns_in_place, &calls) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 6.0) == CARGOBAY_OK);
  CHECK(calls > 390);
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  CHECK(near(truth.heading_rad, 3.0, 0.3) && truth.left_mm_s == 0.0);
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK);
  CHECK(counted.frames_good > 390 && counted.frames_bad == 0 && counted.frames_lost == 0);
  CHECK(counted.scheduler == 0 && counted.ticks > 390 && counted.overruns_control == 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK); /* stops it too */
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK && truth.mode == CARGOBAY_MODE_PASSIVE);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void knows_where_it_is(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  SIZED(cargobay_state, state);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_reset_odometry(robot, 1000.0, -500.0, 1.5) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK && state.x_mm < 1.0);
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  CHECK(near(state.x_mm, 1000.0, 1.0) && near(state.y_mm, -500.0, 1.0));
  CHECK(near(state.heading_rad, 1.5, 0.02));
  CHECK_FAILS(cargobay_reset_odometry(robot, NAN, 0.0, 0.0), CARGOBAY_E_ARGUMENT, "not a number");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void sends_commands(void) {
  const struct cargobay_note notes[2] = {{SECONDS(0.25), 60, 0}, {SECONDS(0.125), 0, 0}};
  const uint8_t two[] = {138, 2, 151, 77}; /* low side drivers, send IR */
  int64_t durations[16] = {0};
  struct cargobay_reading reading;
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_set_leds(robot, CARGOBAY_LED_PLAY, 10, 200) == CARGOBAY_OK);
  CHECK(cargobay_set_digital_outputs(robot, 5) == CARGOBAY_OK);
  CHECK(cargobay_set_pwm_low_side_drivers(robot, 1, 2, 128) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  CHECK(sim_says(sim, "\"power_color\":10,\"power_intensity\":200"));
  CHECK(sim_says(sim, "\"digital_out\":5,\"low_side_driver\":[1,2,128]"));
  CHECK(cargobay_set_low_side_drivers(robot, 1) == CARGOBAY_OK);
  CHECK(cargobay_send_bytes(robot, two, sizeof two, 0) == CARGOBAY_OK);
  CHECK(cargobay_send_ir(robot, 130) == CARGOBAY_OK);
  CHECK(cargobay_send_command(robot, "leds none 0 64", 0) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  CHECK(sim_says(sim, "\"low_side_driver\":[0,128,0],"));
  CHECK(sim_says(sim, "\"ir_sent\":130"));
  CHECK(sim_says(sim, "\"power_intensity\":64"));

  CHECK(cargobay_store_song(robot, 3, notes, 2) == CARGOBAY_OK);
  CHECK(cargobay_play_song(robot, 3) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_query(robot, CARGOBAY_PACKET_SONG_PLAYING, SECONDS(1), &reading) == CARGOBAY_OK);
  CHECK(reading.value == 1);
  CHECK(cargobay_query(robot, CARGOBAY_PACKET_SONG_NUMBER, SECONDS(1), &reading) == CARGOBAY_OK);
  CHECK(reading.value == 3);
  CHECK(cargobay_store_tune(robot, 4, "t:d=8,o=5,b=120:c,d,e,f,g,a,b,c6,d6,e6,f6,g6,a6,b6,c7,d7,e7",
                            durations, 16) == 2);
  CHECK(durations[0] == SECONDS(4) && durations[1] == SECONDS(0.25) && durations[2] == 0);

  /* A script that drives 200 mm ahead by itself; the loop goes on after it. */
  CHECK(cargobay_store_script(robot, "drive 200 straight; wait_distance 200; drive 0 straight",
                              0) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  CHECK(cargobay_play_script(robot, SECONDS(4)) == CARGOBAY_OK);
  CHECK(run_for(robot, 3.0) == CARGOBAY_OK);
  {
    SIZED(cargobay_truth, truth);
    CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
    CHECK(near(truth.x_mm, 215.0, 35.0) && truth.mode == CARGOBAY_MODE_SAFE);
  }
  CHECK(cargobay_expect_silence(robot, SECONDS(1)) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* A command that is too long beside the loop's own. */
static void keeps_to_the_budget(void) {
  char text[400] = "drive 1 straight";
  for (int i = 2; i <= 20; ++i)
    snprintf(text + strlen(text), sizeof text - strlen(text), "; drive %d straight", i);
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  UNSEEN(state);
  SIZED(cargobay_statistics, counted);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 60; ++i) {
    CHECK(cargobay_drive(robot, 200.0, 0.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK_FAILS(cargobay_store_script(robot, text, 0), CARGOBAY_E_FULL, "CARGOBAY_HOW_PAUSE_DRIVING");
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK && counted.commands_withheld == 0);
  CHECK(cargobay_store_script(robot, text, CARGOBAY_HOW_PAUSE_DRIVING) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK && counted.commands_withheld > 0);
  CHECK(counted.frames_bad == 0 && counted.frames_lost == 0 && counted.commands_unsent == 0);
  /* More than the queue holds. */
  int error = CARGOBAY_OK;
  for (int i = 0; i < 40 && error == CARGOBAY_OK; ++i) error = cargobay_send_ir(robot, 1);
  CHECK_FAILS(error, CARGOBAY_E_FULL, "");
  CHECK(run_for(robot, 1.0) == CARGOBAY_OK);
  CHECK(cargobay_send_ir(robot, 1) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* The next event of a kind after this one; false if there is none. */
static bool find_event(struct cargobay_robot* robot, int kind, struct cargobay_event* event) {
  while (cargobay_next_event(robot, event->sequence, event) == 1) {
    if (event->kind == kind) return true;
  }
  return false;
}

static void tells_events(void) {
  char text[200];
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, CARGOBAY_FLAG_HOLD_ON_MODE_LOSS);
  SIZED(cargobay_event, event);
  SIZED(cargobay_state, state);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.5) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "bump left", NULL, 0) >= 0);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK && state.bumps == CARGOBAY_BUMP_LEFT);
  CHECK(find_event(robot, CARGOBAY_EVENT_BUMP_BEGAN, &event) && event.bumps == CARGOBAY_BUMP_LEFT);
  CHECK(cargobay_describe_event(&event, text, sizeof text) > 0 && strstr(text, "left") != NULL);
  CHECK(cargobay_sim_inject(sim, "bump none", NULL, 0) >= 0);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  CHECK(find_event(robot, CARGOBAY_EVENT_BUMP_ENDED, &event));

  CHECK(cargobay_sim_inject(sim, "wheeldrop left on", NULL, 0) >= 0);
  CHECK(run_for(robot, 0.5) == CARGOBAY_OK);
  CHECK(find_event(robot, CARGOBAY_EVENT_MODE_LOST, &event));
  CHECK(event.hazards == CARGOBAY_HAZARD_WHEEL_DROP_LEFT && event.mode == CARGOBAY_MODE_PASSIVE);
  CHECK(event.tick > 0 && event.arrival_ns > 0);
  CHECK_FAILS(cargobay_drive(robot, 100.0, 0.0), CARGOBAY_E_MODE, "cargobay_rearm");
  CHECK_FAILS(cargobay_set_leds(robot, 0, 0, 0), CARGOBAY_E_MODE, "LEDs is not obeyed in passive");
  CHECK(cargobay_sim_inject(sim, "wheeldrop left off", NULL, 0) >= 0);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_rearm(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.5) == CARGOBAY_OK);
  CHECK(find_event(robot, CARGOBAY_EVENT_REARMED, &event));
  CHECK(cargobay_drive(robot, 100.0, 0.0) == CARGOBAY_OK);
  CHECK(cargobay_next_event(robot, event.sequence, &event) == 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void measures_and_records(void) {
  char file[] = "/tmp/cargobay-capi-XXXXXX";
  int64_t time_ns = 0;
  struct cargobay_histogram* histogram = NULL;
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  SIZED(cargobay_distribution, held);
  const int descriptor = mkstemp(file);
  CHECK(descriptor >= 0 && close(descriptor) == 0);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  options.record = file;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_histogram_open(&histogram) == CARGOBAY_OK);
  for (int i = 1; i <= 100; ++i)
    CHECK(cargobay_histogram_record(histogram, (int64_t)i * 1000) == CARGOBAY_OK);
  CHECK(cargobay_histogram_get(histogram, &held) == CARGOBAY_OK);
  CHECK(held.count == 100 && held.min_ns == 1000 && held.max_ns == 100000);
  CHECK(near((double)held.p50_ns, 50000.0, 500.0) && near(held.mean_ns, 50500.0, 0.5));
  CHECK(cargobay_histogram_get_percentile(histogram, 90.0, &time_ns) == CARGOBAY_OK);
  CHECK(near((double)time_ns, 90000.0, 800.0));
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 300.0) == CARGOBAY_OK); /* longer than the recorder's memory */
  CHECK(cargobay_copy_histogram(robot, CARGOBAY_MEASURE_PERIOD, histogram) == CARGOBAY_OK);
  CHECK(cargobay_histogram_get(histogram, &held) == CARGOBAY_OK);
  CHECK(held.count > 19000 && near((double)held.p50_ns, 15e6, 2e5));
  CHECK(cargobay_copy_histogram(robot, CARGOBAY_MEASURE_FRAME_TO_COMMAND, histogram) ==
        CARGOBAY_OK);
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  {
    char command[300];
    const char* cargobay = getenv("CARGOBAY_COMMAND");
    CHECK(cargobay != NULL);
    snprintf(command, sizeof command, "%s replay %s > /dev/null", cargobay, file);
    CHECK(system(command) == 0); /* the same again, bit for bit */
  }
  CHECK(remove(file) == 0);
}

static int hears_the_bring_up(void* context, const char* step, const char* detail) {
  int* steps = context;
  CHECK(step != NULL && detail != NULL);
  ++*steps;
  return 0;
}

static void has_the_wheels_of_another_robot(void) {
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_sim_options, create);
  create.time = CARGOBAY_SIM_TIME_VIRTUAL;
  create.plant = "slow dead-time 0.06";
  create.gain_left = 0.7;
  CHECK(cargobay_sim_open(&create, &sim) == CARGOBAY_OK);
  CHECK(sim_says(sim, "\"lag\":0.25,\"dead_time\":0.06,\"ramp\":0,\"gain_left\":0.7,"));
  CHECK(cargobay_sim_inject(sim, "plant carpet", NULL, 0) > 0);
  CHECK(sim_says(sim, "\"name\":\"carpet\""));
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void brings_up(void) {
  int steps = 0;
  struct cargobay_sim* sim = NULL;
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_sim_options, create);
  SIZED(cargobay_options, options);
  SIZED(cargobay_bring_up, told);
  create.time = CARGOBAY_SIM_TIME_VIRTUAL;
  create.boot_baud = 19200;
  CHECK(cargobay_sim_open(&create, &sim) == CARGOBAY_OK);
  CHECK(cargobay_sim_advance(sim, SECONDS(1)) == CARGOBAY_OK);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  options.mode = CARGOBAY_MODE_FULL;
  options.progress = hears_the_bring_up;
  options.progress_context = &steps;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(steps > 1);
  CHECK(cargobay_get_bring_up(robot, &told) == CARGOBAY_OK);
  CHECK(told.found_baud == 19200 && told.baud == 57600 &&
        told.rate_change == CARGOBAY_RATE_CHANGE_COMMAND);
  CHECK(told.took_ns > 0 && told.powered_on == 0 && told.brc_pulses == 0);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  {
    SIZED(cargobay_state, state);
    CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK && state.mode == CARGOBAY_MODE_FULL);
  }
  CHECK(cargobay_request_end(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 1.0) == CARGOBAY_ENDED);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

int main(void) {
  drives_by_setpoints();
  drives_by_a_control_function();
  knows_where_it_is();
  sends_commands();
  keeps_to_the_budget();
  tells_events();
  measures_and_records();
  has_the_wheels_of_another_robot();
  brings_up();
  return 0;
}
