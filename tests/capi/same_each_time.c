/* A drive in virtual time is the same each time, and takes a fraction of the robot's. */
#define _POSIX_C_SOURCE 200809L
#include <time.h>

#include "check.h"

/* The same seed, the same drive; returns how much faster than the robot it ran. */
static double drive_of(uint64_t seed, double seconds) {
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_sim_options, create);
  SIZED(cargobay_truth, truth);
  create.time = CARGOBAY_SIM_TIME_VIRTUAL;
  create.seed = seed;
  CHECK(cargobay_sim_open(&create, &sim) == CARGOBAY_OK);
  struct cargobay_robot* robot = robot_of(sim, 0);
  UNSEEN(state);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < (int)(seconds / 0.015); ++i) {
    CHECK(cargobay_drive(robot, 200.0, 0.3) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  return truth.x_mm + 1000.0 * truth.y_mm;
}

static double cpu_seconds(void) {
  struct timespec now;
  CHECK(clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) == 0);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void is_the_same_each_time_and_fast(void) {
  const double first = drive_of(7, 20.0);
  CHECK(drive_of(7, 20.0) == first);
  CHECK(drive_of(8, 20.0) != first);
  const double before = cpu_seconds();
  (void)drive_of(7, 600.0);
  const double times = 600.0 / (cpu_seconds() - before);
  printf("a controller in virtual time: %.0f times as fast as the robot\n", times);
  /* The ratio of the robot's time to CPU time. A sanitizer needs extra time. */
  if (getenv("CARGOBAY_SANITIZED") == NULL) CHECK(times > 200.0);
}

int main(void) {
  is_the_same_each_time_and_fast();
  return 0;
}
