/* What a C test prints and how it ends. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cargobay.h"

#define CHECK(condition)                                                                       \
  do {                                                                                         \
    if (!(condition)) {                                                                        \
      fprintf(stderr, "%s:%d: not so: %s\n  last error: %s\n", __FILE__, __LINE__, #condition, \
              cargobay_error_message());                                                       \
      exit(1);                                                                                 \
    }                                                                                          \
  } while (0)

/* The code, and that its message is a sentence about it. */
#define CHECK_FAILS(call, code, words)                                                       \
  do {                                                                                       \
    const int got_ = (call);                                                                 \
    if (got_ != (code) || strstr(cargobay_error_message(), (words)) == NULL) {               \
      fprintf(stderr, "%s:%d: %s\n  gave %s (\"%s\")\n  not  %s (\"...%s...\")\n", __FILE__, \
              __LINE__, #call, cargobay_error_name(got_), cargobay_error_message(),          \
              cargobay_error_name(code), (words));                                           \
      exit(1);                                                                               \
    }                                                                                        \
  } while (0)

#define SIZED(type, name)        \
  struct type name;              \
  memset(&name, 0, sizeof name); \
  name.size = sizeof name
/* A reader that has seen no state yet. */
#define UNSEEN(name)           \
  SIZED(cargobay_state, name); \
  name.tick = -1

#define SECONDS(count) ((int64_t)((count) * 1e9))

enum { kSkipped = 77 };

/* A virtual Create in virtual time, and the robot that uses it, not started. */
static inline struct cargobay_sim* virtual_sim(void) {
  struct cargobay_sim_options options;
  struct cargobay_sim* sim = NULL;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.time = CARGOBAY_SIM_TIME_VIRTUAL;
  CHECK(cargobay_sim_open(&options, &sim) == CARGOBAY_OK);
  return sim;
}
static inline struct cargobay_robot* robot_of(struct cargobay_sim* sim, uint32_t flags) {
  struct cargobay_options options;
  struct cargobay_robot* robot = NULL;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.flags = flags | CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  return robot;
}

/* The next state after the one that this holds; in virtual time, one frame later. */
static inline int next_state(struct cargobay_robot* robot, struct cargobay_state* state) {
  return cargobay_wait(robot, state->tick, SECONDS(5), state);
}

/* Lets this much of the robot's time pass. */
static inline int run_for(struct cargobay_robot* robot, double seconds) {
  int64_t until;
  int error;
  UNSEEN(state);
  error = cargobay_wait(robot, -1, SECONDS(2), &state);
  until = state.robot_time_ns + SECONDS(seconds);
  while (error == CARGOBAY_OK && state.robot_time_ns < until)
    error = cargobay_wait(robot, state.tick, SECONDS(2), &state);
  return error;
}

#endif
