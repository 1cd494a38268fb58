/* Every error that the header documents, and every misuse: each gets its code. */
#define _GNU_SOURCE
#include <math.h>
#include <pthread.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "every_function.h"

static void refuses_arguments(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_sim* other = NULL;
  struct cargobay_robot* robot = NULL;
  int32_t value = 0;
  int64_t time_ns = 0;
  char text[100];
  struct cargobay_histogram* histogram = NULL;
  SIZED(cargobay_options, options);
  SIZED(cargobay_sim_options, create);
  SIZED(cargobay_event, event);
  CHECK_FAILS(cargobay_open(NULL, NULL), CARGOBAY_E_ARGUMENT, "`robot` is NULL");
  options.size = 0;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`size`");
  options.size = sizeof options;
  options.flags = 1u << 31;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`flags`");
  options.flags = CARGOBAY_NO_CONFIG;
  options.port = "/dev/ttyS0";
  options.sim = sim;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "not both");
  options.port = NULL;
  options.mode = CARGOBAY_MODE_PASSIVE;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`mode`");
  options.mode = 0;
  options.baud = 12345;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`baud`");
  options.baud = 0;
  options.priority = 99;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`priority`");
  options.priority = 0;
  options.guard_deadline_ms = 10;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`guard_deadline_ms`");
  options.guard_deadline_ms = 0;
  options.acceleration_mm_s2 = NAN;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`acceleration_mm_s2`");
  options.acceleration_mm_s2 = 0.0;
  options.remainder = 3;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`remainder`");
  CHECK(robot == NULL);

  create.droop_left = 1.0;
  CHECK_FAILS(cargobay_sim_open(&create, &other), CARGOBAY_E_ARGUMENT, "`droop_left`");
  create.droop_left = 0.0;
  create.time = 2;
  CHECK_FAILS(cargobay_sim_open(&create, &other), CARGOBAY_E_ARGUMENT, "`time`");
  create.time = CARGOBAY_SIM_VIRTUAL;
  create.link = "/tmp/none";
  CHECK_FAILS(cargobay_sim_open(&create, &other), CARGOBAY_E_ARGUMENT, "no pseudo-terminal");
  CHECK_FAILS(cargobay_sim_open(NULL, NULL), CARGOBAY_E_ARGUMENT, "`sim` is NULL");
  CHECK_FAILS(cargobay_sim_inject(sim, "dance", text, sizeof text), CARGOBAY_E_ARGUMENT, "dance");
  CHECK_FAILS(cargobay_sim_inject(sim, NULL, NULL, 0), CARGOBAY_E_ARGUMENT, "`line`");
  CHECK_FAILS(cargobay_sim_truth(sim, NULL), CARGOBAY_E_ARGUMENT, "NULL");
  CHECK_FAILS(cargobay_sim_advance(sim, -1), CARGOBAY_E_ARGUMENT, "negative");
  CHECK_FAILS(cargobay_sim_path(sim, NULL, 0), CARGOBAY_E_ARGUMENT, "`path`");

  robot = robot_of(sim, 0);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_drive_wheels(robot, 501.0, 0.0), CARGOBAY_E_ARGUMENT, "500 mm/s");
  CHECK_FAILS(cargobay_drive(robot, NAN, 0.0), CARGOBAY_E_ARGUMENT, "not a number");
  CHECK_FAILS(cargobay_drive_radius(robot, 100.0, NAN), CARGOBAY_E_ARGUMENT, "INFINITY");
  CHECK_FAILS(cargobay_drive_radius(robot, 400.0, 50.0), CARGOBAY_E_ARGUMENT, "500 mm/s");
  CHECK_FAILS(cargobay_query(robot, 6, 0, &value), CARGOBAY_E_ARGUMENT, "7 to 42");
  CHECK_FAILS(cargobay_query(robot, 19, 0, &value), CARGOBAY_E_ARGUMENT, "odometry");
  CHECK_FAILS(cargobay_query(robot, 27, 0, NULL), CARGOBAY_E_ARGUMENT, "`value`");
  CHECK_FAILS(cargobay_subscribe(robot, 8), CARGOBAY_E_ARGUMENT, "`extras`");
  CHECK_FAILS(cargobay_leds(robot, 1, 0, 0), CARGOBAY_E_ARGUMENT, "`leds`");
  CHECK_FAILS(cargobay_digital_outputs(robot, 8), CARGOBAY_E_ARGUMENT, "`outputs`");
  CHECK_FAILS(cargobay_low_side_drivers(robot, 8), CARGOBAY_E_ARGUMENT, "`drivers`");
  CHECK_FAILS(cargobay_pwm_low_side_drivers(robot, 129, 0, 0), CARGOBAY_E_ARGUMENT, "range");
  CHECK_FAILS(cargobay_song(robot, 0, NULL, 1), CARGOBAY_E_ARGUMENT, "`notes`");
  {
    const struct cargobay_note note = {60, 16};
    CHECK_FAILS(cargobay_song(robot, 16, &note, 1), CARGOBAY_E_ARGUMENT, "`slot`");
    CHECK_FAILS(cargobay_song(robot, 0, &note, 17), CARGOBAY_E_ARGUMENT, "cargobay_tune");
    CHECK_FAILS(cargobay_song(robot, 0, &note, 0), CARGOBAY_E_ARGUMENT, "1 to 16");
  }
  CHECK_FAILS(cargobay_play_song(robot, 16), CARGOBAY_E_ARGUMENT, "range");
  CHECK_FAILS(cargobay_tune(robot, 0, "no tune", NULL), CARGOBAY_E_ARGUMENT, "column");
  CHECK_FAILS(cargobay_tune(robot, 0, NULL, NULL), CARGOBAY_E_ARGUMENT, "`rtttl`");
  CHECK_FAILS(cargobay_script(robot, "dance", 0), CARGOBAY_E_ARGUMENT, "dance");
  CHECK_FAILS(cargobay_script(robot, "leds none 0 0", 2), CARGOBAY_E_ARGUMENT, "`how`");
  CHECK_FAILS(cargobay_command(robot, "drive 100 straight", 0), CARGOBAY_E_ARGUMENT,
              "for the loop");
  CHECK_FAILS(cargobay_command(robot, "passive", 0), CARGOBAY_E_ARGUMENT, "passive");
  CHECK_FAILS(cargobay_command(robot, "start", 0), CARGOBAY_E_ARGUMENT, "for the loop");
  CHECK_FAILS(cargobay_command(robot, "", 0), CARGOBAY_E_ARGUMENT, "no command");
  CHECK_FAILS(cargobay_raw(robot, (const uint8_t*)"\x8b\x00", 2, 0), CARGOBAY_E_ARGUMENT, "whole");
  CHECK_FAILS(cargobay_raw(robot, NULL, 2, 0), CARGOBAY_E_ARGUMENT, "`bytes`");
  CHECK_FAILS(cargobay_expect_silence(robot, -1), CARGOBAY_E_ARGUMENT, "negative");
  CHECK_FAILS(cargobay_play_script(robot, -1), CARGOBAY_E_ARGUMENT, "negative");
  CHECK_FAILS(cargobay_get_state(robot, NULL), CARGOBAY_E_ARGUMENT, "NULL");
  CHECK_FAILS(cargobay_get_sensors(robot, NULL), CARGOBAY_E_ARGUMENT, "NULL");
  CHECK_FAILS(cargobay_get_statistics(robot, NULL), CARGOBAY_E_ARGUMENT, "NULL");
  CHECK_FAILS(cargobay_get_bring_up(robot, NULL), CARGOBAY_E_ARGUMENT, "NULL");
  CHECK_FAILS(cargobay_next_event(robot, NULL), CARGOBAY_E_ARGUMENT, "NULL");
  event.kind = 99;
  CHECK_FAILS(cargobay_describe_event(&event, text, sizeof text), CARGOBAY_E_ARGUMENT, "no event");
  CHECK_FAILS(cargobay_describe_event(NULL, text, sizeof text), CARGOBAY_E_ARGUMENT, "`event`");
  CHECK_FAILS(cargobay_describe_event(&event, NULL, 0), CARGOBAY_E_ARGUMENT, "`text`");
  CHECK_FAILS(cargobay_histogram_open(NULL), CARGOBAY_E_ARGUMENT, "`histogram`");
  CHECK(cargobay_histogram_open(&histogram) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_histogram_get(histogram, NULL), CARGOBAY_E_ARGUMENT, "NULL");
  CHECK_FAILS(cargobay_histogram_percentile(histogram, 101.0, &time_ns), CARGOBAY_E_ARGUMENT,
              "0 to 100");
  CHECK_FAILS(cargobay_histogram_percentile(histogram, 50.0, NULL), CARGOBAY_E_ARGUMENT,
              "`time_ns`");
  CHECK_FAILS(cargobay_copy_histogram(robot, 2, histogram), CARGOBAY_E_ARGUMENT, "`measure`");
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_histogram_close(histogram), CARGOBAY_E_HANDLE, "closed");
  CHECK_FAILS(cargobay_histogram_record(histogram, 1), CARGOBAY_E_HANDLE, "closed");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void refuses_a_wrong_order(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* second = NULL;
  struct cargobay_robot* robot = robot_of(sim, 0);
  struct cargobay_histogram* histogram = NULL;
  char path[64];
  int32_t value = 0;
  SIZED(cargobay_options, options);
  SIZED(cargobay_state, state);
  SIZED(cargobay_statistics, statistics);
  options.flags = CARGOBAY_NO_CONFIG;
  options.sim = sim;
  CHECK_FAILS(cargobay_open(&options, &second), CARGOBAY_E_STATE, "another robot");
  CHECK_FAILS(cargobay_sim_close(sim), CARGOBAY_E_STATE, "close it first");
  CHECK_FAILS(cargobay_sim_advance(sim, 1), CARGOBAY_E_STATE, "cargobay_wait");
  CHECK_FAILS(cargobay_sim_path(sim, path, sizeof path), CARGOBAY_E_STATE, "virtual time");
  CHECK_FAILS(cargobay_get_state(robot, &state), CARGOBAY_E_TIMEOUT, "no frame");
  CHECK_FAILS(cargobay_wait(robot, 0, &state), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_stop(robot), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_drive(robot, 0.0, 0.0), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_rearm(robot), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_leds(robot, 0, 0, 0), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_subscribe(robot, 0), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_query(robot, 27, 0, &value), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_expect_silence(robot, 0), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_reset_odometry(robot, 0.0, 0.0, 0.0), CARGOBAY_E_STATE, "not started");
  CHECK_FAILS(cargobay_get_statistics(robot, &statistics), CARGOBAY_E_STATE, "not started");
  CHECK(cargobay_histogram_open(&histogram) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_copy_histogram(robot, 0, histogram), CARGOBAY_E_STATE, "not started");
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_start(robot), CARGOBAY_E_STATE, "started before");
  CHECK_FAILS(cargobay_set_control(robot, NULL, NULL), CARGOBAY_E_STATE, "already started");
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "fault stalled-stream 300", NULL, 0) >= 0);
  CHECK_FAILS(cargobay_wait(robot, SECONDS(0.1), &state), CARGOBAY_E_TIMEOUT, "in time");
  CHECK(run_for(robot, 0.5) == CARGOBAY_OK);
  CHECK(cargobay_stop(robot) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_wait(robot, 0, &state), CARGOBAY_E_STATE, "has ended");
  CHECK_FAILS(cargobay_drive(robot, 0.0, 0.0), CARGOBAY_E_STATE, "has ended");
  CHECK_FAILS(cargobay_start(robot), CARGOBAY_E_STATE, "started before");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  every_robot_function_refuses(robot, "this robot is closed");
  every_robot_function_refuses(NULL, "this robot is NULL");
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  every_sim_function_refuses(sim, "this virtual Create is closed");
  every_sim_function_refuses(NULL, "this virtual Create is NULL");
  CHECK_FAILS(cargobay_open(&options, &second), CARGOBAY_E_HANDLE, "virtual Create is closed");
}

/* What the world does to a drive. */
static void ends_by_what_happens(const char* injected, int code, const char* words) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, injected, NULL, 0) >= 0);
  CHECK_FAILS(run_for(robot, 5.0), code, words);
  CHECK_FAILS(cargobay_stop(robot), code, words);
  CHECK(cargobay_sim_truth(sim, &truth) == CARGOBAY_OK && truth.left_mm_s == 0.0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void refuses_what_is_not_there(void) {
  struct cargobay_robot* robot = NULL;
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_options, options);
  SIZED(cargobay_sim_options, create);
  options.flags = CARGOBAY_NO_CONFIG;
  options.port = "/dev/no-such-port";
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_PORT, "/dev/no-such-port");
  options.flags = 0;
  options.config = "/no/such/cargobay.toml";
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_CONFIG, "/no/such/cargobay.toml");
  CHECK(robot == NULL);
  create.world = "/no/such.world";
  CHECK_FAILS(cargobay_sim_open(&create, &sim), CARGOBAY_E_CONFIG, "/no/such.world");
  create.world = NULL;
  create.link = "/no/such/folder/link";
  CHECK_FAILS(cargobay_sim_open(&create, &sim), CARGOBAY_E_SYSTEM, "/no/such/folder");
  CHECK(sim == NULL);

  /* A robot that is not there, at a port that is. */
  create.link = NULL;
  create.time = CARGOBAY_SIM_VIRTUAL;
  CHECK(cargobay_sim_open(&create, &sim) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "fault unplugged", NULL, 0) >= 0);
  options.config = NULL;
  options.flags = CARGOBAY_NO_CONFIG;
  options.port = NULL;
  options.sim = sim;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ROBOT, "");
  CHECK(robot == NULL);
  CHECK(cargobay_sim_inject(sim, "fault replugged", NULL, 0) >= 0);
  options.record = "/no/such/folder/file";
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_SYSTEM, "/no/such/folder/file");
  CHECK(robot == NULL);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

struct from_control {
  struct cargobay_robot* robot;
  int calls;
};

static void misuses(void* context, const struct cargobay_state* state,
                    struct cargobay_wheels* wheels) {
  struct from_control* self = context;
  int32_t value;
  (void)state;
  wheels->left_mm_s = 100.0;
  ++self->calls;
  CHECK_FAILS(cargobay_close(self->robot), CARGOBAY_E_STATE, "control function");
  CHECK_FAILS(cargobay_stop(self->robot), CARGOBAY_E_STATE, "control function");
  CHECK_FAILS(cargobay_start(self->robot), CARGOBAY_E_STATE, "control function");
  CHECK_FAILS(cargobay_set_control(self->robot, NULL, NULL), CARGOBAY_E_STATE, "control function");
  CHECK_FAILS(cargobay_wait(self->robot, 0, NULL), CARGOBAY_E_STATE, "control function");
  CHECK_FAILS(cargobay_query(self->robot, 27, 0, &value), CARGOBAY_E_STATE, "control function");
  CHECK_FAILS(cargobay_open(NULL, &self->robot), CARGOBAY_E_STATE, "control function");
}

static void answers_misuse_in_the_control_function(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct from_control self = {robot_of(sim, 0), 0};
  struct cargobay_robot* robot = self.robot;
  CHECK(cargobay_set_control(robot, misuses, &self) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(cargobay_wait(robot, SECONDS(1), NULL) == CARGOBAY_OK);
  CHECK(self.calls == 1 && self.robot == NULL);
  self.robot = robot;
  CHECK(cargobay_stop(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* A control function that asks for the impossible makes the wheels stop. */
static void asks_for_too_much(void* context, const struct cargobay_state* state,
                              struct cargobay_wheels* wheels) {
  (void)context;
  (void)state;
  wheels->left_mm_s = NAN;
  wheels->right_mm_s = 1e9;
}

static void counts_refused_controls(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  SIZED(cargobay_statistics, counted);
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_set_control(robot, asks_for_too_much, NULL) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.5) == CARGOBAY_OK);
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK && counted.controls_refused > 20);
  CHECK(cargobay_sim_truth(sim, &truth) == CARGOBAY_OK && truth.commanded_left_mm_s == 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* A child has no robot: nothing that it does reaches the parent's. */
static void is_not_inherited(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  int status = 0;
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  const pid_t child = fork();
  CHECK(child >= 0);
  if (child == 0) {
    every_robot_function_refuses(robot, "this robot is closed");
    every_sim_function_refuses(sim, "this virtual Create is closed");
    /* But it may have its own. */
    struct cargobay_sim* own = virtual_sim();
    struct cargobay_robot* mine = robot_of(own, 0);
    CHECK(cargobay_start(mine) == CARGOBAY_OK && run_for(mine, 0.1) == CARGOBAY_OK);
    CHECK(cargobay_close(mine) == CARGOBAY_OK && cargobay_sim_close(own) == CARGOBAY_OK);
    _exit(0);
  }
  CHECK(waitpid(child, &status, 0) == child && status == 0);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_stop(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void* last_message(void* seen) {
  char** message = seen;
  *message = strdup(cargobay_error_message());
  return NULL;
}

static void names_errors(void) {
  char* message = NULL;
  pthread_t thread;
  for (int code = CARGOBAY_E_GUARD; code <= CARGOBAY_OK; ++code)
    CHECK(strcmp(cargobay_error_name(code), "CARGOBAY_E_?") != 0);
  CHECK(strcmp(cargobay_error_name(-99), "CARGOBAY_E_?") == 0);
  CHECK(strcmp(cargobay_error_name(CARGOBAY_E_RIGHTS), "CARGOBAY_E_RIGHTS") == 0);
  CHECK(cargobay_start(NULL) == CARGOBAY_E_HANDLE);
  /* Each thread has its own. */
  CHECK(pthread_create(&thread, NULL, last_message, &message) == 0);
  CHECK(pthread_join(thread, NULL) == 0);
  CHECK(strcmp(message, "") == 0 && strlen(cargobay_error_message()) > 0);
  free(message);
}

static void runs_out_of_handles(void) {
  struct cargobay_histogram* all[64];
  struct cargobay_histogram* more = NULL;
  for (int i = 0; i < 64; ++i) CHECK(cargobay_histogram_open(&all[i]) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_histogram_open(&more), CARGOBAY_E_SYSTEM, "64 histograms");
  for (int i = 0; i < 64; ++i) CHECK(cargobay_histogram_close(all[i]) == CARGOBAY_OK);
  CHECK(cargobay_histogram_open(&more) == CARGOBAY_OK && more != all[0]);
  CHECK(cargobay_histogram_close(more) == CARGOBAY_OK);
}

int main(void) {
  names_errors();
  refuses_arguments();
  refuses_a_wrong_order();
  refuses_what_is_not_there();
  ends_by_what_happens("wheeldrop left on", CARGOBAY_E_MODE, "the left wheel is off the floor");
  ends_by_what_happens("fault unplugged", CARGOBAY_E_ROBOT, "fell silent");
  answers_misuse_in_the_control_function();
  counts_refused_controls();
  is_not_inherited();
  runs_out_of_handles();
  return 0;
}
