/* Two virtual Creates in one world, in real time: each has a thread and a pseudo-terminal. */
#include <math.h>

#include "check.h"

static struct cargobay_robot* robot_at(struct cargobay_sim* sim) {
  struct cargobay_robot* robot = robot_of(sim, CARGOBAY_FLAG_NO_REALTIME);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  return robot;
}

int main(void) {
  struct cargobay_sim* sims[2] = {NULL, NULL};
  struct cargobay_robot* robots[2];
  char paths[2][64];
  for (int i = 0; i < 2; ++i) {
    SIZED(cargobay_sim_options, options);
    options.beside = sims[0];
    CHECK(cargobay_sim_open(&options, &sims[i]) == CARGOBAY_OK);
    CHECK(cargobay_sim_get_path(sims[i], paths[i], sizeof paths[i]) > 0);
  }
  CHECK(strcmp(paths[0], paths[1]) != 0);
  CHECK(cargobay_sim_inject(sims[1], "place 480 0 180", NULL, 0) >= 0);
  for (int i = 0; i < 2; ++i) robots[i] = robot_at(sims[i]);
  uint32_t bumps[2] = {0, 0};
  UNSEEN(state);
  SIZED(cargobay_state, other);
  while (bumps[0] == 0 || bumps[1] == 0) {
    CHECK(cargobay_wait(robots[0], state.tick, SECONDS(5), &state) == CARGOBAY_OK);
    CHECK(state.tick < 2000);
    CHECK(cargobay_drive(robots[0], 150.0, 0.0) == CARGOBAY_OK);
    bumps[0] |= state.bumps;
    if (cargobay_get_state(robots[1], &other) == CARGOBAY_OK) bumps[1] |= other.bumps;
  }
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_get_truth(sims[0], &truth) == CARGOBAY_OK);
  CHECK(fabs(truth.x_mm - 150.0) < 20.0);
  CHECK_FAILS(cargobay_sim_close(sims[0]), CARGOBAY_E_STATE, "close");
  for (int i = 1; i >= 0; --i) CHECK(cargobay_close(robots[i]) == CARGOBAY_OK);
  CHECK_FAILS(cargobay_sim_close(sims[0]), CARGOBAY_E_STATE, "close them first");
  for (int i = 1; i >= 0; --i) CHECK(cargobay_sim_close(sims[i]) == CARGOBAY_OK);
  return 0;
}
