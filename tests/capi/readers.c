/* A2: any number of readers of states, each of which says what it has seen. In virtual time, one
 * after the other; then eight threads in real time, in random turns:
 *
 *     readers [--waits N]   so many waits by the eight together; 20000 without it
 */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>

#include "check.h"

static int64_t sim_time_of(struct cargobay_sim* sim) {
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  return truth.sim_time_ns;
}

/* A wait with timeout 0 is a look: virtual time stands still, and the state is left alone. */
static void looking_takes_no_time(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  struct cargobay_state before;
  UNSEEN(state);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  const int64_t opened = sim_time_of(sim);
  CHECK(cargobay_wait(robot, -1, 0, &state) == CARGOBAY_E_TIMEOUT); /* there is no frame yet */
  CHECK(state.tick == -1 && sim_time_of(sim) == opened);
  CHECK(next_state(robot, &state) == CARGOBAY_OK && state.tick == 0);
  const int64_t seen = sim_time_of(sim);
  CHECK(seen > opened);
  before = state;
  for (int i = 0; i < 20; ++i) {
    CHECK(cargobay_wait(robot, state.tick, 0, &state) == CARGOBAY_E_TIMEOUT);
    CHECK(memcmp(&state, &before, sizeof state) == 0);
    CHECK(cargobay_wait(robot, -1, 0, &state) == CARGOBAY_OK);
    CHECK(memcmp(&state, &before, sizeof state) == 0);
    CHECK(cargobay_wait(robot, -1, -1, NULL) == CARGOBAY_OK);
  }
  CHECK(sim_time_of(sim) == seen);
  CHECK(next_state(robot, &state) == CARGOBAY_OK && state.tick == 1);
  CHECK(sim_time_of(sim) > seen);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* Of two that wait in turn, the second gets what the first one's wait brought, without a frame. */
static void takes_turns(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  UNSEEN(one);
  UNSEEN(other);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 100; ++i) {
    struct cargobay_state* const first = i % 3 == 0 ? &other : &one;
    struct cargobay_state* const second = i % 3 == 0 ? &one : &other;
    CHECK(next_state(robot, first) == CARGOBAY_OK && first->tick == i);
    const int64_t now = sim_time_of(sim);
    CHECK(next_state(robot, second) == CARGOBAY_OK && second->tick == i);
    CHECK(sim_time_of(sim) == now);
  }
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static struct cargobay_state history[256];

static int get_history(struct cargobay_robot* robot, int64_t after_tick, size_t count) {
  memset(history, 0, sizeof history);
  history[0].size = sizeof history[0];
  return cargobay_get_history(robot, after_tick, history, count);
}

static void history_fills_the_gap(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  UNSEEN(quick);
  UNSEEN(slow);
  CHECK(get_history(robot, -1, 256) == 0);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(next_state(robot, &slow) == CARGOBAY_OK);
  for (int i = 0; i < 51; ++i) {
    CHECK(cargobay_drive(robot, 200.0, 0.2) == CARGOBAY_OK);
    CHECK(next_state(robot, &quick) == CARGOBAY_OK);
  }
  const int64_t last = slow.tick;
  CHECK(next_state(robot, &slow) == CARGOBAY_OK && slow.tick == last + 50); /* a gap, visible */
  CHECK(get_history(robot, last, 256) == 50);
  for (int i = 0; i < 50; ++i) CHECK(history[i].tick == last + 1 + i);
  CHECK(history[49].x_mm > history[0].x_mm);
  CHECK(memcmp(&history[49], &slow, sizeof slow) == 0);
  CHECK(get_history(robot, last, 10) == 10 && history[9].tick == last + 10); /* the oldest first */
  CHECK(get_history(robot, slow.tick, 256) == 0);
  CHECK(run_for(robot, 10.0) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &slow) == CARGOBAY_OK);
  CHECK(get_history(robot, -1, 256) == 256);
  CHECK(history[0].tick == slow.tick - 255 && history[255].tick == slow.tick);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(get_history(robot, slow.tick - 5, 256) >= 5); /* it outlives the loop */
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* Ticks without a frame have no state: both the wait and the history show it. */
static void shows_lost_frames(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  UNSEEN(state);
  SIZED(cargobay_statistics, counted);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 20; ++i) CHECK(next_state(robot, &state) == CARGOBAY_OK);
  const int64_t before = state.tick;
  CHECK(cargobay_sim_inject(sim, "fault stalled-stream 150", NULL, 0) >= 0);
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK && counted.frames_lost > 5);
  const int count = get_history(robot, before, 256);
  /* The first good frame after a fault only shows which tick it is. */
  CHECK(count > 5 && count + (int64_t)counted.frames_lost + 1 == state.tick - before);
  for (int i = 1; i < count; ++i) CHECK(history[i].tick > history[i - 1].tick);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static int sees_time_pass(void* context, const struct cargobay_state* state,
                          struct cargobay_output* output) {
  (void)context;
  (void)output;
  CHECK(state->elapsed_ns >= 0);
  return 0;
}

/* Frames that come so late that they had been given up: no tick comes twice, nor again. */
static void ticks_only_grow(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  int64_t read = -1;
  UNSEEN(state);
  CHECK(cargobay_set_control(robot, sees_time_pass, NULL) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 1.0) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "fault jitter 50", NULL, 0) >= 0);
  for (int i = 0; i < 2000; ++i) {
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
    if (i % 100 != 99) continue;
    const int count = get_history(robot, read, 256);
    CHECK(count > 50);
    for (int k = 0; k < count; ++k) {
      CHECK(history[k].tick > read && (k == 0 || history[k].elapsed_ns > 0));
      read = history[k].tick;
    }
  }
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* ---- eight threads, in real time ---- */

enum { kThreads = 8 };

struct crowd {
  struct cargobay_robot* robot;
  atomic_long left; /* waits to do */
};

struct reader {
  struct crowd* crowd;
  uint32_t random;
  int64_t first;
  int64_t last;
  int64_t passed; /* ticks, by the gaps that were seen */
  int64_t states; /* that waits and histories gave, each once */
  int64_t unread; /* it fell behind by more than the history holds */
  int end;
  struct cargobay_state between[256];
};

static uint32_t draw(struct reader* self, uint32_t below) {
  self->random = self->random * 1664525u + 1013904223u;
  return (self->random >> 8) % below;
}

/* Everything between two states that a wait gave, by the history; ticks that had no frame are not
 * in it. If this thread was kept from running meanwhile, the oldest may be gone. */
static void fill_gap(struct reader* self, const struct cargobay_state* now) {
  struct cargobay_robot* const robot = self->crowd->robot;
  struct cargobay_state* const between = self->between;
  const int64_t gap = now->tick - self->last;
  int64_t found = 0;
  SIZED(cargobay_state, newest);
  self->passed += gap;
  ++self->states;
  if (gap == 1) return;
  between[0].size = sizeof between[0];
  const int count = cargobay_get_history(robot, self->last, between, gap > 256 ? 256 : (size_t)gap);
  CHECK(count >= 1 && between[0].tick > self->last);
  for (int i = 1; i < count; ++i) CHECK(between[i].tick > between[i - 1].tick);
  while (found < count && between[found].tick < now->tick) ++found;
  self->states += found;
  CHECK(cargobay_get_state(robot, &newest) == CARGOBAY_OK);
  if (newest.tick - self->last >= 255) self->unread += gap - 1 - found;
}

static void* reads_in_random_turns(void* context) {
  struct reader* self = context;
  UNSEEN(state);
  while (atomic_fetch_sub(&self->crowd->left, 1) > 0) {
    const uint32_t turn = draw(self, 64);
    int64_t after = self->last;
    int64_t timeout_ns = 0;
    if (turn == 0) timeout_ns = -1;
    if (turn == 1) timeout_ns = draw(self, 20000000);
    if (turn > 32) after = self->last - 1 - (int64_t)draw(self, 100); /* knows less than it did */
    if (after < -1) after = -1;
    const int got = cargobay_wait(self->crowd->robot, after, timeout_ns, &state);
    self->end = got;
    if (got == CARGOBAY_E_TIMEOUT) continue;
    if (got != CARGOBAY_OK) break;
    CHECK(state.tick > after && state.tick >= self->last);
    if (self->first < 0) {
      self->first = self->last = state.tick;
      self->states = 1;
    }
    if (state.tick > self->last) fill_gap(self, &state);
    self->last = state.tick;
  }
  return NULL;
}

static void eight_threads_read(long waits) {
  static struct crowd crowd;
  static struct reader readers[kThreads];
  pthread_t threads[kThreads];
  SIZED(cargobay_options, options);
  SIZED(cargobay_statistics, counted);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.guard_deadline_ns = SECONDS(10); /* a busy machine is no failure here */
  options.link_timeout_ns = SECONDS(60);
  CHECK(cargobay_open(&options, &crowd.robot) == CARGOBAY_OK);
  CHECK(cargobay_start(crowd.robot) == CARGOBAY_OK);
  atomic_init(&crowd.left, waits);
  for (int i = 0; i < kThreads; ++i) {
    readers[i] =
        (struct reader){.crowd = &crowd, .random = (uint32_t)(i + 1), .first = -1, .last = -1};
    CHECK(pthread_create(&threads[i], NULL, reads_in_random_turns, &readers[i]) == 0);
  }
  int64_t states = 0;
  for (int i = 0; i < kThreads; ++i) {
    CHECK(pthread_join(threads[i], NULL) == 0);
    CHECK(readers[i].end == CARGOBAY_OK || readers[i].end == CARGOBAY_E_TIMEOUT);
    CHECK(readers[i].passed == readers[i].last - readers[i].first);
    states += readers[i].states;
  }
  CHECK(cargobay_get_statistics(crowd.robot, &counted) == CARGOBAY_OK);
  for (int i = 0; i < kThreads; ++i) {
    /* Each tick that one passed has a state, or its frame was lost, damaged or late, or it came
       right after such a one. */
    const int64_t missing = readers[i].passed + 1 - readers[i].states - readers[i].unread;
    const int64_t bad = (int64_t)(counted.frames_lost + counted.frames_bad + counted.frames_late +
                                  counted.overruns_wait);
    if (missing != 0)
      fprintf(stderr, "%lld of %lld ticks are missing, %lld frames were in trouble\n",
              (long long)missing, (long long)readers[i].passed, (long long)bad);
    CHECK(missing >= 0 && missing <= 2 * bad && readers[i].last <= counted.ticks);
  }
  printf("%ld waits by %d threads: %lld ticks, %lld states read, none twice\n", waits, kThreads,
         (long long)counted.ticks, (long long)states);
  CHECK(cargobay_end(crowd.robot) == CARGOBAY_OK);
  CHECK(cargobay_close(crowd.robot) == CARGOBAY_OK);
}

int main(int argc, char** argv) {
  long waits = 20000;
  if (argc == 3 && strcmp(argv[1], "--waits") == 0) waits = atol(argv[2]);
  looking_takes_no_time();
  takes_turns();
  history_fills_the_gap();
  shows_lost_frames();
  ticks_only_grow();
  eight_threads_read(waits);
  return 0;
}
