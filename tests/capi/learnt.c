/* What the loop learns of the wheels: reported with its spread, kept for the next start, in a file
 * only if that is asked for. */
#define _GNU_SOURCE
#include <math.h>
#include <unistd.h>

#include "check.h"

static char folder[] = "/tmp/cargobay-capi-XXXXXX";
static char settings[200];
static char file[100];

static struct cargobay_options options_of(struct cargobay_sim* sim, uint32_t flags) {
  SIZED(cargobay_options, options);
  options.sim = sim;
  options.settings = settings;
  options.flags = flags;
  return options;
}

static void drive(struct cargobay_robot* robot, double seconds) {
  UNSEEN(state);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < (int)(seconds / 0.015); ++i) {
    const double way = i / 80 % 2 == 0 ? 1.0 : 0.5;
    CHECK(cargobay_drive_wheels(robot, 200.0 * way, 150.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
}

static struct cargobay_learnt learnt_of(struct cargobay_robot* robot) {
  SIZED(cargobay_learnt, learnt);
  CHECK(cargobay_get_learnt(robot, &learnt) == CARGOBAY_OK);
  return learnt;
}

/* As in a process of its own: opens, drives, closes. */
static struct cargobay_learnt start_with(struct cargobay_sim* sim, uint32_t flags, double seconds) {
  struct cargobay_robot* robot = NULL;
  struct cargobay_options options = options_of(sim, flags);
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  drive(robot, seconds);
  struct cargobay_learnt learnt = learnt_of(robot);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  return learnt;
}

static void is_reported(struct cargobay_sim* sim) {
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_learnt, learnt);
  SIZED(cargobay_options, options);
  options.sim = sim;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_get_learnt(robot, &learnt) == CARGOBAY_E_NO_FRAME);
  drive(robot, 15.0);
  learnt = learnt_of(robot);
  CHECK(learnt.remainder == CARGOBAY_REMAINDER_CARRIED && learnt.carried_probability > 0.99);
  CHECK(learnt.from_earlier == 0 && learnt.reserved == 0);
  CHECK(llabs(learnt.lag_ns - 100000000) < 30000000);
  CHECK(learnt.lag_sd_ns > 0 && learnt.lag_sd_ns < 50000000);
  CHECK(learnt.dead_time_ns >= 0 && learnt.dead_time_ns < 30000000 && learnt.dead_time_sd_ns >= 0);
  CHECK(learnt.ramp_s2_mm >= 0.0 && learnt.ramp_s2_mm < 0.001 && learnt.ramp_sd_s2_mm >= 0.0);
  CHECK(fabs(learnt.gain_left - 0.94) < 0.03 && fabs(learnt.gain_right - 0.90) < 0.03);
  CHECK(learnt.gain_left_sd > 0.0 && learnt.gain_left_sd < 0.05);
  CHECK(learnt.gain_right_sd > 0.0 && learnt.gain_right_sd < 0.05);
  CHECK(llabs(learnt.moved_ns - 15000000000) < 200000000);
  /* The next start of the same handle begins from it, without any file. */
  drive(robot, 1.0);
  learnt = learnt_of(robot);
  CHECK(learnt.from_earlier == 1 && learnt.moved_ns < 2000000000);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

static void is_kept_in_a_file_that_is_named(struct cargobay_sim* sim) {
  CHECK(access(file, F_OK) != 0);
  CHECK(start_with(sim, 0, 6.0).from_earlier == 0);
  CHECK(access(file, F_OK) == 0);
  CHECK(start_with(sim, 0, 6.0).from_earlier == 1);
  CHECK(start_with(sim, CARGOBAY_FLAG_FORGET, 6.0).from_earlier == 0);
  CHECK(start_with(sim, CARGOBAY_FLAG_NO_LEARNT, 6.0).from_earlier == 0);
  CHECK(unlink(file) == 0);
  CHECK(start_with(sim, CARGOBAY_FLAG_NO_LEARNT, 6.0).from_earlier == 0);
  CHECK(access(file, F_OK) != 0);
  CHECK(start_with(sim, CARGOBAY_FLAG_FORGET, 6.0).from_earlier == 0);
  CHECK(unlink(file) == 0);
}

static void fails_no_drive(struct cargobay_sim* sim) {
  FILE* broken = fopen(file, "w");
  CHECK(broken != NULL && fputs("[[[", broken) >= 0 && fclose(broken) == 0);
  CHECK(start_with(sim, 0, 1.0).from_earlier == 0);
  CHECK(unlink(file) == 0);
  snprintf(settings, sizeof settings, "[robot]\nlearnt = \"/dev/full\"\n");
  CHECK(start_with(sim, 0, 6.0).from_earlier == 0);
}

int main(void) {
  struct cargobay_sim* sim = virtual_sim();
  CHECK(mkdtemp(folder) != NULL);
  snprintf(file, sizeof file, "%s/it.toml", folder);
  snprintf(settings, sizeof settings, "[robot]\nlearnt = \"%s\"\n", file);
  is_reported(sim);
  is_kept_in_a_file_that_is_named(sim);
  fails_no_drive(sim);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK && rmdir(folder) == 0);
  return 0;
}
