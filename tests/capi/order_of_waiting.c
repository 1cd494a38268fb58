/* However a program waits for several virtual Creates, each of their loops sees and does the same. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "several.h"

enum { kTickNs = 15000000 };

/* Follows the heading of the one before, which its frame shows as it is at that instant. */
struct follower {
  struct cargobay_robot* leader;
  int calls;
};
static int follow(void* context, const struct cargobay_state* state,
                  struct cargobay_output* output) {
  struct follower* follower = context;
  SIZED(cargobay_state, led);
  ++follower->calls;
  (void)state;
  output->kind = CARGOBAY_OUTPUT_TWIST;
  output->twist.velocity_mm_s = 150.0;
  if (follower->leader == NULL) {
    output->twist.turn_rate_rad_s = 0.5;
  } else if (cargobay_get_state(follower->leader, &led) == 0) {
    output->twist.turn_rate_rad_s = led.turn_rate_rad_s;
    output->twist.velocity_mm_s = 100.0 + fmod(led.x_mm, 50.0); /* sensitive to which state it is */
  }
  return 0;
}

enum order { in_turn, backwards, only_the_first, only_the_last, by_advance };

struct drive {
  struct cargobay_state states[kMost][200];
  int count[kMost];
};

static void run(enum order order, uint32_t last_baud, struct drive* drive) {
  struct cargobay_sim* sims[kMost];
  struct cargobay_robot* robots[kMost] = {NULL, NULL, NULL};
  struct follower followers[kMost];
  struct cargobay_state seen[kMost];
  memset(drive, 0, sizeof *drive);
  for (int i = 0; i < kMost; ++i) sims[i] = sim_beside(i == 0 ? NULL : sims[i - 1]);
  for (int i = 0; i < kMost; ++i) {
    SIZED(cargobay_options, options);
    options.sim = sims[i];
    if (i == kMost - 1) options.baud = last_baud;
    CHECK(cargobay_open(&options, &robots[i]) == CARGOBAY_OK);
    followers[i].leader = i == 0 ? NULL : robots[i - 1];
    followers[i].calls = 0;
    CHECK(cargobay_set_control(robots[i], follow, &followers[i]) == CARGOBAY_OK);
    memset(&seen[i], 0, sizeof seen[i]);
    seen[i].size = sizeof seen[i];
    seen[i].tick = -1;
  }
  for (int i = 0; i < kMost; ++i) CHECK(cargobay_start(robots[i]) == CARGOBAY_OK);
  const int64_t until = truth_of(sims[0]).sim_time_ns + SECONDS(2.5);
  while (truth_of(sims[0]).sim_time_ns < until) {
    for (int turn = 0; turn < kMost; ++turn) {
      const int i = order == backwards ? kMost - 1 - turn : turn;
      if (order == only_the_first && i != 0) continue;
      if (order == only_the_last && i != kMost - 1) continue;
      if (order == by_advance) {
        CHECK(cargobay_sim_advance(sims[i], 7000000) == CARGOBAY_OK);
      } else {
        CHECK(next_state(robots[i], &seen[i]) == CARGOBAY_OK);
      }
      /* One clock. */
      CHECK(truth_of(sims[0]).sim_time_ns == truth_of(sims[1]).sim_time_ns);
      CHECK(truth_of(sims[0]).sim_time_ns == truth_of(sims[2]).sim_time_ns);
    }
  }
  for (int i = 0; i < kMost; ++i) {
    drive->states[i][0].size = sizeof drive->states[i][0];
    drive->count[i] = cargobay_get_history(robots[i], -1, drive->states[i], 200);
    CHECK(drive->count[i] > 150 && followers[i].calls >= drive->count[i]);
  }
  close_all(robots, sims, kMost);
}

/* However a program waits, each loop sees and does the same. */
static void the_order_of_waiting_does_not_matter(uint32_t last_baud) {
  static struct drive first;
  static struct drive other;
  run(in_turn, last_baud, &first);
  for (int i = 0; i < kMost; ++i) {
    for (int k = 1; k < first.count[i]; ++k) {
      CHECK(first.states[i][k].tick == first.states[i][k - 1].tick + 1);
      if (k == 1) continue; /* the first frame had come before the start */
      /* Each is answered when it comes. */
      const int64_t apart = first.states[i][k].arrival_ns - first.states[i][k - 1].arrival_ns;
      CHECK(apart > kTickNs - 2000000 && apart < kTickNs + 2000000);
    }
  }
  for (enum order order = backwards; order <= by_advance; ++order) {
    run(order, last_baud, &other);
    for (int i = 0; i < kMost; ++i) {
      const int common = first.count[i] < other.count[i] ? first.count[i] : other.count[i];
      for (int k = 0; k < common; ++k) {
        if (memcmp(&first.states[i][k], &other.states[i][k], sizeof first.states[i][k]) == 0)
          continue;
        fprintf(stderr, "robot %d, order %d, state %d: not the same\n", i, (int)order, k);
        exit(1);
      }
    }
  }
}

int main(void) {
  the_order_of_waiting_does_not_matter(0);
  the_order_of_waiting_does_not_matter(115200); /* its bytes are spaced */
  return 0;
}
