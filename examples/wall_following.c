/* Follows the wall on its right by the wall signal. Without a port: around a virtual pen. */
#include <cargobay.h>
#include <math.h>
#include <stdio.h>

static int follow(struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  const uint32_t wall_signal = CARGOBAY_PACKET_WALL_SIGNAL;
  struct cargobay_reading signal;
  int64_t corner_until_ns = 0;
  int frames_at_wall = 0;
  /* The loop does not stream the wall signal for itself. */
  if (cargobay_start(robot) != 0) return -1;
  if (cargobay_subscribe(robot, &wall_signal, 1) != 0) return -1;
  while (state.robot_time_ns < 60000000000) {
    if (cargobay_wait(robot, state.tick, -1, &state) != 0) return -1;
    if (cargobay_get_readings(robot, &wall_signal, 1, &signal) != 0) return -1;
    /* The sensor looks to the right, so the bumper is what finds a corner. */
    if (state.bumps != 0) corner_until_ns = state.robot_time_ns + 700000000;
    const int corner = state.robot_time_ns < corner_until_ns;
    const double turn_rad_s = fmax(-1.0, fmin(1.0, 0.0007 * (signal.value - 2000)));
    if (cargobay_drive(robot, corner ? 0.0 : 150.0, corner ? 1.5 : turn_rad_s) != 0) return -1;
    frames_at_wall += signal.value > 500;
  }
  printf("%.1f m, %.0f %% of the time at a wall, %.1f rounds\n", 1e-3 * state.distance_mm,
         100.0 * frames_at_wall / (double)state.tick, state.heading_rad / (4.0 * acos(0.0)));
  return cargobay_end(robot);
}

int main(int argc, char** argv) {
  struct cargobay_options options = {.size = sizeof options, .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_sim_options pen = {.size = sizeof pen,
                                     .time = CARGOBAY_SIM_TIME_VIRTUAL,
                                     .world = CARGOBAY_EXAMPLES "/worlds/pen.world"};
  struct cargobay_robot* robot = NULL;
  int error = argc > 1 ? 0 : cargobay_sim_open(&pen, &options.sim);
  if (error == 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = follow(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  return error != 0;
}
