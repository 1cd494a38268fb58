/* The rule of structs that grow: that of an older program is short, that of a newer one long. */
#include <stddef.h>

#include "check.h"

/* As in an older header: it ends early, and something else follows. */
struct short_state {
  uint32_t size;
  int32_t mode;
  int64_t tick;
  uint64_t not_the_librarys;
};
/* As in a newer header. */
struct long_state {
  struct cargobay_state known;
  uint64_t of_the_future[3];
};
struct long_options {
  struct cargobay_options known;
  uint32_t of_the_future;
};
struct short_options {
  uint32_t size;
  uint32_t flags;
  const char* port;
  struct cargobay_sim* sim;
  uint8_t not_the_librarys[500];
};

/* What is there if nothing set it. */
static const uint32_t kNoSizes[] = {0, 1, 3, 0x7fffffff, 0x80000000, ~UINT32_C(0)};
/* How much longer a later version may have made a struct. */
enum { kMostGrowth = 4096 };

/* The struct, with all the room that it may ask for, and something after that. */
static union {
  uint32_t size;
  uint64_t aligned;
  unsigned char bytes[64 * 1024];
} room;

/* Each struct that is given or filled, by the function that does. */
#define REFUSES_SIZES(type, call)                                           \
  do {                                                                      \
    struct type* const given = (struct type*)(void*)room.bytes;             \
    for (size_t i = 0; i < sizeof kNoSizes / sizeof kNoSizes[0]; ++i) {     \
      memset(room.bytes, 0, sizeof room.bytes);                             \
      given->size = kNoSizes[i];                                            \
      CHECK_FAILS(call, CARGOBAY_E_ARGUMENT, "");                           \
    }                                                                       \
    memset(room.bytes, 0, sizeof room.bytes);                               \
    given->size = sizeof *given + kMostGrowth + 1;                          \
    room.bytes[sizeof *given + 8] = 0xa5;                                   \
    CHECK_FAILS(call, CARGOBAY_E_ARGUMENT, "");                             \
    CHECK(room.bytes[sizeof *given + 8] == 0xa5); /* nothing was written */ \
  } while (0)

#define FILLS_TO_THE_END(type, call, result)                    \
  do {                                                          \
    struct type* const given = (struct type*)(void*)room.bytes; \
    memset(room.bytes, 0xa5, sizeof room.bytes);                \
    given->size = sizeof *given + kMostGrowth;                  \
    CHECK((call) == (result));                                  \
    CHECK(room.bytes[sizeof *given + kMostGrowth - 1] == 0);    \
    CHECK(room.bytes[sizeof *given + kMostGrowth] == 0xa5);     \
  } while (0)

static void have_an_upper_bound(struct cargobay_sim* sim, struct cargobay_robot* robot) {
  char text[200];
  struct cargobay_robot* other = NULL;
  struct cargobay_sim* more = NULL;
  struct cargobay_histogram* histogram = NULL;
  CHECK(cargobay_histogram_open(&histogram) == CARGOBAY_OK);
  REFUSES_SIZES(cargobay_options, cargobay_open(given, &other));
  REFUSES_SIZES(cargobay_sim_options, cargobay_sim_open(given, &more));
  CHECK(other == NULL && more == NULL);
  REFUSES_SIZES(cargobay_truth, cargobay_sim_get_truth(sim, given));
  REFUSES_SIZES(cargobay_bring_up, cargobay_get_bring_up(robot, given));
  REFUSES_SIZES(cargobay_state, cargobay_get_state(robot, given));
  REFUSES_SIZES(cargobay_state, cargobay_wait(robot, -1, SECONDS(1), given));
  REFUSES_SIZES(cargobay_event, cargobay_next_event(robot, 0, given));
  REFUSES_SIZES(cargobay_event, cargobay_describe_event(given, text, sizeof text));
  REFUSES_SIZES(cargobay_state, cargobay_get_history(robot, -1, given, 2));
  REFUSES_SIZES(cargobay_info, cargobay_get_info(robot, given));
  REFUSES_SIZES(cargobay_end_report, cargobay_get_end(robot, given));
  REFUSES_SIZES(cargobay_setting, cargobay_get_setting(0, given));
  REFUSES_SIZES(cargobay_learnt, cargobay_get_learnt(robot, given));
  REFUSES_SIZES(cargobay_statistics, cargobay_get_statistics(robot, given));
  REFUSES_SIZES(cargobay_distribution, cargobay_histogram_get(histogram, given));

  FILLS_TO_THE_END(cargobay_truth, cargobay_sim_get_truth(sim, given), CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_bring_up, cargobay_get_bring_up(robot, given), CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_state, cargobay_wait(robot, -1, SECONDS(1), given), CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_state, cargobay_get_history(robot, 0, given, 1), 1);
  FILLS_TO_THE_END(cargobay_info, cargobay_get_info(robot, given), CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_end_report, cargobay_get_end(robot, given), CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_setting, cargobay_get_setting(0, given), CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_learnt, cargobay_get_learnt(robot, given), CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_statistics, cargobay_get_statistics(robot, given), CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_distribution, cargobay_histogram_get(histogram, given), CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "bump left", NULL, 0) >= 0);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  FILLS_TO_THE_END(cargobay_event, cargobay_next_event(robot, 0, given), 1);
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
}

/* states[0].size says how long each of them is, shorter or longer than the library's. */
static void history_has_the_callers_size(struct cargobay_robot* robot) {
  struct {
    uint32_t size;
    int32_t mode;
    int64_t tick;
  } less[8];
  struct long_state more[4];
  memset(less, 0xa5, sizeof less);
  less[0].size = sizeof less[0];
  CHECK(cargobay_get_history(robot, 2, (struct cargobay_state*)(void*)less, 7) == 7);
  for (int i = 0; i < 7; ++i) {
    CHECK(less[i].tick == 3 + i && less[i].size == sizeof less[0]);
    CHECK(less[i].mode == CARGOBAY_MODE_SAFE);
  }
  CHECK(less[7].size == 0xa5a5a5a5); /* nothing beyond what was asked for */
  memset(more, 0xa5, sizeof more);
  more[0].known.size = sizeof more[0];
  CHECK(cargobay_get_history(robot, 2, &more[0].known, 3) == 3);
  for (int i = 0; i < 3; ++i) {
    CHECK(more[i].known.tick == 3 + i && more[i].known.size == sizeof more[0]);
    for (int k = 0; k < 3; ++k) CHECK(more[i].of_the_future[k] == 0);
  }
  CHECK(more[3].of_the_future[2] == UINT64_C(0xa5a5a5a5a5a5a5a5));
}

int main(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  struct short_state less;
  struct long_state more;
  struct short_options old;
  struct long_options new;

  memset(&new, 0, sizeof new);
  new.known.size = sizeof new;
  new.known.flags = CARGOBAY_FLAG_NO_CONFIG;
  new.known.sim = sim;
  new.of_the_future = 1;
  CHECK_FAILS(cargobay_open(&new.known, &robot), CARGOBAY_E_ARGUMENT, "newer library");
  new.of_the_future = 0;
  CHECK(cargobay_open(&new.known, &robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);

  /* What follows it is not looked at. */
  memset(&old, 0xa5, sizeof old);
  old.size = offsetof(struct short_options, not_the_librarys);
  old.flags = CARGOBAY_FLAG_NO_CONFIG;
  old.port = NULL;
  old.sim = sim;
  CHECK(cargobay_open((const struct cargobay_options*)(const void*)&old, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);

  less.size = offsetof(struct short_state, not_the_librarys);
  less.mode = -1;
  less.not_the_librarys = 0x1234567890abcdef;
  CHECK(cargobay_get_state(robot, (struct cargobay_state*)(void*)&less) == CARGOBAY_OK);
  CHECK(less.mode == CARGOBAY_MODE_SAFE && less.tick > 5);
  CHECK(less.not_the_librarys == 0x1234567890abcdef);
  CHECK(less.size == offsetof(struct short_state, not_the_librarys));

  memset(&more, 0xa5, sizeof more);
  more.known.size = sizeof more;
  CHECK(cargobay_get_state(robot, &more.known) == CARGOBAY_OK);
  CHECK(more.known.tick == less.tick && more.known.size == sizeof more);
  for (int i = 0; i < 3; ++i) CHECK(more.of_the_future[i] == 0);

  history_has_the_callers_size(robot);
  more.known.size = 3;
  CHECK_FAILS(cargobay_get_state(robot, &more.known), CARGOBAY_E_ARGUMENT, "`size`");
  have_an_upper_bound(sim, robot);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  return 0;
}
