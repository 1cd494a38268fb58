/* A16: wheels that nobody steers stand at once, however gentle the user's own limit is; standing
 * still and ending are two things; and a loop that starts again goes on where it
 * was. */
#include <math.h>
#include <stdbool.h>

#include "check.h"

static const double kTickS = 0.015;

struct drive {
  struct cargobay_sim* sim;
  struct cargobay_robot* robot;
};

static struct drive begin(double acceleration_mm_s2, double jerk_mm_s3) {
  struct drive drive = {virtual_sim(), NULL};
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = drive.sim;
  options.acceleration_mm_s2 = acceleration_mm_s2;
  options.jerk_mm_s3 = jerk_mm_s3;
  CHECK(cargobay_open(&options, &drive.robot) == CARGOBAY_OK);
  CHECK(cargobay_start(drive.robot) == CARGOBAY_OK);
  return drive;
}

static void finish(struct drive drive) {
  CHECK(cargobay_close(drive.robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(drive.sim) == CARGOBAY_OK);
}

static double truth_x_mm(const struct drive* drive) {
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_get_truth(drive->sim, &truth) == CARGOBAY_OK);
  return truth.x_mm;
}

/* Drives until the limited speed is this one. */
static void reach(const struct drive* drive, double speed_mm_s, struct cargobay_state* state) {
  do {
    CHECK(cargobay_drive_wheels(drive->robot, speed_mm_s, speed_mm_s) == CARGOBAY_OK);
    CHECK(next_state(drive->robot, state) == CARGOBAY_OK);
  } while (fabs(state->limited.left_mm_s - speed_mm_s) > 0.5);
}

/* Robot time from now until the limited speed of both wheels is 0. */
static double stopping_s(const struct drive* drive, struct cargobay_state* state) {
  const int64_t began = state->robot_time_ns;
  while (state->limited.left_mm_s != 0.0 || state->limited.right_mm_s != 0.0) {
    CHECK(next_state(drive->robot, state) == CARGOBAY_OK);
    CHECK(state->robot_time_ns - began < SECONDS(60));
  }
  return 1e-9 * (double)(state->robot_time_ns - began);
}

enum way { kLapse, kStop, kRefusedControl };

static int asks_for_too_much(void* context, const struct cargobay_state* state,
                             struct cargobay_output* output) {
  (void)context;
  (void)state;
  output->wheels.left_mm_s = NAN;
  output->wheels.right_mm_s = 1e9;
  return 0;
}

/* From that speed, with those limits of the user's, the stop takes no longer than the ticks that
 * are under way. */
static void stops(enum way way, double speed_mm_s, double acceleration_mm_s2, double jerk_mm_s3) {
  const struct drive drive = begin(acceleration_mm_s2, jerk_mm_s3);
  UNSEEN(state);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  reach(&drive, speed_mm_s, &state);
  if (way == kStop) CHECK(cargobay_stop(drive.robot) == CARGOBAY_OK);
  if (way == kRefusedControl)
    CHECK(cargobay_set_control(drive.robot, asks_for_too_much, NULL) == CARGOBAY_OK);
  while (way == kLapse && state.setpoint_lapsed == 0)
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  const double x_mm = truth_x_mm(&drive);
  CHECK(stopping_s(&drive, &state) <= 3.0 * kTickS);
  CHECK(run_for(drive.robot, 1.0) == CARGOBAY_OK);
  /* The wheels lag by 0.1 s. */
  CHECK(truth_x_mm(&drive) - x_mm < speed_mm_s * 0.2);
  finish(drive);
}

static void stops_at_once(void) {
  stops(kLapse, 500.0, 20.0, 0.0);
  stops(kStop, 500.0, 20.0, 0.0);
  stops(kRefusedControl, 500.0, 20.0, 0.0);
  stops(kLapse, 200.0, 20.0, 50.0);
  stops(kStop, 200.0, 1000.0, 100.0);
}

/* Steered: the user's limit counts. */
static void slows_down_gently_when_asked(void) {
  const struct drive drive = begin(20.0, 0.0);
  UNSEEN(state);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  reach(&drive, 100.0, &state);
  const int64_t began = state.robot_time_ns;
  while (state.limited.left_mm_s > 0.0) {
    CHECK(cargobay_drive_wheels(drive.robot, 0.0, 0.0) == CARGOBAY_OK);
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  }
  CHECK(fabs(1e-9 * (double)(state.robot_time_ns - began) - 5.0) <= 3.0 * kTickS);
  finish(drive);
}

static int turns(void* context, const struct cargobay_state* state,
                 struct cargobay_output* output) {
  (void)state;
  ++*(int*)context;
  output->wheels.left_mm_s = -100.0;
  output->wheels.right_mm_s = 100.0;
  return 0;
}

/* The loop goes on, and the next setpoint drives; a control function is gone. */
static void stands_still(void) {
  const struct drive drive = begin(0.0, 0.0);
  int calls = 0;
  UNSEEN(state);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_set_control(drive.robot, turns, &calls) == CARGOBAY_OK);
  CHECK(run_for(drive.robot, 0.5) == CARGOBAY_OK && calls > 30);
  CHECK(cargobay_stop(drive.robot) == CARGOBAY_OK);
  CHECK(run_for(drive.robot, 0.05) == CARGOBAY_OK);
  const int last = calls;
  CHECK(run_for(drive.robot, 1.0) == CARGOBAY_OK && calls == last);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.mode == CARGOBAY_MODE_SAFE && state.command.left_mm_s == 0.0);
  CHECK(cargobay_stop(drive.robot) == CARGOBAY_OK); /* as often as one likes */
  for (int i = 0; i < 40; ++i) {
    CHECK(cargobay_drive_wheels(drive.robot, 150.0, 150.0) == CARGOBAY_OK);
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  }
  CHECK(state.limited.left_mm_s == 150.0 && calls == last);
  CHECK(cargobay_stop(drive.robot) == CARGOBAY_OK);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.limited.left_mm_s < 150.0); /* at once, and not after the lapse */
  CHECK(cargobay_end(drive.robot) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_stop(drive.robot), CARGOBAY_E_STATE, "ended");
  finish(drive);
}

/* A refused setpoint leaves the one before, until that lapses. */
static void refusing_leaves_the_setpoint(void) {
  const struct drive drive = begin(0.0, 0.0);
  UNSEEN(state);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_drive_wheels(drive.robot, 100.0, 90.0) == CARGOBAY_OK);
  for (int i = 0; i < 20; ++i) {
    CHECK(cargobay_drive_wheels(drive.robot, 501.0, 0.0) == CARGOBAY_E_ARGUMENT);
    CHECK(cargobay_drive(drive.robot, 0.0, NAN) == CARGOBAY_E_ARGUMENT);
    CHECK(cargobay_drive_radius(drive.robot, 1.0, NAN) == CARGOBAY_E_ARGUMENT);
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
    CHECK(state.target.left_mm_s == 100.0 && state.target.right_mm_s == 90.0);
  }
  for (int i = 0; i < 20; ++i) { /* they did not renew it either */
    CHECK(cargobay_drive_wheels(drive.robot, 501.0, 0.0) == CARGOBAY_E_ARGUMENT);
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  }
  CHECK(state.setpoint_lapsed == 1 && state.target.left_mm_s == 0.0);
  finish(drive);
}

struct place {
  struct cargobay_state state;
  int64_t events;
};

static struct place place_of(struct cargobay_robot* robot) {
  struct place place;
  SIZED(cargobay_statistics, counted);
  memset(&place, 0, sizeof place);
  place.state.size = sizeof place.state;
  CHECK(cargobay_get_state(robot, &place.state) == CARGOBAY_OK);
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK);
  place.events = (int64_t)counted.events;
  return place;
}

/* Ticks, odometry, events and subscriptions of the drive before continue. */
static void goes_on_where_it_was(struct drive drive, struct cargobay_state* last) {
  const uint32_t subscribed = CARGOBAY_PACKET_WALL_SIGNAL;
  const struct place before = place_of(drive.robot);
  struct cargobay_reading reading;
  SIZED(cargobay_event, event);
  SIZED(cargobay_end_report, end);
  CHECK(cargobay_start(drive.robot) == CARGOBAY_OK);
  CHECK(cargobay_get_end(drive.robot, &end) == CARGOBAY_OK && end.ended == 0);
  *last = before.state;
  CHECK(next_state(drive.robot, last) == CARGOBAY_OK);
  CHECK(last->tick > before.state.tick && last->elapsed_ns == 0);
  CHECK(last->robot_time_ns == last->tick * 15000000);
  CHECK(last->mode == CARGOBAY_MODE_SAFE);
  CHECK(fabs(last->x_mm - before.state.x_mm) < 20.0);
  CHECK(fabs(last->heading_rad - before.state.heading_rad) < 0.1);
  reach(&drive, 150.0, last);
  CHECK(last->distance_mm > before.state.distance_mm);
  CHECK(cargobay_sim_inject(drive.sim, "bump right", NULL, 0) >= 0);
  CHECK(run_for(drive.robot, 1.0) == CARGOBAY_OK);
  CHECK(cargobay_next_event(drive.robot, before.events, &event) == 1);
  CHECK(event.sequence == before.events + 1 && event.tick > before.state.tick);
  CHECK(cargobay_sim_inject(drive.sim, "bump none", NULL, 0) >= 0);
  CHECK(run_for(drive.robot, 1.0) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, last) == CARGOBAY_OK);
  CHECK(cargobay_get_readings(drive.robot, &subscribed, 1, &reading) == CARGOBAY_OK);
  CHECK(reading.tick > last->tick - 60);
}

static void starts_again(void) {
  const uint32_t subscribed = CARGOBAY_PACKET_WALL_SIGNAL;
  const struct drive drive = begin(0.0, 0.0);
  UNSEEN(state);
  SIZED(cargobay_truth, truth);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_subscribe(drive.robot, &subscribed, 1) == CARGOBAY_OK);
  for (int i = 0; i < 100; ++i) {
    CHECK(cargobay_drive(drive.robot, 200.0, 0.3) == CARGOBAY_OK);
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  }
  CHECK(cargobay_end(drive.robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_get_truth(drive.sim, &truth) == CARGOBAY_OK);
  CHECK(truth.mode == CARGOBAY_MODE_PASSIVE);
  goes_on_where_it_was(drive, &state);

  /* It ended by itself: put right, it starts again all the same. */
  CHECK(cargobay_sim_inject(drive.sim, "wheeldrop left on", NULL, 0) >= 0);
  CHECK(run_for(drive.robot, 1.0) == CARGOBAY_E_MODE);
  CHECK(cargobay_sim_inject(drive.sim, "wheeldrop left off", NULL, 0) >= 0);
  goes_on_where_it_was(drive, &state);

  /* The link was lost. */
  CHECK(cargobay_sim_inject(drive.sim, "fault stalled-stream 4000", NULL, 0) >= 0);
  CHECK(run_for(drive.robot, 5.0) == CARGOBAY_E_SILENT);
  goes_on_where_it_was(drive, &state);
  CHECK(cargobay_end(drive.robot) == CARGOBAY_OK);
  finish(drive);
}

/* A start that fails leaves it stopped, and it may be tried again. */
static void may_start_later(void) {
  const struct drive drive = begin(0.0, 0.0);
  UNSEEN(state);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_end(drive.robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(drive.sim, "fault unplugged", NULL, 0) >= 0);
  CHECK_FAILS(cargobay_start(drive.robot), CARGOBAY_E_SILENT, "");
  CHECK(cargobay_sim_inject(drive.sim, "fault replugged", NULL, 0) >= 0);
  const int64_t tick = state.tick;
  CHECK(cargobay_start(drive.robot) == CARGOBAY_OK);
  CHECK(next_state(drive.robot, &state) == CARGOBAY_OK && state.tick > tick);
  finish(drive);
}

int main(void) {
  stops_at_once();
  slows_down_gently_when_asked();
  stands_still();
  refusing_leaves_the_setpoint();
  starts_again();
  may_start_later();
  return 0;
}
