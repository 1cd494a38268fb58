/* Two robots in one world, in virtual time: the second catches up until its bumper touches. */
#include <cargobay.h>
#include <stdio.h>

static int catch_up(struct cargobay_robot** robots, struct cargobay_state* states) {
  const double velocities[2] = {80.0, 200.0};
  int error = 0;
  while (error == 0 && states[1].bumps == 0) {
    for (int i = 0; i < 2 && error == 0; ++i) {
      error = cargobay_wait(robots[i], states[i].tick, 1000000000, &states[i]);
      if (error == 0) error = cargobay_drive(robots[i], velocities[i], 0.0);
    }
  }
  return error;
}

int main(void) {
  struct cargobay_sim* sims[2] = {NULL, NULL};
  struct cargobay_robot* robots[2] = {NULL, NULL};
  struct cargobay_state states[2] = {{.size = sizeof states[0], .tick = -1},
                                     {.size = sizeof states[1], .tick = -1}};
  int error = 0;
  for (int i = 0; i < 2 && error >= 0; ++i) {
    /* The world and the clock are the first one's. */
    const struct cargobay_sim_options create = {
        .size = sizeof create, .time = i == 0 ? CARGOBAY_SIM_TIME_VIRTUAL : 0, .beside = sims[0]};
    error = cargobay_sim_open(&create, &sims[i]);
    if (error == 0 && i == 1) error = cargobay_sim_inject(sims[i], "place -800 0 0", NULL, 0);
    const struct cargobay_options options = {.size = sizeof options, .sim = sims[i]};
    if (error >= 0) error = cargobay_open(&options, &robots[i]);
    if (error == 0) error = cargobay_start(robots[i]);
  }
  if (error == 0) error = catch_up(robots, states);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  for (int i = 1; i >= 0; --i) cargobay_close(robots[i]);
  for (int i = 1; i >= 0; --i) cargobay_sim_close(sims[i]);
  if (error == 0) printf("caught up after %.0f mm\n", states[1].x_mm);
  return error != 0;
}
