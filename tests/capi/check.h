/* What a C test prints and how it ends. */
#ifndef CHECK_H
#define CHECK_H

#include <stdio.h>
#include <stdlib.h>

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

#define SECONDS(count) ((int64_t)((count) * 1e9))

/* A virtual Create in virtual time, and the robot that uses it, not started. */
static inline struct cargobay_sim* virtual_sim(void) {
  struct cargobay_sim_options options;
  struct cargobay_sim* sim = NULL;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.time = CARGOBAY_SIM_VIRTUAL;
  CHECK(cargobay_sim_open(&options, &sim) == CARGOBAY_OK);
  return sim;
}
static inline struct cargobay_robot* robot_of(struct cargobay_sim* sim, uint32_t flags) {
  struct cargobay_options options;
  struct cargobay_robot* robot = NULL;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.flags = flags | CARGOBAY_NO_CONFIG;
  options.sim = sim;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  return robot;
}

/* Lets this much of the robot's time pass. */
static inline int run_for(struct cargobay_robot* robot, double seconds) {
  struct cargobay_state state;
  int64_t until = -1;
  memset(&state, 0, sizeof state);
  state.size = sizeof state;
  do {
    const int error = cargobay_wait(robot, SECONDS(2), &state);
    if (error != CARGOBAY_OK) return error;
    if (until < 0) until = state.time_ns + SECONDS(seconds);
  } while (state.time_ns < until);
  return CARGOBAY_OK;
}

#endif
