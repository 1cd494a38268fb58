/* As fast as it goes, straight and then in a curve. Without a port: in virtual time. */
#include <cargobay.h>
#include <stdio.h>

static int drive_for(struct cargobay_robot* robot, struct cargobay_twist twist,
                     int64_t duration_ns) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  int error = cargobay_wait(robot, -1, -1, &state);
  const int64_t end_ns = state.robot_time_ns + duration_ns;
  while (error == 0 && state.robot_time_ns < end_ns) {
    error = cargobay_drive(robot, twist.velocity_mm_s, twist.turn_rate_rad_s);
    if (error == 0) error = cargobay_wait(robot, state.tick, -1, &state);
  }
  /* No wheel goes faster than 500 mm/s: both numbers are scaled down, and the radius stays. */
  printf("wanted %.0f mm/s and %.2f rad/s: wheels at %.0f and %.0f mm/s, %.0f mm/s, %.2f rad/s\n",
         twist.velocity_mm_s, twist.turn_rate_rad_s, state.target.left_mm_s,
         state.target.right_mm_s, state.velocity_mm_s, state.turn_rate_rad_s);
  return error;
}

int main(int argc, char** argv) {
  const struct cargobay_twist straight = {500.0, 0.0};
  const struct cargobay_twist curve = {500.0, 0.5};
  struct cargobay_options options = {.size = sizeof options, .port = argc > 1 ? argv[1] : NULL};
  /* Wheels that follow exactly: at full speed nothing is left to make up for weak ones. */
  struct cargobay_sim_options ideal = {
      .size = sizeof ideal, .time = CARGOBAY_SIM_TIME_VIRTUAL, .gain_left = 1.0, .gain_right = 1.0};
  struct cargobay_robot* robot = NULL;
  int error = argc > 1 ? 0 : cargobay_sim_open(&ideal, &options.sim);
  if (error == 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = cargobay_start(robot);
  if (error == 0) error = drive_for(robot, straight, 2000000000);
  if (error == 0) error = drive_for(robot, curve, 2000000000);
  if (error == 0) error = cargobay_end(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  return error != 0;
}
