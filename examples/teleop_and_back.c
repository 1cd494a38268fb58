/* Ahead by setpoints, about by a controller, and back by setpoints again, with one odometry. */
#include <cargobay.h>
#include <math.h>
#include <stdio.h>

static const double kAboutRad = 3.14159265;

static int drive_ahead(struct cargobay_robot* robot, int64_t duration_ns,
                       struct cargobay_state* state) {
  const int64_t end_ns = state->robot_time_ns + duration_ns;
  while (state->robot_time_ns < end_ns) {
    if (cargobay_drive(robot, 200.0, 0.0) != 0) return -1;
    if (cargobay_wait(robot, state->tick, -1, state) != 0) return -1;
  }
  printf("at %.0f, %.0f mm after %.0f mm\n", state->x_mm, state->y_mm, state->distance_mm);
  return 0;
}

static int turn_about(void* context, const struct cargobay_state* state,
                      struct cargobay_output* output) {
  (void)context;
  output->kind = CARGOBAY_OUTPUT_TWIST;
  output->twist.turn_rate_rad_s = fmin(1.5, 4.0 * (kAboutRad - state->heading_rad));
  return 0;
}

static int there_and_back(struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  if (cargobay_start(robot) != 0 || drive_ahead(robot, 3000000000, &state) != 0) return -1;
  if (cargobay_set_control(robot, turn_about, NULL) != 0) return -1;
  while (fabs(kAboutRad - state.heading_rad) > 0.02)
    if (cargobay_wait(robot, state.tick, -1, &state) != 0) return -1;
  if (cargobay_set_control(robot, NULL, NULL) != 0) return -1;
  return drive_ahead(robot, 3000000000, &state) != 0 ? -1 : cargobay_end(robot);
}

int main(int argc, char** argv) {
  struct cargobay_options options = {.size = sizeof options, .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_sim_options fast = {.size = sizeof fast, .time = CARGOBAY_SIM_TIME_VIRTUAL};
  struct cargobay_robot* robot = NULL;
  int error = argc > 1 ? 0 : cargobay_sim_open(&fast, &options.sim);
  if (error == 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = there_and_back(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  return error != 0;
}
