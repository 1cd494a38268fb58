/* Several virtual Creates in one world. */
#ifndef CARGOBAY_TESTS_CAPI_SEVERAL_H
#define CARGOBAY_TESTS_CAPI_SEVERAL_H

#include "check.h"

enum { kMost = 3 };

static inline struct cargobay_sim* sim_beside(struct cargobay_sim* other) {
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_sim_options, options);
  if (other == NULL) options.time = CARGOBAY_SIM_TIME_VIRTUAL;
  options.beside = other;
  CHECK(cargobay_sim_open(&options, &sim) == CARGOBAY_OK);
  return sim;
}

static inline struct cargobay_truth truth_of(struct cargobay_sim* sim) {
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  return truth;
}

static inline void put(struct cargobay_sim* sim, const char* place) {
  CHECK(cargobay_sim_inject(sim, place, NULL, 0) >= 0);
}

static inline void close_all(struct cargobay_robot** robots, struct cargobay_sim** sims,
                             int count) {
  for (int i = count - 1; i >= 0; --i) {
    if (robots != NULL) CHECK(cargobay_close(robots[i]) == CARGOBAY_OK);
  }
  for (int i = count - 1; i >= 0; --i) CHECK(cargobay_sim_close(sims[i]) == CARGOBAY_OK);
}

#endif
