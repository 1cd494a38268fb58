/* Drives ahead for two seconds and prints how fast the wheels turn. */
#include <cargobay.h>
#include <stdio.h>

static const int64_t kSecondNs = 1000000000;

static int drive_ahead(struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  char missing[1500];
  if (cargobay_start(robot) != 0) return -1;
  /* The robot drives without real-time rights too; this says how to get them. */
  if (cargobay_get_missing_rights(robot, missing, sizeof missing) > 0) fputs(missing, stderr);
  while (state.robot_time_ns < 2 * kSecondNs) {
    /* With every frame: a setpoint lapses after half a second unless renewed. */
    if (cargobay_drive(robot, 200.0, 0.0) != 0) return -1;
    if (cargobay_wait(robot, state.tick, kSecondNs, &state) != 0) return -1;
  }
  printf("the wheels turn at %.1f and %.1f mm/s, the robot is %.0f mm ahead\n",
         state.estimate.left_mm_s, state.estimate.right_mm_s, state.x_mm);
  return cargobay_end(robot);
}

int main(int argc, char** argv) {
  /* Without a port: a virtual Create, whatever a configuration file says. */
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_robot* robot = NULL;
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = drive_ahead(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  return error != 0;
}
