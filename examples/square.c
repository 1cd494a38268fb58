/* A 500 mm square by odometry, and where the robot ends up. Without a port: in virtual time. */
#include <cargobay.h>
#include <math.h>
#include <stdio.h>

static double within(double most, double value) { return fmax(-most, fmin(most, value)); }

/* Drives until the robot has gone this far in total and has this heading. */
static int go_to(struct cargobay_robot* robot, double distance_mm, double heading_rad) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  for (;;) {
    if (cargobay_wait(robot, state.tick, 1000000000, &state) != 0) return -1;
    const double ahead_mm = distance_mm - state.distance_mm;
    const double turn_rad = heading_rad - state.heading_rad;
    if (fabs(ahead_mm) < 5.0 && fabs(turn_rad) < 0.03) return 0;
    const double velocity_mm_s = within(250.0, 4.0 * ahead_mm);
    if (cargobay_drive(robot, velocity_mm_s, within(1.5, 4.0 * turn_rad)) != 0) return -1;
  }
}

static int drive_square(struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  const double corner_rad = acos(0.0);
  if (cargobay_start(robot) != 0) return -1;
  for (int side = 0; side < 4; ++side) {
    if (go_to(robot, 500.0 * (side + 1), corner_rad * side) != 0) return -1;
    if (go_to(robot, 500.0 * (side + 1), corner_rad * (side + 1)) != 0) return -1;
  }
  if (cargobay_get_state(robot, &state) != 0) return -1;
  printf("back at %.0f, %.0f mm after %.0f mm\n", state.x_mm, state.y_mm, state.distance_mm);
  return cargobay_end(robot);
}

int main(int argc, char** argv) {
  struct cargobay_options options = {.size = sizeof options, .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_sim_options fast = {.size = sizeof fast, .time = CARGOBAY_SIM_TIME_VIRTUAL};
  struct cargobay_robot* robot = NULL;
  int error = argc > 1 ? 0 : cargobay_sim_open(&fast, &options.sim);
  if (error == 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = drive_square(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  return error != 0;
}
