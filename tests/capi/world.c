/* Several virtual Creates in one world with one clock, in virtual time. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <unistd.h>

#include "several.h"

/* --- the world -------------------------------------------------------------------------------- */

static void start_in_places_of_their_own(void) {
  char file[] = "/tmp/cargobay-world-XXXXXX";
  static const char kWorld[] = "start 100 200 90\nstart 1000 2000 0\n";
  struct cargobay_sim* sims[kMost];
  const int descriptor = mkstemp(file);
  CHECK(descriptor >= 0 && write(descriptor, kWorld, sizeof kWorld - 1) > 0);
  CHECK(close(descriptor) == 0);
  SIZED(cargobay_sim_options, options);
  options.time = CARGOBAY_SIM_TIME_VIRTUAL;
  options.world = file;
  CHECK(cargobay_sim_open(&options, &sims[0]) == CARGOBAY_OK);
  CHECK(remove(file) == 0);
  /* One that comes later has been there since the beginning. */
  CHECK(cargobay_sim_advance(sims[0], SECONDS(20)) == CARGOBAY_OK);
  for (int i = 1; i < kMost; ++i) sims[i] = sim_beside(sims[i - 1]);
  static const double kPlaces[kMost][2] = {{100, 200}, {1000, 2000}, {1000, 2500}};
  for (int i = 0; i < kMost; ++i) {
    const struct cargobay_truth truth = truth_of(sims[i]);
    CHECK(truth.x_mm == kPlaces[i][0] && truth.y_mm == kPlaces[i][1]);
    CHECK(truth.sim_time_ns == SECONDS(20) && truth.mode == CARGOBAY_MODE_OFF);
  }
  /* A place that is free again is taken again. */
  CHECK(cargobay_sim_close(sims[1]) == CARGOBAY_OK);
  sims[1] = sim_beside(sims[0]);
  CHECK(truth_of(sims[1]).y_mm == 2000.0);
  close_all(NULL, sims, kMost);
}

/* The last of a kind. */
static bool has_event(struct cargobay_robot* robot, int kind, struct cargobay_event* found) {
  bool any = false;
  SIZED(cargobay_event, event);
  while (cargobay_next_event(robot, event.sequence, &event) == 1) {
    if (event.kind != kind) continue;
    *found = event;
    any = true;
  }
  return any;
}

static void meet(void) {
  struct cargobay_sim* sims[2];
  struct cargobay_robot* robots[2];
  struct cargobay_event bump;
  UNSEEN(state);
  sims[0] = sim_beside(NULL);
  sims[1] = sim_beside(sims[0]);
  put(sims[1], "place 800 -60 180");
  for (int i = 0; i < 2; ++i) {
    robots[i] = robot_of(sims[i], 0);
    CHECK(cargobay_start(robots[i]) == CARGOBAY_OK);
  }
  for (int i = 0; i < 300; ++i) {
    CHECK(cargobay_drive(robots[0], 250.0, 0.0) == CARGOBAY_OK);
    CHECK(next_state(robots[0], &state) == CARGOBAY_OK);
  }
  const struct cargobay_truth hit = truth_of(sims[0]);
  const struct cargobay_truth stood = truth_of(sims[1]);
  CHECK(fabs(stood.x_mm - 800.0) < 1e-6 && fabs(stood.y_mm + 60.0) < 1e-6);
  CHECK(fabs(hypot(hit.x_mm - stood.x_mm, hit.y_mm - stood.y_mm) - 330.0) < 10.0);
  CHECK(hit.left_mm_s > 200.0); /* its wheels slip */
  /* The one that stands is hit where it faces the other. */
  CHECK(has_event(robots[0], CARGOBAY_EVENT_BUMP_BEGAN, &bump) && bump.bumps != 0);
  CHECK(has_event(robots[1], CARGOBAY_EVENT_BUMP_BEGAN, &bump) && bump.bumps != 0);
  /* It goes on only when the other is gone. */
  CHECK(cargobay_sim_advance(sims[0], SECONDS(1)) == CARGOBAY_OK);
  CHECK(has_event(robots[1], CARGOBAY_EVENT_SETPOINT_LAPSED, &bump) == false);
  CHECK(has_event(robots[0], CARGOBAY_EVENT_SETPOINT_LAPSED, &bump));
  CHECK(cargobay_close(robots[1]) == CARGOBAY_OK && cargobay_sim_close(sims[1]) == CARGOBAY_OK);
  for (int i = 0; i < 100; ++i) {
    CHECK(cargobay_drive(robots[0], 250.0, 0.0) == CARGOBAY_OK);
    CHECK(next_state(robots[0], &state) == CARGOBAY_OK);
  }
  CHECK(truth_of(sims[0]).x_mm > hit.x_mm + 200.0 && state.bumps == 0);
  close_all(robots, sims, 1);
}

/* From behind there is no bumper; from the side it is the side. */
static void are_felt_where_they_are(void) {
  static const struct {
    const char* place;
    uint32_t bumps;
  } kCases[] = {{"place 331 0 0", CARGOBAY_BUMP_LEFT | CARGOBAY_BUMP_RIGHT},
                {"place 0 331 0", CARGOBAY_BUMP_LEFT},
                {"place 0 -331 0", CARGOBAY_BUMP_RIGHT},
                {"place -331 0 0", 0},
                {"place 340 0 0", 0}};
  for (size_t i = 0; i < sizeof kCases / sizeof kCases[0]; ++i) {
    struct cargobay_sim* sims[2];
    UNSEEN(state);
    sims[0] = sim_beside(NULL);
    sims[1] = sim_beside(sims[0]);
    put(sims[1], kCases[i].place);
    struct cargobay_robot* robot = robot_of(sims[0], 0);
    CHECK(cargobay_start(robot) == CARGOBAY_OK && run_for(robot, 0.2) == CARGOBAY_OK);
    CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK);
    if (state.bumps != kCases[i].bumps) fprintf(stderr, "%s: %u\n", kCases[i].place, state.bumps);
    CHECK(state.bumps == kCases[i].bumps);
    CHECK(cargobay_close(robot) == CARGOBAY_OK);
    close_all(NULL, sims, 2);
  }
}

/* Send IR is seen by those in sight. */
static int32_t seen_infrared(const char* place, const char* third) {
  const uint32_t packet = CARGOBAY_PACKET_INFRARED_BYTE;
  struct cargobay_reading reading;
  struct cargobay_sim* sims[kMost];
  struct cargobay_robot* robots[2];
  UNSEEN(state);
  for (int i = 0; i < kMost; ++i) sims[i] = sim_beside(i == 0 ? NULL : sims[0]);
  put(sims[1], place);
  put(sims[2], third);
  for (int i = 0; i < 2; ++i) {
    robots[i] = robot_of(sims[i], 0);
    CHECK(cargobay_start(robots[i]) == CARGOBAY_OK);
  }
  CHECK(run_for(robots[0], 0.3) == CARGOBAY_OK);
  CHECK(cargobay_send_ir(robots[0], 130) == CARGOBAY_OK);
  int32_t seen = 255;
  for (int i = 0; i < 20; ++i) {
    CHECK(next_state(robots[1], &state) == CARGOBAY_OK);
    CHECK(cargobay_get_readings(robots[1], &packet, 1, &reading) == CARGOBAY_OK);
    if (reading.value != 255) seen = reading.value;
  }
  CHECK(reading.value == 255); /* and not for ever */
  for (int i = 0; i < 2; ++i) CHECK(cargobay_close(robots[i]) == CARGOBAY_OK);
  close_all(NULL, sims, kMost);
  return seen;
}

static void see_each_others_infrared(void) {
  CHECK(seen_infrared("place 1000 0 0", "place 0 5000 0") == 130);
  CHECK(seen_infrared("place 1000 0 0", "place 500 0 0") == 255); /* one is in between */
  CHECK(seen_infrared("place 2500 0 0", "place 0 5000 0") == 255);
}

/* --- loops ------------------------------------------------------------------------------------ */

static int count_calls(void* context, const struct cargobay_state* state,
                       struct cargobay_output* output) {
  (void)state;
  (void)output;
  return ++*(int*)context == 200 ? 1 : 0;
}

/* While another robot is brought up, or left; and one may end while nobody waits for it. */
static void loops_go_on_meanwhile(void) {
  struct cargobay_sim* sims[2];
  struct cargobay_robot* robots[2];
  int calls = 0;
  SIZED(cargobay_end_report, end);
  UNSEEN(state);
  sims[0] = sim_beside(NULL);
  sims[1] = sim_beside(sims[0]);
  robots[0] = robot_of(sims[0], 0);
  CHECK(cargobay_set_control(robots[0], count_calls, &calls) == CARGOBAY_OK);
  CHECK(cargobay_start(robots[0]) == CARGOBAY_OK);
  robots[1] = robot_of(sims[1], 0);
  const int while_opening = calls;
  CHECK(while_opening > 5);
  /* Between open and start, frames pile up, as at a port. */
  CHECK(cargobay_sim_advance(sims[0], SECONDS(1)) == CARGOBAY_OK);
  CHECK(calls >= while_opening + 65);
  CHECK(cargobay_start(robots[1]) == CARGOBAY_OK);
  CHECK(run_for(robots[1], 0.3) == CARGOBAY_OK);
  const int before_the_end = calls;
  CHECK(cargobay_end(robots[1]) == CARGOBAY_OK && calls > before_the_end);
  CHECK(cargobay_start(robots[1]) == CARGOBAY_OK); /* again */
  CHECK(run_for(robots[1], 3.0) == CARGOBAY_OK);
  CHECK(calls == 200);
  CHECK(cargobay_get_end(robots[0], &end) == CARGOBAY_OK && end.ended == 1 && end.code == 0);
  CHECK(cargobay_get_state(robots[0], &state) == CARGOBAY_OK);
  CHECK(cargobay_wait(robots[0], state.tick, SECONDS(1), &state) == CARGOBAY_ENDED);
  CHECK(truth_of(sims[0]).commanded_left_mm_s == 0);
  close_all(robots, sims, 2);
}

/* A drive that runs while the program waits for another robot is recorded like any other. */
static void are_recorded(void) {
  char file[] = "/tmp/cargobay-world-XXXXXX";
  char command[300];
  const char* cargobay = getenv("CARGOBAY_COMMAND");
  struct cargobay_sim* sims[2];
  struct cargobay_robot* robots[2];
  const int descriptor = mkstemp(file);
  CHECK(descriptor >= 0 && close(descriptor) == 0);
  sims[0] = sim_beside(NULL);
  sims[1] = sim_beside(sims[0]);
  SIZED(cargobay_options, options);
  options.sim = sims[1];
  options.record = file;
  robots[0] = robot_of(sims[0], 0);
  CHECK(cargobay_open(&options, &robots[1]) == CARGOBAY_OK);
  for (int i = 0; i < 2; ++i) CHECK(cargobay_start(robots[i]) == CARGOBAY_OK);
  CHECK(cargobay_drive(robots[1], 200.0, 0.3) == CARGOBAY_OK);
  put(sims[1], "fault lost 0.01 both");
  CHECK(run_for(robots[0], 20.0) == CARGOBAY_OK);
  close_all(robots, sims, 2);
  CHECK(cargobay != NULL);
  snprintf(command, sizeof command, "%s replay %s > /dev/null", cargobay, file);
  CHECK(system(command) == 0); /* the same again, bit for bit */
  CHECK(remove(file) == 0);
}

/* --- what is refused -------------------------------------------------------------------------- */

static void refuse_what_makes_no_sense(void) {
  struct cargobay_sim* other = NULL;
  struct cargobay_sim* first = sim_beside(NULL);
  struct cargobay_sim* second = sim_beside(first);
  SIZED(cargobay_sim_options, options);
  options.beside = second;
  options.world = "/dev/null";
  CHECK_FAILS(cargobay_sim_open(&options, &other), CARGOBAY_E_ARGUMENT, "leave out `world`");
  options.world = NULL;
  options.time = CARGOBAY_SIM_TIME_VIRTUAL;
  CHECK_FAILS(cargobay_sim_open(&options, &other), CARGOBAY_E_ARGUMENT, "leave out `time`");
  options.time = 0;
  options.link = "/tmp/no-such-link";
  CHECK_FAILS(cargobay_sim_open(&options, &other), CARGOBAY_E_ARGUMENT, "no pseudo-terminal");
  options.link = NULL;
  for (int i = 0; i < 2; ++i) {
    options.reserved[i] = &options;
    CHECK_FAILS(cargobay_sim_open(&options, &other), CARGOBAY_E_ARGUMENT, "`reserved`");
    options.reserved[i] = NULL;
  }
  CHECK(other == NULL);
  CHECK_FAILS(cargobay_sim_close(first), CARGOBAY_E_STATE, "close them first");
  CHECK(cargobay_sim_close(second) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_sim_open(&options, &other), CARGOBAY_E_HANDLE, "closed");
  CHECK(cargobay_sim_close(first) == CARGOBAY_OK);
}

struct rivals {
  struct cargobay_robot* robot;
  struct cargobay_sim* sim;
  int asked;
};

/* The clock is moved by another thread. */
static void* wait_meanwhile(void* context) {
  const struct rivals* rivals = context;
  struct cargobay_robot* robot = NULL;
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_options, options);
  SIZED(cargobay_sim_options, beside);
  CHECK_FAILS(cargobay_wait(rivals->robot, -1, -1, NULL), CARGOBAY_E_THREAD, "another thread");
  CHECK_FAILS(cargobay_end(rivals->robot), CARGOBAY_E_THREAD, "another thread");
  CHECK_FAILS(cargobay_sim_advance(rivals->sim, 1), CARGOBAY_E_THREAD, "another thread");
  CHECK_FAILS(cargobay_sim_close(rivals->sim), CARGOBAY_E_THREAD, "another thread");
  options.sim = rivals->sim;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_THREAD, "another thread");
  beside.beside = rivals->sim;
  CHECK_FAILS(cargobay_sim_open(&beside, &sim), CARGOBAY_E_THREAD, "another thread");
  return NULL;
}
static int lets_another_wait(void* context, const struct cargobay_state* state,
                             struct cargobay_output* output) {
  struct rivals* rivals = context;
  pthread_t thread;
  (void)state;
  (void)output;
  if (rivals->asked++ != 0) return 0;
  CHECK(pthread_create(&thread, NULL, wait_meanwhile, rivals) == 0);
  CHECK(pthread_join(thread, NULL) == 0);
  return 0;
}

static void have_one_owner(void) {
  struct cargobay_sim* sims[kMost];
  struct cargobay_robot* robots[2];
  struct rivals rivals;
  for (int i = 0; i < kMost; ++i) sims[i] = sim_beside(i == 0 ? NULL : sims[0]);
  for (int i = 0; i < 2; ++i) robots[i] = robot_of(sims[i], 0);
  rivals.robot = robots[1];
  rivals.sim = sims[2];
  rivals.asked = 0;
  CHECK(cargobay_set_control(robots[0], lets_another_wait, &rivals) == CARGOBAY_OK);
  for (int i = 0; i < 2; ++i) CHECK(cargobay_start(robots[i]) == CARGOBAY_OK);
  CHECK(run_for(robots[0], 0.1) == CARGOBAY_OK && rivals.asked > 0);
  CHECK(run_for(robots[1], 0.1) == CARGOBAY_OK);
  for (int i = 0; i < 2; ++i) CHECK(cargobay_close(robots[i]) == CARGOBAY_OK);
  close_all(NULL, sims, kMost);
}

int main(void) {
  start_in_places_of_their_own();
  meet();
  are_felt_where_they_are();
  see_each_others_infrared();
  loops_go_on_meanwhile();
  are_recorded();
  refuse_what_makes_no_sense();
  have_one_owner();
  return 0;
}
