/* The descriptor to poll: readable after a frame, an event and the end, quiet otherwise; two robots
 * in one poll; and a program that closes it by mistake has its own files spared. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <poll.h>
#include <stdbool.h>
#include <sys/stat.h>
#include <unistd.h>

#include "check.h"

static struct cargobay_robot* own_robot(void) {
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  return robot;
}

static bool is_readable(int fd, int timeout_ms) {
  struct pollfd one = {fd, POLLIN, 0};
  const int ready = poll(&one, 1, timeout_ms);
  CHECK(ready >= 0 && (one.revents & (POLLERR | POLLNVAL)) == 0);
  return ready == 1;
}

/* Takes the bell back, as the header says: 8 bytes before one looks. */
static void read_bell(int fd) {
  uint64_t rings = 0;
  CHECK(read(fd, &rings, sizeof rings) == (ssize_t)sizeof rings && rings > 0);
}

static void rings_for_frames_and_the_end(void) {
  struct cargobay_robot* robot = own_robot();
  uint64_t rings = 0;
  UNSEEN(state);
  const int fd = cargobay_get_fd(robot);
  CHECK(fd >= 3 && cargobay_get_fd(robot) == fd); /* it has one */
  CHECK((fcntl(fd, F_GETFL) & O_NONBLOCK) != 0 && (fcntl(fd, F_GETFD) & FD_CLOEXEC) != 0);
  CHECK(!is_readable(fd, 50)); /* nothing happens before the start */
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 30; ++i) {
    CHECK(is_readable(fd, 5000));
    read_bell(fd);
    const int got = cargobay_wait(robot, state.tick, 0, &state);
    CHECK(got == CARGOBAY_OK || got == CARGOBAY_E_TIMEOUT); /* an event may have rung */
  }
  CHECK(state.tick > 10);
  CHECK(cargobay_request_end(robot) == CARGOBAY_OK);
  int got = CARGOBAY_OK;
  while (got == CARGOBAY_OK || got == CARGOBAY_E_TIMEOUT) {
    CHECK(is_readable(fd, 5000)); /* the end rings, too */
    read_bell(fd);
    got = cargobay_wait(robot, state.tick, 0, &state);
  }
  CHECK(got == CARGOBAY_ENDED);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  while (read(fd, &rings, sizeof rings) > 0) {
  }
  CHECK(!is_readable(fd, 100)); /* quiet: nothing happens any more */
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(cargobay_get_fd(robot) == fd && is_readable(fd, 5000)); /* the same, after a new start */
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(fcntl(fd, F_GETFD) < 0); /* the library has closed it */
}

/* An event is told by the bell, and so is an end that nobody asked for. */
static void rings_for_events(void) {
  struct cargobay_sim* sim = NULL;
  CHECK(cargobay_sim_open(NULL, &sim) == CARGOBAY_OK);
  struct cargobay_robot* robot = robot_of(sim, 0);
  const int fd = cargobay_get_fd(robot);
  int got = 0;
  SIZED(cargobay_event, event);
  SIZED(cargobay_end_report, end);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "bump left", NULL, 0) >= 0);
  do {
    CHECK(is_readable(fd, 5000));
    read_bell(fd);
    got = cargobay_next_event(robot, event.sequence, &event);
    CHECK(got >= 0);
  } while (got == 0 || event.kind != CARGOBAY_EVENT_BUMP_BEGAN);
  CHECK(cargobay_sim_inject(sim, "wheeldrop left on", NULL, 0) >= 0);
  while (end.ended == 0) {
    CHECK(is_readable(fd, 5000));
    read_bell(fd);
    CHECK(cargobay_get_end(robot, &end) == CARGOBAY_OK);
  }
  CHECK(end.code == CARGOBAY_E_MODE);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* Whichever frame comes first. */
static void two_robots_in_one_poll(void) {
  struct cargobay_robot* robots[2] = {own_robot(), own_robot()};
  struct cargobay_state states[2];
  struct pollfd both[2];
  int frames[2] = {0, 0};
  memset(states, 0, sizeof states);
  for (int i = 0; i < 2; ++i) {
    states[i].size = sizeof states[i];
    states[i].tick = -1;
    both[i] = (struct pollfd){cargobay_get_fd(robots[i]), POLLIN, 0};
    CHECK(cargobay_start(robots[i]) == CARGOBAY_OK);
  }
  CHECK(both[0].fd != both[1].fd);
  while (frames[0] < 20 || frames[1] < 20) {
    CHECK(poll(both, 2, 5000) > 0);
    for (int i = 0; i < 2; ++i) {
      if (both[i].revents == 0) continue;
      read_bell(both[i].fd);
      const int got = cargobay_wait(robots[i], states[i].tick, 0, &states[i]);
      CHECK(got == CARGOBAY_OK || got == CARGOBAY_E_TIMEOUT);
      frames[i] += got == CARGOBAY_OK;
    }
  }
  for (int i = 0; i < 2; ++i) CHECK(cargobay_close(robots[i]) == CARGOBAY_OK);
}

/* The program closes the descriptor, and its number belongs to a file then: neither the loop nor
 * the close touches that. */
static void spares_the_programs_files(void) {
  char path[] = "/tmp/cargobay-capi-XXXXXX";
  struct cargobay_robot* robot = own_robot();
  struct stat status;
  UNSEEN(state);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  const int fd = cargobay_get_fd(robot);
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  CHECK(close(fd) == 0);
  int file = mkstemp(path);
  CHECK(file >= 0);
  if (file != fd) {
    CHECK(dup2(file, fd) == fd && close(file) == 0);
    file = fd;
  }
  for (int i = 0; i < 30; ++i) CHECK(next_state(robot, &state) == CARGOBAY_OK);
  CHECK(fstat(file, &status) == 0 && status.st_size == 0);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(fcntl(file, F_GETFD) >= 0); /* still open: it is the program's */
  CHECK(fstat(file, &status) == 0 && status.st_size == 0);
  CHECK(close(file) == 0 && unlink(path) == 0);
}

/* How many this process has open. */
static int descriptors(void) {
  int count = 0;
  for (int fd = 0; fd < 1024; ++fd) count += fcntl(fd, F_GETFD) >= 0;
  return count;
}

/* It costs nothing until asked for: no descriptor is made before. */
static void is_made_when_asked_for(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  CHECK_FAILS(cargobay_get_fd(robot), CARGOBAY_E_UNSUPPORTED, "virtual time");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  robot = own_robot();
  const int before = descriptors();
  CHECK(cargobay_get_fd(robot) > 2 && descriptors() == before + 1);
  CHECK(cargobay_get_fd(robot) > 2 && descriptors() == before + 1);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

int main(void) {
  is_made_when_asked_for();
  rings_for_frames_and_the_end();
  rings_for_events();
  two_robots_in_one_poll();
  spares_the_programs_files();
  return 0;
}
