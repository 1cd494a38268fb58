/* The C API on a pseudo-terminal, in real time: threads, signals, rights, deadlines. */
#define _GNU_SOURCE
#include <linux/capability.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "check.h"

static struct cargobay_robot* own_robot(uint32_t flags) {
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG | flags;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  return robot;
}

struct reader {
  struct cargobay_robot* robot;
  int frames;
  int end;
};

static void* reads_frames(void* context) {
  struct reader* self = context;
  int64_t last = -1;
  UNSEEN(state);
  while ((self->end = cargobay_wait(self->robot, last, -1, &state)) == CARGOBAY_OK) {
    CHECK(state.tick > last);
    last = state.tick;
    ++self->frames;
  }
  return NULL;
}

static struct cargobay_robot* of_the_handler;
static void on_alarm(int signal) {
  (void)signal;
  (void)cargobay_request_end(of_the_handler);
}

/* Readers wait while others set speeds; a signal handler ends it for all of them. */
static void serves_many_threads(void) {
  struct cargobay_robot* robot = own_robot(0);
  struct reader readers[3];
  pthread_t threads[3];
  SIZED(cargobay_statistics, counted);
  UNSEEN(state);
  char missing[1500];
  CHECK_FAILS(cargobay_get_missing_rights(robot, NULL, 0), CARGOBAY_E_ARGUMENT, "NULL");
  CHECK_FAILS(cargobay_get_missing_rights(robot, missing, sizeof missing), CARGOBAY_E_STATE,
              "start");
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(cargobay_get_missing_rights(robot, missing, sizeof missing) == (int)strlen(missing));
  for (int i = 0; i < 3; ++i) {
    readers[i] = (struct reader){robot, 0, 0};
    CHECK(pthread_create(&threads[i], NULL, reads_frames, &readers[i]) == 0);
  }
  for (int i = 0; i < 60; ++i) {
    CHECK(cargobay_drive(robot, 150.0, 0.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(state.target.left_mm_s == 150.0);
  CHECK(cargobay_wait(robot, state.tick + 1000, 0, &state) == CARGOBAY_E_TIMEOUT);
  of_the_handler = robot;
  CHECK(signal(SIGALRM, on_alarm) != SIG_ERR);
  CHECK(raise(SIGALRM) == 0);
  for (int i = 0; i < 3; ++i) {
    CHECK(pthread_join(threads[i], NULL) == 0);
    CHECK(readers[i].frames >= 50 && readers[i].end == CARGOBAY_ENDED);
  }
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK);
  CHECK(counted.frames_good >= 60 && counted.commands_unsent == 0);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

/* Closing ends the waits of other threads; none of them touches what is freed. */
static void closes_under_waiting_threads(void) {
  struct cargobay_robot* robot = own_robot(0);
  struct reader reader = {robot, 0, 0};
  pthread_t thread;
  UNSEEN(state);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  CHECK(pthread_create(&thread, NULL, reads_frames, &reader) == 0);
  for (int i = 0; i < 10; ++i) CHECK(next_state(robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(pthread_join(thread, NULL) == 0);
  CHECK(reader.end == CARGOBAY_ENDED || reader.end == CARGOBAY_E_HANDLE);
}

/* The program's virtual Create, opened by its path like any port. */
static void drives_a_port(void) {
  char path[64];
  struct cargobay_sim* sim = NULL;
  struct cargobay_robot* robot = NULL;
  struct cargobay_robot* second = NULL;
  SIZED(cargobay_options, options);
  SIZED(cargobay_truth, truth);
  UNSEEN(state);
  CHECK(cargobay_sim_open(NULL, &sim) == CARGOBAY_OK);
  CHECK(cargobay_sim_get_path(sim, path, sizeof path) > 5);
  CHECK(cargobay_sim_advance(sim, 1000000) == CARGOBAY_OK);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.port = path;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_open(&options, &second), CARGOBAY_E_BUSY, path);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 50; ++i) {
    CHECK(cargobay_drive(robot, 200.0, 0.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK && truth.left_mm_s > 100.0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK && truth.mode == CARGOBAY_MODE_PASSIVE);

  /* Used as the robot itself; then its adapter is pulled out. */
  options.port = NULL;
  options.sim = sim;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(cargobay_wait(robot, -1, SECONDS(5), NULL) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static atomic_bool let_go;
static int does_not_return(void* context, const struct cargobay_state* state,
                           struct cargobay_output* output) {
  (void)context;
  if (state->tick > 20)
    while (!atomic_load(&let_go)) {
    }
  output->wheels.left_mm_s = output->wheels.right_mm_s = 200.0;
  return 0;
}

/* The guard stops the robot if a control function does not return. */
static void is_guarded(void) {
  struct cargobay_sim* sim = NULL;
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_open(NULL, &sim) == CARGOBAY_OK);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  options.priority = 10;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_set_control(robot, does_not_return, NULL) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  do {
    CHECK(cargobay_sim_advance(sim, 10000000) == CARGOBAY_OK);
    CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  } while (truth.commanded_left_mm_s == 0 || truth.mode != CARGOBAY_MODE_SAFE);
  do {
    CHECK(cargobay_sim_advance(sim, 10000000) == CARGOBAY_OK);
    CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  } while (truth.mode != CARGOBAY_MODE_PASSIVE);
  CHECK(truth.commanded_left_mm_s == 0);
  atomic_store(&let_go, true);
  CHECK_FAILS(cargobay_end(robot), CARGOBAY_E_STALLED, "stopped by its guard");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static int takes_too_long(void* context, const struct cargobay_state* state,
                          struct cargobay_output* output) {
  (void)context;
  (void)output;
  if (state->tick > 10) usleep(4000); /* twice its budget */
  return 0;
}

static void is_kept_to_its_budget(void) {
  struct cargobay_robot* robot = own_robot(0);
  SIZED(cargobay_statistics, counted);
  CHECK(cargobay_set_control(robot, takes_too_long, NULL) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  int error;
  UNSEEN(state);
  while ((error = next_state(robot, &state)) == CARGOBAY_OK) {
  }
  CHECK_FAILS(error, CARGOBAY_E_CONTROL, "budget");
  CHECK_FAILS(cargobay_end(robot), CARGOBAY_E_CONTROL, "budget");
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK && counted.overruns_control > 9);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

/* Without the rights that it requires, nothing moves. Last: the process never gets them back. */
static void requires_rights(void) {
  struct __user_cap_header_struct header = {_LINUX_CAPABILITY_VERSION_3, 0};
  struct __user_cap_data_struct rights[2];
  const struct rlimit no_priority = {0, 0};
  struct cargobay_robot* robot = own_robot(CARGOBAY_FLAG_REQUIRE_REALTIME);
  CHECK(syscall(SYS_capget, &header, rights) == 0);
  rights[0].effective &= ~(1u << CAP_SYS_NICE);
  rights[0].permitted &= ~(1u << CAP_SYS_NICE);
  CHECK(syscall(SYS_capset, &header, rights) == 0);
  CHECK(setrlimit(RLIMIT_RTPRIO, &no_priority) == 0);
  CHECK_FAILS(cargobay_start(robot), CARGOBAY_E_RIGHTS, "real-time rights are required");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

int main(void) {
  serves_many_threads();
  closes_under_waiting_threads();
  drives_a_port();
  is_guarded();
  is_kept_to_its_budget();
  requires_rights();
  return 0;
}
