/* Wheels that are stuck, counters that cannot be true, and speeds out of reach: events with their
 * evidence, the end of the loop, and the bits of the state. */
#include <math.h>
#include <stdbool.h>

#include "check.h"

/* Drives at 200 mm/s, breaks after 3 s, and drives on for 5 s at most. */
static int drive_broken(struct cargobay_sim* sim, struct cargobay_robot* robot, const char* fault) {
  SIZED(cargobay_state, state);
  int code = CARGOBAY_OK;
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int tick = 0; tick < 533 && code == CARGOBAY_OK; ++tick) {
    if (tick == 200) CHECK(cargobay_sim_inject(sim, fault, NULL, 0) >= 0);
    const int driven = cargobay_drive_wheels(robot, 200.0, 200.0);
    CHECK(driven == CARGOBAY_OK || driven == CARGOBAY_E_STATE); /* it has ended by itself */
    code = next_state(robot, &state);
  }
  return code;
}

/* The event of that kind; kind -1 if there is none. */
static struct cargobay_event event_of(struct cargobay_robot* robot, int32_t kind) {
  SIZED(cargobay_event, event);
  while (cargobay_next_event(robot, event.sequence, &event) == 1) {
    if (event.kind == kind) return event;
  }
  event.kind = -1;
  return event;
}

static void ends(const char* fault, int32_t kind, int32_t finding, uint32_t wheels,
                 const char* words) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  struct cargobay_event event;
  SIZED(cargobay_end_report, end);
  char text[300];
  CHECK(drive_broken(sim, robot, fault) == CARGOBAY_E_WHEELS);
  CHECK(cargobay_end(robot) == CARGOBAY_E_WHEELS);
  CHECK(cargobay_get_end(robot, &end) == CARGOBAY_OK);
  CHECK(end.code == CARGOBAY_E_WHEELS && end.passive_seen == 1);
  CHECK(strstr(end.message, "stop_if_implausible") != NULL);
  event = event_of(robot, kind);
  CHECK(event.kind == kind && event.finding == finding && event.wheels == wheels);
  CHECK((event.overcurrents != 0) == (kind == CARGOBAY_EVENT_WHEEL_STUCK));
  CHECK(event.wanted.left_mm_s > 100.0 && event.got.left_mm_s < 0.7 * event.wanted.left_mm_s);
  CHECK(cargobay_describe_event(&event, text, sizeof text) < (int)sizeof text);
  CHECK(strstr(text, words) != NULL);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void goes_on_if_told(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, CARGOBAY_FLAG_DRIVE_ON);
  CHECK(drive_broken(sim, robot, "stuck left") == CARGOBAY_OK);
  CHECK(event_of(robot, CARGOBAY_EVENT_WHEEL_STUCK).wheels == CARGOBAY_WHEEL_LEFT);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* An arc whose outer wheel cannot turn that fast. */
static void keeps_the_curve(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  struct cargobay_event event;
  SIZED(cargobay_state, state);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int tick = 0; tick < 300; ++tick) {
    CHECK(cargobay_drive_wheels(robot, 300.0, 500.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
    if (tick == 2) CHECK((state.limits & CARGOBAY_LIMIT_ACCELERATION) != 0);
  }
  CHECK(state.limits == CARGOBAY_LIMIT_SPEED);
  CHECK(state.target.right_mm_s == 500.0);
  CHECK(state.limited.right_mm_s == 500.0);
  CHECK(state.estimate.right_mm_s > 420.0 && state.estimate.right_mm_s < 460.0);
  CHECK(fabs(state.estimate.left_mm_s - 0.6 * state.estimate.right_mm_s) < 10.0);
  event = event_of(robot, CARGOBAY_EVENT_LIMIT_BEGAN);
  CHECK((event.limits & CARGOBAY_LIMIT_SPEED) != 0);
  CHECK(event.wanted.right_mm_s == 500.0 && event.got.right_mm_s < 500.0);
  CHECK(fabs(event.got.left_mm_s - 0.6 * event.got.right_mm_s) < 0.1);
  for (int tick = 0; tick < 100; ++tick) {
    CHECK(cargobay_drive_wheels(robot, 120.0, 200.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(state.limits == 0);
  CHECK(event_of(robot, CARGOBAY_EVENT_LIMIT_ENDED).kind == CARGOBAY_EVENT_LIMIT_ENDED);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

int main(void) {
  ends("plant missed-left 1", CARGOBAY_EVENT_COUNTERS_IMPLAUSIBLE, CARGOBAY_FINDING_STILL,
       CARGOBAY_WHEEL_LEFT, "the left wheel is driven but counts nothing");
  ends("plant missed-left 0.5", CARGOBAY_EVENT_COUNTERS_IMPLAUSIBLE, CARGOBAY_FINDING_FEW,
       CARGOBAY_WHEEL_LEFT, "the left wheel counts much less");
  ends("stuck both", CARGOBAY_EVENT_WHEEL_STUCK, CARGOBAY_FINDING_STILL,
       CARGOBAY_WHEEL_LEFT | CARGOBAY_WHEEL_RIGHT, "both wheels draw too much current");
  goes_on_if_told();
  keeps_the_curve();
  return 0;
}
