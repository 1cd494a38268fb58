/* A3: any number of readers of events, each of which says what it has seen; the newest 256 are kept
 * and the newest of each kind, and what is gone shows in the sequence numbers. */
#include <pthread.h>
#include <stdbool.h>

#include "check.h"

enum { kReaders = 4, kMost = 600 };

struct reader {
  struct cargobay_robot* robot;
  int64_t seen;
  int count;
  struct cargobay_event events[kMost];
};

static void read_all(struct reader* self) {
  SIZED(cargobay_event, event);
  int got;
  while ((got = cargobay_next_event(self->robot, self->seen, &event)) == 1) {
    CHECK(self->count < kMost && event.sequence > self->seen);
    self->events[self->count++] = event;
    self->seen = event.sequence;
  }
  CHECK(got == 0);
}

static void bump(struct cargobay_sim* sim, struct cargobay_robot* robot, int times) {
  for (int i = 0; i < times; ++i) {
    CHECK(cargobay_sim_inject(sim, i % 2 == 0 ? "bump left" : "bump none", NULL, 0) >= 0);
    CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  }
}

/* Four that read at their own pace: each frame, now and then, late, and all at once. */
static void all_see_the_same(void) {
  static struct reader readers[kReaders];
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  struct cargobay_event before;
  SIZED(cargobay_event, event);
  SIZED(cargobay_statistics, counted);
  for (int i = 0; i < kReaders; ++i) readers[i].robot = robot;
  before = event;
  CHECK(cargobay_next_event(robot, 0, &event) == 0);
  CHECK(memcmp(&event, &before, sizeof event) == 0); /* unchanged unless there is one */
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  for (int i = 0; i < 40; ++i) {
    CHECK(cargobay_sim_inject(sim, i % 2 == 0 ? "bump both" : "bump none", NULL, 0) >= 0);
    CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
    read_all(&readers[0]);
    if (i % 7 == 3) read_all(&readers[1]);
    if (i >= 20) read_all(&readers[2]);
  }
  for (int i = 0; i < kReaders; ++i) read_all(&readers[i]);
  CHECK(readers[0].count >= 40);
  for (int i = 1; i < kReaders; ++i) {
    CHECK(readers[i].count == readers[0].count);
    CHECK(memcmp(readers[i].events, readers[0].events, sizeof readers[0].events) == 0);
  }
  for (int i = 0; i < readers[0].count; ++i) CHECK(readers[0].events[i].sequence == i + 1);
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK);
  CHECK(counted.events == (uint64_t)readers[0].seen);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* Nobody reads 421 events, the last of which is the loss of the mode. */
static void the_newest_are_kept(void) {
  static struct reader reader;
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, CARGOBAY_FLAG_HOLD_ON_MODE_LOSS);
  SIZED(cargobay_statistics, counted);
  memset(&reader, 0, sizeof reader);
  reader.robot = robot;
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  bump(sim, robot, 420);
  CHECK(cargobay_sim_inject(sim, "wheeldrop left on", NULL, 0) >= 0);
  CHECK(run_for(robot, 0.5) == CARGOBAY_OK);
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK && counted.events >= 421);
  read_all(&reader);
  CHECK(reader.count >= 256 && reader.count < 300);
  CHECK(reader.seen == (int64_t)counted.events);
  const struct cargobay_event* const last = &reader.events[reader.count - 1];
  CHECK(last->kind == CARGOBAY_EVENT_MODE_LOST && last->sequence == reader.seen);
  CHECK(last->hazards == CARGOBAY_HAZARD_WHEEL_DROP_LEFT);
  /* The newest 256 have no gap; those before them are gone, and it shows. */
  for (int i = 0; i < 256; ++i)
    CHECK(reader.events[reader.count - 1 - i].sequence == reader.seen - i);
  CHECK(reader.events[0].sequence > 1);

  /* It is still there under 420 more, as the newest of its kind. */
  CHECK(cargobay_sim_inject(sim, "wheeldrop left off", NULL, 0) >= 0);
  const int64_t lost = last->sequence;
  bump(sim, robot, 420);
  memset(&reader, 0, sizeof reader);
  reader.robot = robot;
  read_all(&reader);
  bool found = false;
  for (int i = 0; i < reader.count; ++i) {
    if (reader.events[i].kind != CARGOBAY_EVENT_MODE_LOST) continue;
    found = reader.events[i].sequence == lost;
    CHECK(reader.events[i].hazards == CARGOBAY_HAZARD_WHEEL_DROP_LEFT);
  }
  CHECK(found && reader.seen > lost + 256);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* The same in real time: each reader has a thread of its own. */
static void* reads_until_the_end(void* context) {
  struct reader* self = context;
  UNSEEN(state);
  while (next_state(self->robot, &state) == CARGOBAY_OK) read_all(self);
  read_all(self);
  return NULL;
}

static void threads_see_the_same(void) {
  static struct reader readers[kReaders];
  pthread_t threads[kReaders];
  struct cargobay_sim* sim = NULL;
  CHECK(cargobay_sim_open(NULL, &sim) == CARGOBAY_OK);
  struct cargobay_robot* robot = robot_of(sim, 0);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < kReaders; ++i) {
    readers[i].robot = robot;
    CHECK(pthread_create(&threads[i], NULL, reads_until_the_end, &readers[i]) == 0);
  }
  bump(sim, robot, 10);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  for (int i = 0; i < kReaders; ++i) CHECK(pthread_join(threads[i], NULL) == 0);
  CHECK(readers[0].count >= 10);
  for (int i = 1; i < kReaders; ++i) {
    CHECK(readers[i].count == readers[0].count);
    CHECK(memcmp(readers[i].events, readers[0].events, sizeof readers[0].events) == 0);
  }
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

int main(void) {
  all_see_the_same();
  the_newest_are_kept();
  threads_see_the_same();
  return 0;
}
