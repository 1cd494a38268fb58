/* The rule of structs that grow: one of an older program is short, one of a newer is long. */
#include <stddef.h>
#include <string.h>

#include "check.h"

/* As an older header might have had it: it ends early, and something else follows. */
struct short_state {
  uint32_t size;
  int32_t mode;
  int64_t tick;
  uint64_t not_the_librarys;
};
/* As a newer one might. */
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

int main(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  struct short_state less;
  struct long_state more;
  struct short_options old;
  struct long_options new;

  memset(&new, 0, sizeof new);
  new.known.size = sizeof new;
  new.known.flags = CARGOBAY_NO_CONFIG;
  new.known.sim = sim;
  new.of_the_future = 1;
  CHECK_FAILS(cargobay_open(&new.known, &robot), CARGOBAY_E_ARGUMENT, "newer library");
  new.of_the_future = 0;
  CHECK(cargobay_open(&new.known, &robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);

  /* What lies behind it is not looked at. */
  memset(&old, 0xa5, sizeof old);
  old.size = offsetof(struct short_options, not_the_librarys);
  old.flags = CARGOBAY_NO_CONFIG;
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

  more.known.size = 3;
  CHECK_FAILS(cargobay_get_state(robot, &more.known), CARGOBAY_E_ARGUMENT, "`size`");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  return 0;
}
