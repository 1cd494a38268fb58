/* Turns away from what it bumps into, as the events report. Without a port: in a virtual pen. */
#include <cargobay.h>
#include <stdio.h>

static const int64_t kMinuteNs = 60000000000;

static int wander(struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_event event = {.size = sizeof event};
  int64_t turn_until_ns = 0;
  double turn_rad_s = 0.0;
  int bumps = 0;
  if (cargobay_start(robot) != 0) return -1;
  while (state.robot_time_ns < kMinuteNs) {
    if (cargobay_wait(robot, state.tick, -1, &state) != 0) return -1;
    while (cargobay_next_event(robot, event.sequence, &event) == 1) {
      if (event.kind != CARGOBAY_EVENT_BUMP_BEGAN) continue;
      ++bumps;
      turn_rad_s = event.bumps == CARGOBAY_BUMP_LEFT ? -1.5 : 1.5;
      turn_until_ns = state.robot_time_ns + 1100000000;
    }
    const int turns = state.robot_time_ns < turn_until_ns;
    if (cargobay_drive(robot, turns ? 0.0 : 200.0, turns ? turn_rad_s : 0.0) != 0) return -1;
  }
  printf("%d bumps in a minute\n", bumps);
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
  if (error == 0) error = wander(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  return error != 0;
}
