/* A controller that ends by itself after a metre. Without a port: in virtual time. */
#include <cargobay.h>
#include <math.h>
#include <stdio.h>

/* Slows down ahead of the goal, because the loop stops the wheels when this returns 1. */
static int one_metre(void* context, const struct cargobay_state* state,
                     struct cargobay_output* output) {
  const double left_mm = *(const double*)context - state->distance_mm;
  output->kind = CARGOBAY_OUTPUT_TWIST;
  output->twist.velocity_mm_s = fmax(20.0, fmin(300.0, 2.0 * left_mm));
  return left_mm <= 0.0;
}

int main(int argc, char** argv) {
  double goal_mm = 1000.0;
  struct cargobay_options options = {.size = sizeof options, .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_sim_options fast = {.size = sizeof fast, .time = CARGOBAY_SIM_TIME_VIRTUAL};
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_robot* robot = NULL;
  int error = argc > 1 ? 0 : cargobay_sim_open(&fast, &options.sim);
  if (error == 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = cargobay_set_control(robot, one_metre, &goal_mm);
  if (error == 0) error = cargobay_start(robot);
  while (error == 0) error = cargobay_wait(robot, state.tick, -1, &state);
  if (error == CARGOBAY_ENDED) error = cargobay_end(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  if (error == 0)
    printf("%.0f mm after %.1f s\n", state.distance_mm, 1e-9 * (double)state.robot_time_ns);
  return error != 0;
}
