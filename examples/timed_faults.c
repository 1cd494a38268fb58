/* A unit test of a controller, on an ideal robot that bumps into something at 3 s. */
#include <cargobay.h>
#include <math.h>
#include <stdio.h>

/* Under test: drives ahead; backs off for a second from what it bumps into, and waits. */
static int back_off(void* context, const struct cargobay_state* state,
                    struct cargobay_output* output) {
  int64_t* bumped_ns = context;
  if (*bumped_ns < 0 && state->bumps != 0) *bumped_ns = state->robot_time_ns;
  const int waits = state->robot_time_ns > *bumped_ns + 1000000000;
  const double speed_mm_s = *bumped_ns < 0 ? 200.0 : waits ? 0.0 : -100.0;
  output->wheels = (struct cargobay_wheels){speed_mm_s, speed_mm_s};
  return 0;
}

/* Goes on until the robot's own time is `time_s`; its wheels must then turn at `wanted_mm_s`. */
static int check(struct cargobay_robot* robot, struct cargobay_sim* sim, double time_s,
                 double wanted_mm_s) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_truth truth = {.size = sizeof truth};
  while ((double)truth.sim_time_ns < 1e9 * time_s) {
    if (cargobay_wait(robot, state.tick, -1, &state) != 0) return -1;
    if (cargobay_sim_get_truth(sim, &truth) != 0) return -1;
  }
  const int holds = fabs(truth.left_mm_s - wanted_mm_s) + fabs(truth.right_mm_s - wanted_mm_s) < 2;
  printf("%.1f s: %+.1f and %+.1f mm/s: %s\n", time_s, truth.left_mm_s, truth.right_mm_s,
         holds ? "ok" : "FAILED");
  return !holds;
}

int main(void) {
  struct cargobay_sim_options ideal = {.size = sizeof ideal,
                                       .time = CARGOBAY_SIM_TIME_VIRTUAL,
                                       .gain_left = 1.0,
                                       .gain_right = 1.0,
                                       .noise_mm_s = -1.0};
  struct cargobay_options options = {.size = sizeof options};
  struct cargobay_robot* robot = NULL;
  int64_t bumped_ns = -1;
  int error = cargobay_sim_open(&ideal, &options.sim);
  if (error == 0 && cargobay_sim_inject(options.sim, "at 3 bump left", NULL, 0) < 0) error = -1;
  if (error == 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = cargobay_set_control(robot, back_off, &bumped_ns);
  if (error == 0) error = cargobay_start(robot);
  if (error == 0) error = check(robot, options.sim, 2.9, 200.0);
  if (error == 0) error = check(robot, options.sim, 3.9, -100.0);
  if (error == 0) error = check(robot, options.sim, 5.0, 0.0);
  if (error < 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  return error != 0;
}
