/* A controller that others watch while it drives a figure of eight: run `cargobay top` beside it. */
#include <cargobay.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const int64_t kSecondNs = 1000000000;
static const double kEightS = 8.0; /* a full figure */

static int drive_eights(struct cargobay_robot* robot, double seconds) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  if (cargobay_start(robot) != 0) return -1;
  while ((double)state.robot_time_ns < seconds * (double)kSecondNs) {
    const double phase = (double)state.robot_time_ns / (double)kSecondNs / kEightS;
    const double side = fmod(phase, 1.0) < 0.5 ? 1.0 : -1.0;
    if (cargobay_drive(robot, 150.0, side * 4.0 * 3.14159265 / kEightS) != 0) return -1;
    if (cargobay_wait(robot, state.tick, kSecondNs, &state) != 0) return -1;
  }
  return cargobay_end(robot);
}

int main(int argc, char** argv) {
  const char* port = argc > 1 ? argv[1] : NULL;
  const double seconds = argc > 2 ? atof(argv[2]) : 2.0;
  /* This flag is all that it takes. */
  struct cargobay_options options = {
      .size = sizeof options,
      .flags = CARGOBAY_FLAG_PUBLISH | (port != NULL ? 0u : CARGOBAY_FLAG_NO_CONFIG),
      .port = port};
  struct cargobay_robot* robot = NULL;
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = drive_eights(robot, seconds);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  return error != 0;
}
