/* Your own controller: a PID on the heading, called by the loop once a frame. */
#include <cargobay.h>
#include <math.h>
#include <stdio.h>

struct pid {
  double heading_rad; /* wanted */
  double integral_rad_s;
};

/* Runs on the control thread: no lock, no printf, nothing that waits. */
static int keep_heading(void* context, const struct cargobay_state* state,
                        struct cargobay_output* output) {
  struct pid* pid = context;
  const double error_rad = pid->heading_rad - state->heading_rad;
  /* Only near the goal: what adds up on the way there would be overshoot. */
  const double period_s = fabs(error_rad) < 0.2 ? 1e-9 * (double)state->elapsed_ns : 0;
  pid->integral_rad_s += error_rad * period_s;
  const double rate = 3.0 * error_rad + 0.5 * pid->integral_rad_s - 0.2 * state->turn_rate_rad_s;
  output->kind = CARGOBAY_OUTPUT_TWIST;
  output->twist = (struct cargobay_twist){150.0, fmax(-1.5, fmin(1.5, rate))};
  return 0; /* 1 would end the loop */
}

int main(int argc, char** argv) {
  struct pid pid = {.heading_rad = acos(0.0)}; /* to the left */
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_robot* robot = NULL;
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = cargobay_set_control(robot, keep_heading, &pid);
  if (error == 0) error = cargobay_start(robot);
  while (error == 0 && state.robot_time_ns < 4000000000)
    error = cargobay_wait(robot, state.tick, -1, &state);
  if (error == 0) error = cargobay_end(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  if (error == 0)
    printf("wanted %.3f rad, the heading is %.3f rad\n", pid.heading_rad, state.heading_rad);
  return error != 0;
}
