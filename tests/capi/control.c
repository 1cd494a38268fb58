/* A4: what a control function may ask for, how it ends the drive, and that it may be set, changed
 * and cleared while the loop runs. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "check.h"

static bool near(double value, double wanted) { return fabs(value - wanted) <= 0.01; }

/* Asks for the same each time. */
struct wish {
  struct cargobay_output output;
  int result; /* from tick `until` on; 0 before */
  int64_t until;
  int calls;
  int64_t elapsed_ns; /* the sum over all calls */
};

static int asks(void* context, const struct cargobay_state* state, struct cargobay_output* output) {
  struct wish* self = context;
  /* As long as the library's; a later header has longer ones. */
  CHECK(output->size >= offsetof(struct cargobay_output, twist) + sizeof output->twist);
  CHECK(output->kind == CARGOBAY_OUTPUT_WHEELS);
  CHECK(output->wheels.left_mm_s == 0.0 && output->wheels.right_mm_s == 0.0);
  CHECK(state->target.left_mm_s == 0.0 && state->limited.left_mm_s == 0.0);
  CHECK(state->command.right_mm_s == 0.0);
  CHECK(state->size >= offsetof(struct cargobay_state, battery_mv) + sizeof state->battery_mv);
  CHECK(state->mode == CARGOBAY_MODE_SAFE);
  ++self->calls;
  self->elapsed_ns += state->elapsed_ns;
  output->kind = self->output.kind;
  output->wheels = self->output.wheels;
  output->twist = self->output.twist;
  return state->tick >= self->until ? self->result : 0;
}

static struct wish wish_for(int kind, double first, double second) {
  struct wish wish;
  memset(&wish, 0, sizeof wish);
  wish.output.kind = kind;
  wish.output.wheels.left_mm_s = wish.output.twist.velocity_mm_s = first;
  wish.output.wheels.right_mm_s = wish.output.twist.turn_rate_rad_s = second;
  wish.until = INT64_MAX;
  return wish;
}

struct drive {
  struct cargobay_sim* sim;
  struct cargobay_robot* robot;
};

static struct drive begin(struct wish* wish) {
  struct drive drive = {virtual_sim(), NULL};
  drive.robot = robot_of(drive.sim, 0);
  if (wish != NULL) CHECK(cargobay_set_control(drive.robot, asks, wish) == CARGOBAY_OK);
  CHECK(cargobay_start(drive.robot) == CARGOBAY_OK);
  return drive;
}

static void finish(struct drive drive) {
  CHECK(cargobay_close(drive.robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(drive.sim) == CARGOBAY_OK);
}

/* The target that comes of it, and how many results were refused. */
static struct cargobay_wheels target_of(struct wish wish, uint64_t* refused) {
  const struct drive drive = begin(&wish);
  SIZED(cargobay_state, state);
  SIZED(cargobay_statistics, counted);
  CHECK(run_for(drive.robot, 1.0) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_get_statistics(drive.robot, &counted) == CARGOBAY_OK);
  CHECK(wish.calls > 60);
  *refused = counted.controls_refused;
  finish(drive);
  return state.target;
}

static void may_ask_for(int kind, double first, double second, double left, double right) {
  uint64_t refused = 0;
  const struct cargobay_wheels target = target_of(wish_for(kind, first, second), &refused);
  if (near(target.left_mm_s, left) && near(target.right_mm_s, right) && refused == 0) return;
  fprintf(stderr, "kind %d with %g, %g: target %g, %g, refused %d times\n", kind, first, second,
          target.left_mm_s, target.right_mm_s, (int)refused);
  exit(1);
}

static void may_not_ask_for(int kind, double first, double second) {
  uint64_t refused = 0;
  const struct cargobay_wheels target = target_of(wish_for(kind, first, second), &refused);
  CHECK(target.left_mm_s == 0.0 && target.right_mm_s == 0.0 && refused > 60);
}

static void asks_for_speeds(void) {
  may_ask_for(CARGOBAY_OUTPUT_WHEELS, 100.0, -150.0, 100.0, -150.0);
  may_ask_for(CARGOBAY_OUTPUT_WHEELS, 500.0, 500.0, 500.0, 500.0);
  may_ask_for(CARGOBAY_OUTPUT_TWIST, 200.0, 1.0, 71.0, 329.0);
  may_ask_for(CARGOBAY_OUTPUT_TWIST, 500.0, 0.0, 500.0, 500.0);
  /* 450 mm/s with 0.5 rad/s would be 385.5 and 514.5: scaled down together. */
  may_ask_for(CARGOBAY_OUTPUT_TWIST, 450.0, 0.5, 385.5 * 500.0 / 514.5, 500.0);
  may_ask_for(CARGOBAY_OUTPUT_TWIST, -450.0, 0.5, -500.0, -385.5 * 500.0 / 514.5);
  may_ask_for(CARGOBAY_OUTPUT_TWIST, 1e6, 0.0, 500.0, 500.0);
  may_ask_for(CARGOBAY_OUTPUT_TWIST, 0.0, -1e6, 500.0, -500.0);
  may_not_ask_for(CARGOBAY_OUTPUT_WHEELS, 500.5, 0.0);
  may_not_ask_for(CARGOBAY_OUTPUT_WHEELS, 0.0, NAN);
  may_not_ask_for(CARGOBAY_OUTPUT_TWIST, NAN, 0.0);
  may_not_ask_for(CARGOBAY_OUTPUT_TWIST, 0.0, INFINITY);
  may_not_ask_for(3, 100.0, 100.0);
  may_not_ask_for(-1, 100.0, 100.0);
}

/* The same twist as a setpoint: a straight line at 500 mm/s with a turn. */
static void setpoints_are_scaled_too(void) {
  const struct drive drive = begin(NULL);
  UNSEEN(state);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_drive(drive.robot, 450.0, 0.5) == CARGOBAY_OK);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(near(state.target.left_mm_s, 385.5 * 500.0 / 514.5));
  CHECK(near(state.target.right_mm_s, 500.0));
  CHECK(cargobay_drive_radius(drive.robot, 500.0, 258.0) == CARGOBAY_OK); /* 250 and 750 */
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(near(state.target.left_mm_s, 500.0 / 3.0) && near(state.target.right_mm_s, 500.0));
  CHECK(cargobay_drive_radius(drive.robot, 700.0, INFINITY) == CARGOBAY_OK);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(near(state.target.left_mm_s, 500.0) && near(state.target.right_mm_s, 500.0));
  finish(drive);
}

/* It may leave the speeds to the setpoint, which lapses as ever. */
static void leaves_it_to_the_setpoint(void) {
  struct wish wish = wish_for(CARGOBAY_OUTPUT_SETPOINT, 0.0, 0.0);
  const struct drive drive = begin(&wish);
  UNSEEN(state);
  for (int i = 0; i < 60; ++i) {
    CHECK(cargobay_drive_wheels(drive.robot, 120.0, 80.0) == CARGOBAY_OK);
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  }
  CHECK(state.target.left_mm_s == 120.0 && state.target.right_mm_s == 80.0);
  CHECK(wish.calls > 55 && state.setpoint_lapsed == 0);
  CHECK(run_for(drive.robot, 1.2) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.setpoint_lapsed == 1 && state.limited.left_mm_s == 0.0);
  wish.output.kind = CARGOBAY_OUTPUT_WHEELS; /* and it may change its mind */
  wish.output.wheels.left_mm_s = 50.0;
  CHECK(run_for(drive.robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.target.left_mm_s == 50.0);
  finish(drive);
}

/* 1 is the end that it was asked for; a negative number is a failure, and is kept. */
static void ends_the_drive(int result) {
  const int code = result < 0 ? CARGOBAY_E_CONTROL : CARGOBAY_OK;
  struct wish wish = wish_for(CARGOBAY_OUTPUT_WHEELS, 200.0, 200.0);
  wish.result = result;
  wish.until = 100;
  const struct drive drive = begin(&wish);
  SIZED(cargobay_end_report, end);
  SIZED(cargobay_truth, truth);
  const int waited = run_for(drive.robot, 10.0);
  CHECK(waited == (result < 0 ? CARGOBAY_E_CONTROL : CARGOBAY_ENDED));
  CHECK(wish.calls <= 101);
  CHECK(cargobay_get_end(drive.robot, &end) == CARGOBAY_OK);
  CHECK(end.ended == 1 && end.code == code && end.control_result == result);
  CHECK((strlen(end.message) > 0) == (result < 0));
  CHECK(cargobay_end(drive.robot) == code);
  CHECK(cargobay_sim_get_truth(drive.sim, &truth) == CARGOBAY_OK);
  CHECK(truth.mode == CARGOBAY_MODE_PASSIVE && truth.commanded_left_mm_s == 0);
  CHECK(cargobay_get_end(drive.robot, &end) == CARGOBAY_OK && end.passive_seen == 1);
  finish(drive);
}

/* From teleoperation to a controller, to another, and back, in one drive. */
static void changes_while_driving(void) {
  struct wish one = wish_for(CARGOBAY_OUTPUT_WHEELS, 60.0, 60.0);
  struct wish two = wish_for(CARGOBAY_OUTPUT_WHEELS, 90.0, 90.0);
  const struct drive drive = begin(NULL);
  UNSEEN(state);
  CHECK(run_for(drive.robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_drive_wheels(drive.robot, 30.0, 30.0) == CARGOBAY_OK);
  CHECK(run_for(drive.robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_set_control(drive.robot, asks, &one) == CARGOBAY_OK);
  CHECK(run_for(drive.robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.target.left_mm_s == 60.0 && one.calls > 4);
  CHECK(cargobay_drive_wheels(drive.robot, 40.0, 40.0) == CARGOBAY_OK); /* does not count yet */
  CHECK(cargobay_set_control(drive.robot, asks, &two) == CARGOBAY_OK);
  const int calls = one.calls;
  CHECK(run_for(drive.robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.target.left_mm_s == 90.0 && one.calls == calls && two.calls > 4);
  CHECK(cargobay_set_control(drive.robot, NULL, NULL) == CARGOBAY_OK);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.target.left_mm_s == 40.0); /* the latest setpoint, which has not lapsed */
  CHECK(cargobay_set_control(drive.robot, NULL, NULL) == CARGOBAY_OK);
  const double x_mm = state.x_mm;
  CHECK(run_for(drive.robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK && state.x_mm > x_mm);
  finish(drive);
}

/* The time since the state before, also where frames are missing. */
static void knows_the_time_since(void) {
  struct wish wish = wish_for(CARGOBAY_OUTPUT_WHEELS, 0.0, 0.0);
  const struct drive drive = begin(&wish);
  UNSEEN(state);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK && state.elapsed_ns == 0);
  for (int i = 0; i < 20; ++i) {
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK && state.elapsed_ns == SECONDS(0.015));
  }
  CHECK(cargobay_sim_inject(drive.sim, "fault stalled-stream 300", NULL, 0) >= 0);
  bool gap = false;
  for (int i = 0; i < 30; ++i) {
    const int64_t before = state.robot_time_ns;
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
    CHECK(state.elapsed_ns == state.robot_time_ns - before);
    if (state.elapsed_ns > SECONDS(0.2)) gap = true;
  }
  CHECK(gap && wish.elapsed_ns == state.robot_time_ns);
  finish(drive);
}

/* ---- in real time ---- */

struct guest {
  atomic_int calls;
  atomic_bool gone; /* set_control() has returned */
};

static int is_called_only_while_set(void* context, const struct cargobay_state* state,
                                    struct cargobay_output* output) {
  struct guest* self = context;
  (void)state;
  (void)output;
  CHECK(!atomic_load(&self->gone));
  atomic_fetch_add(&self->calls, 1);
  return 0;
}

static void is_changed_under_the_loop(void) {
  struct cargobay_robot* robot = NULL;
  struct guest* guest = NULL;
  int calls = 0;
  UNSEEN(state);
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 300; ++i) {
    struct guest* const next = i % 3 == 2 ? NULL : calloc(1, sizeof *next);
    CHECK(cargobay_set_control(robot, next == NULL ? NULL : is_called_only_while_set, next) ==
          CARGOBAY_OK);
    if (guest != NULL) { /* nothing is in it any more */
      atomic_store(&guest->gone, true);
      calls += atomic_load(&guest->calls);
      free(guest);
    }
    guest = next;
    if (i % 10 < 3) CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(calls > 10);
  CHECK(cargobay_set_control(robot, NULL, NULL) == CARGOBAY_OK);
  free(guest);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

int main(void) {
  asks_for_speeds();
  setpoints_are_scaled_too();
  leaves_it_to_the_setpoint();
  ends_the_drive(1);
  ends_the_drive(-7);
  ends_the_drive(-1);
  changes_while_driving();
  knows_the_time_since();
  is_changed_under_the_loop();
  return 0;
}
