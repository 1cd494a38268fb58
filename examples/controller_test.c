/* A unit test of a controller: a minute of robot time on a virtual Create, in a moment. */
#include <cargobay.h>
#include <math.h>
#include <stdio.h>
#include <time.h>

/* Under test: drives 1 m ahead, keeps its heading, stops. */
static int one_metre(void* context, const struct cargobay_state* state,
                     struct cargobay_output* output) {
  (void)context;
  output->kind = CARGOBAY_OUTPUT_TWIST;
  output->twist.velocity_mm_s = fmax(-200.0, fmin(200.0, 2.0 * (1000.0 - state->x_mm)));
  output->twist.turn_rate_rad_s = -2.0 * state->heading_rad;
  return 0;
}

static int check(int holds, const char* what) {
  return printf("%s: %s\n", what, holds ? "ok" : "FAILED") < 0 || !holds;
}

static int test(struct cargobay_sim* sim, struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_truth truth = {.size = sizeof truth};
  if (cargobay_set_control(robot, one_metre, NULL) != 0 || cargobay_start(robot) != 0) return -1;
  const clock_t began = clock();
  while (state.robot_time_ns < 60000000000)
    if (cargobay_wait(robot, state.tick, -1, &state) != 0) return -1;
  if (cargobay_sim_get_truth(sim, &truth) != 0) return -1;
  const double took_s = (double)(clock() - began + 1) / CLOCKS_PER_SEC;
  printf("%.0f times as fast as the robot\n", 60.0 / took_s);
  return check(fabs(truth.x_mm - 1000.0) < 20.0, "it is 1 m ahead") +
         check(fabs(truth.y_mm) < 50.0, "it is not far to the side") +
         check(fabs(truth.left_mm_s) + fabs(truth.right_mm_s) < 5.0, "it has stopped");
}

int main(void) {
  struct cargobay_sim_options create = {.size = sizeof create, .time = CARGOBAY_SIM_TIME_VIRTUAL};
  struct cargobay_options options = {.size = sizeof options};
  struct cargobay_robot* robot = NULL;
  int error = cargobay_sim_open(&create, &options.sim);
  if (error == 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = test(options.sim, robot);
  if (error < 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  return error != 0;
}
