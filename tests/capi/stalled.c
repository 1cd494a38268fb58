/* A control function that does not return: every call still ends, and the robot stands still. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <time.h>
#include <unistd.h>

#include "check.h"

/* The header says 2 s; the machine may be busy. */
static const double kGenerousBoundS = 6.0;

static double now_s(void) {
  struct timespec now;
  CHECK(clock_gettime(CLOCK_MONOTONIC, &now) == 0);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

enum hang { kSleep, kSpin, kEndThread };

/* Not on the stack of a test: the loop may come back when that is gone. */
struct hung {
  atomic_bool let_go;
  atomic_bool inside;
  atomic_bool returned;
  enum hang how;
};

static int does_not_return(void* context, const struct cargobay_state* state,
                           struct cargobay_output* output) {
  struct hung* self = context;
  output->wheels.left_mm_s = output->wheels.right_mm_s = 200.0;
  if (state->tick < 30) return 0;
  atomic_store(&self->inside, true);
  if (self->how == kEndThread) pthread_exit(NULL);
  while (!atomic_load(&self->let_go)) {
    if (self->how == kSleep) usleep(1000);
  }
  atomic_store(&self->returned, true);
  return 0;
}

struct drive {
  struct cargobay_sim* sim;
  struct cargobay_robot* robot;
  struct hung* hung;
};

static struct drive begin(enum hang how, uint32_t flags, int64_t guard_deadline_ns) {
  struct drive drive;
  SIZED(cargobay_options, options);
  drive.hung = calloc(1, sizeof *drive.hung);
  CHECK(drive.hung != NULL);
  drive.hung->how = how;
  CHECK(cargobay_sim_open(NULL, &drive.sim) == CARGOBAY_OK);
  options.flags = CARGOBAY_FLAG_NO_CONFIG | flags;
  options.sim = drive.sim;
  options.priority = 10;
  options.guard_deadline_ns = guard_deadline_ns;
  CHECK(cargobay_open(&options, &drive.robot) == CARGOBAY_OK);
  CHECK(cargobay_set_control(drive.robot, does_not_return, drive.hung) == CARGOBAY_OK);
  CHECK(cargobay_start(drive.robot) == CARGOBAY_OK);
  return drive;
}

static void wait_until_inside(const struct drive* drive) {
  while (!atomic_load(&drive->hung->inside)) usleep(1000);
}

static void stands_in_passive(const struct drive* drive) {
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_get_truth(drive->sim, &truth) == CARGOBAY_OK);
  CHECK(truth.mode == CARGOBAY_MODE_PASSIVE);
  CHECK(truth.commanded_left_mm_s == 0 && truth.commanded_right_mm_s == 0);
}

/* The thread comes back late; what it touches still exists, and the robot does not move. */
static void let_go(const struct drive* drive) {
  atomic_store(&drive->hung->let_go, true);
  while (!atomic_load(&drive->hung->returned)) usleep(1000);
  usleep(200000);
  stands_in_passive(drive);
}

static int wait_for_the_end(struct cargobay_robot* robot, struct cargobay_state* state) {
  int error = CARGOBAY_OK;
  while (error == CARGOBAY_OK)
    error = cargobay_wait(robot, state->tick, SECONDS(kGenerousBoundS), state);
  return error;
}

#define ENDS_IN_TIME(call, code, words)         \
  do {                                          \
    const double began_s = now_s();             \
    CHECK_FAILS(call, code, words);             \
    CHECK(now_s() - began_s < kGenerousBoundS); \
  } while (0)

/* A waiting thread is told, with or without a guard; then all calls end. */
static void ends_every_call(enum hang how, uint32_t flags) {
  struct drive drive = begin(how, flags, 0);
  SIZED(cargobay_end_report, end);
  UNSEEN(state);
  ENDS_IN_TIME(wait_for_the_end(drive.robot, &state), CARGOBAY_E_STALLED, "");
  CHECK_FAILS(cargobay_wait(drive.robot, state.tick, 0, NULL), CARGOBAY_E_STALLED, "");
  ENDS_IN_TIME(cargobay_end(drive.robot), CARGOBAY_E_STALLED, "has not returned");
  stands_in_passive(&drive);
  CHECK_FAILS(cargobay_end(drive.robot), CARGOBAY_E_STALLED, "has not returned");
  CHECK(cargobay_get_end(drive.robot, &end) == CARGOBAY_OK);
  CHECK(end.ended == 1 && end.code == CARGOBAY_E_STALLED && strlen(end.message) > 20);
  ENDS_IN_TIME(cargobay_close(drive.robot), CARGOBAY_E_STALLED, "end the program");
  CHECK_FAILS(cargobay_close(drive.robot), CARGOBAY_E_HANDLE, "closed");
  if (how != kEndThread) let_go(&drive);
  CHECK(cargobay_sim_close(drive.sim) == CARGOBAY_OK);
}

/* A late guard: the owner's own stop does not wait for it. */
static void does_not_wait_for_a_slow_guard(void) {
  struct drive drive = begin(kSleep, 0, SECONDS(10));
  wait_until_inside(&drive);
  ENDS_IN_TIME(cargobay_end(drive.robot), CARGOBAY_E_STALLED, "has not returned");
  stands_in_passive(&drive);
  CHECK(cargobay_close(drive.robot) == CARGOBAY_E_STALLED);
  let_go(&drive);
  CHECK(cargobay_sim_close(drive.sim) == CARGOBAY_OK);
}

/* A thread that does come back leaves nothing behind. */
static void frees_what_came_back(void) {
  struct drive drive = begin(kSleep, CARGOBAY_FLAG_NO_GUARD, 0);
  wait_until_inside(&drive);
  CHECK_FAILS(cargobay_end(drive.robot), CARGOBAY_E_STALLED, "has not returned");
  let_go(&drive);
  CHECK(cargobay_close(drive.robot) == CARGOBAY_OK);
  struct cargobay_robot* robot = robot_of(drive.sim, 0); /* its port is free again */
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(drive.sim) == CARGOBAY_OK);
  free(drive.hung);
}

/* Changing it says so too; it is not called again, but its context stays. */
static void is_not_waited_for_when_changed(void) {
  struct drive drive = begin(kSleep, CARGOBAY_FLAG_NO_GUARD, SECONDS(0.15));
  wait_until_inside(&drive);
  ENDS_IN_TIME(cargobay_set_control(drive.robot, NULL, NULL), CARGOBAY_E_STALLED, "not returned");
  atomic_store(&drive.hung->inside, false);
  atomic_store(&drive.hung->let_go, true);
  while (!atomic_load(&drive.hung->returned)) usleep(1000);
  (void)cargobay_end(drive.robot);
  CHECK(!atomic_load(&drive.hung->inside));
  CHECK(cargobay_close(drive.robot) == CARGOBAY_OK);
  stands_in_passive(&drive);
  CHECK(cargobay_sim_close(drive.sim) == CARGOBAY_OK);
  free(drive.hung);
}

static void* waits(void* context) {
  int* const error = malloc(sizeof *error);
  UNSEEN(state);
  CHECK(error != NULL);
  do {
    *error = cargobay_wait(context, state.tick, -1, &state);
  } while (*error == CARGOBAY_OK);
  return error;
}

/* Closing alone does the same, even while another thread waits. */
static void is_closed_under_a_waiting_thread(void) {
  struct drive drive = begin(kSleep, CARGOBAY_FLAG_NO_GUARD, SECONDS(10));
  pthread_t thread;
  void* error = NULL;
  CHECK(pthread_create(&thread, NULL, waits, drive.robot) == 0);
  wait_until_inside(&drive);
  ENDS_IN_TIME(cargobay_close(drive.robot), CARGOBAY_E_STALLED, "end the program");
  stands_in_passive(&drive);
  CHECK(pthread_join(thread, &error) == 0);
  CHECK(*(int*)error == CARGOBAY_E_STALLED || *(int*)error == CARGOBAY_ENDED ||
        *(int*)error == CARGOBAY_E_HANDLE);
  free(error);
  let_go(&drive);
  CHECK(cargobay_sim_close(drive.sim) == CARGOBAY_OK);
}

static void* steps(void* context) {
  struct cargobay_robot* robot = context;
  UNSEEN(state);
  while (next_state(robot, &state) == CARGOBAY_OK) {
  }
  return NULL;
}

/* In virtual time it hangs the waiting thread; another may close all the same. */
static void is_closed_in_virtual_time(void) {
  struct drive drive;
  pthread_t thread;
  drive.hung = calloc(1, sizeof *drive.hung);
  CHECK(drive.hung != NULL);
  drive.sim = virtual_sim();
  drive.robot = robot_of(drive.sim, 0);
  CHECK(cargobay_set_control(drive.robot, does_not_return, drive.hung) == CARGOBAY_OK);
  CHECK(cargobay_start(drive.robot) == CARGOBAY_OK);
  CHECK(pthread_create(&thread, NULL, steps, drive.robot) == 0);
  wait_until_inside(&drive);
  CHECK_FAILS(cargobay_end(drive.robot), CARGOBAY_E_THREAD, "another thread");
  ENDS_IN_TIME(cargobay_close(drive.robot), CARGOBAY_E_STALLED, "end the program");
  atomic_store(&drive.hung->let_go, true);
  CHECK(pthread_join(thread, NULL) == 0);
}

int main(void) {
  ends_every_call(kSleep, 0);
  ends_every_call(kSpin, 0);
  ends_every_call(kSleep, CARGOBAY_FLAG_NO_GUARD);
  ends_every_call(kEndThread, 0);
  does_not_wait_for_a_slow_guard();
  frees_what_came_back();
  is_not_waited_for_when_changed();
  is_closed_under_a_waiting_thread();
  is_closed_in_virtual_time();
  return 0;
}
