/* A15: the clocks agree. robot_time_ns counts the robot's ticks, arrival_ns is on CLOCK_MONOTONIC
 * or, in virtual time, since the virtual Create was opened, as sim_time_ns is. */
#define _POSIX_C_SOURCE 200809L
#include <time.h>

#include "check.h"

static int64_t monotonic_ns(void) {
  struct timespec now;
  CHECK(clock_gettime(CLOCK_MONOTONIC, &now) == 0);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int64_t sim_time_ns(struct cargobay_sim* sim) {
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  return truth.sim_time_ns;
}

static void robot_time_counts_ticks(const struct cargobay_state* state, int64_t tick_ns) {
  CHECK(state->robot_time_ns == state->tick * tick_ns);
  CHECK(state->elapsed_ns % tick_ns == 0 && state->elapsed_ns >= 0);
}

/* An event and a reading have the tick and the arrival of the state of their frame. */
static void agree_with_each_other(struct cargobay_robot* robot, struct cargobay_sim* sim) {
  static struct cargobay_state states[256];
  const uint32_t packet = CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS;
  struct cargobay_reading reading;
  int found = 0;
  SIZED(cargobay_event, event);
  CHECK(cargobay_sim_inject(sim, "bump left", NULL, 0) >= 0);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  while (cargobay_next_event(robot, event.sequence, &event) == 1 &&
         event.kind != CARGOBAY_EVENT_BUMP_BEGAN) {
  }
  CHECK(event.kind == CARGOBAY_EVENT_BUMP_BEGAN);
  CHECK(cargobay_get_readings(robot, &packet, 1, &reading) == CARGOBAY_OK);
  states[0].size = sizeof states[0];
  const int count = cargobay_get_history(robot, -1, states, 256);
  CHECK(count > 20);
  for (int i = 0; i < count; ++i) {
    if (states[i].tick == event.tick) {
      CHECK(states[i].arrival_ns == event.arrival_ns);
      ++found;
    }
    if (states[i].tick != reading.tick) continue;
    const int64_t apart = states[i].arrival_ns - reading.arrival_ns;
    CHECK(apart >= -2000000 && apart <= 2000000);
    ++found;
  }
  CHECK(found == 2);
}

static void in_virtual_time(void) {
  struct cargobay_sim* sim = virtual_sim();
  CHECK(sim_time_ns(sim) == 0);
  CHECK(cargobay_sim_advance(sim, SECONDS(2)) == CARGOBAY_OK);
  CHECK(sim_time_ns(sim) == SECONDS(2));
  struct cargobay_robot* robot = robot_of(sim, 0);
  UNSEEN(state);
  SIZED(cargobay_info, info);
  CHECK(cargobay_get_info(robot, &info) == CARGOBAY_OK && info.tick_ns == 15000000);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 100; ++i) {
    const int64_t before = sim_time_ns(sim);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
    robot_time_counts_ticks(&state, info.tick_ns);
    CHECK(state.arrival_ns >= before && state.arrival_ns <= sim_time_ns(sim));
  }
  agree_with_each_other(robot, sim);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void in_real_time(void) {
  struct cargobay_sim* sim = NULL;
  CHECK(cargobay_sim_open(NULL, &sim) == CARGOBAY_OK);
  struct cargobay_robot* robot = robot_of(sim, 0);
  UNSEEN(state);
  SIZED(cargobay_info, info);
  CHECK(cargobay_get_info(robot, &info) == CARGOBAY_OK);
  const int64_t begin = monotonic_ns();
  const int64_t sim_begin = sim_time_ns(sim);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 40; ++i) {
    const int64_t before = state.arrival_ns;
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
    robot_time_counts_ticks(&state, info.tick_ns);
    CHECK(state.arrival_ns > before && state.arrival_ns <= monotonic_ns());
  }
  CHECK(state.arrival_ns > begin);
  CHECK(sim_time_ns(sim) > sim_begin &&
        sim_time_ns(sim) - sim_begin <= monotonic_ns() - begin + SECONDS(1));
  agree_with_each_other(robot, sim);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* What a test injects for later happens at that moment of the virtual Create's time. */
static void happens_at(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  SIZED(cargobay_event, event);
  CHECK(cargobay_sim_inject(sim, "at 3.5 bump left", NULL, 0) >= 0);
  CHECK(cargobay_sim_inject(sim, "at 2.5 fault stalled-stream 200", NULL, 0) >= 0);
  CHECK(cargobay_sim_inject(sim, "at 4 wheeldrop right on", NULL, 0) >= 0);
  CHECK(cargobay_sim_inject(sim, "at 3 dance", NULL, 0) == CARGOBAY_E_ARGUMENT);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 10.0) == CARGOBAY_E_MODE);
  static const int kKinds[] = {CARGOBAY_EVENT_FRAMES_LOST, CARGOBAY_EVENT_BUMP_BEGAN,
                               CARGOBAY_EVENT_MODE_LOST};
  static const double kAfterS[] = {2.5, 3.5, 4.0};
  for (int i = 0; i < 3; ++i) {
    while (cargobay_next_event(robot, event.sequence, &event) == 1 && event.kind != kKinds[i]) {
    }
    CHECK(event.kind == kKinds[i] && event.arrival_ns >= SECONDS(kAfterS[i]));
    CHECK(event.arrival_ns <= SECONDS(kAfterS[i] + 0.3));
  }
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

int main(void) {
  happens_at();
  in_virtual_time();
  in_real_time();
  return 0;
}
