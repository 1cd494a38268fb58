/* A program that owns a robot and ends in one of the ways in which programs end.
 *
 * usage: owner PORT opened|driving WAY [FILE]
 * It ends after cargobay_open(), or after half a second of driving. It prints what it sees, one
 * line each: "open", "driving", "wait CODE FRAMES", "stop CODE MS", "close CODE MS". */
#define _GNU_SOURCE
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "hal/c/cargobay.h"

static struct cargobay_robot* robot;
static int has_control;
static volatile int endless; /* 1: the control function no longer returns */

static double now_ms(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

static void say(const char* line) {
  puts(line);
  fflush(stdout);
}

static int complain(const char* what, int code) {
  fprintf(stderr, "%s: %d: %s\n", what, code, cargobay_error_message());
  return 1;
}

static int control(void* context, const struct cargobay_state* state,
                   struct cargobay_output* output) {
  (void)context;
  (void)state;
  while (endless) {
  }
  output->wheels.left_mm_s = output->wheels.right_mm_s = 200.0;
  return 0;
}

/* Drives until that many frames have come, or the loop has ended; returns the last code. */
static int drive(int frames, int* driven) {
  static struct cargobay_state state = {.size = sizeof state, .tick = -1};
  for (*driven = 0; *driven < frames; ++*driven) {
    int error = has_control ? 0 : cargobay_drive(robot, 200.0, 0.0);
    if (error == 0) error = cargobay_wait(robot, state.tick, 1000000000, &state);
    if (error != 0) return error;
  }
  return 0;
}

/* Stops and closes properly. */
static int finish(void) {
  double begin = now_ms();
  const int stopped = cargobay_end(robot);
  printf("stop %d %.0f\n", stopped, now_ms() - begin);
  if (stopped != 0) (void)complain("stop", stopped);
  begin = now_ms();
  const int closed = cargobay_close(robot);
  printf("close %d %.0f\n", closed, now_ms() - begin);
  fflush(stdout);
  return stopped != 0 || closed != 0;
}

/* Drives on until the library reports that it is over. */
static int until_the_end(void) {
  int frames;
  const int waited = drive(2000, &frames);
  printf("wait %d %d\n", waited, frames);
  if (waited != 0) (void)complain("wait", waited);
  return finish() != 0 || waited != 0;
}

/* What code that makes a daemon does; each number then belongs to `file`, if there is one. */
static void take_descriptors(const char* path, int terminal) {
  static int was_open[65536];
  int count = 0;
  struct rlimit limit;
  getrlimit(RLIMIT_NOFILE, &limit);
  const int end = limit.rlim_cur < 65536 ? (int)limit.rlim_cur : 65536;
  for (int i = 3; i < end; ++i) {
    if (fcntl(i, F_GETFD) >= 0) was_open[count++] = i;
  }
  close_range(3, ~0U, 0);
  int file = -1;
  if (path != NULL) file = open(path, O_RDWR | O_CREAT | O_APPEND, 0600);
  if (terminal) {
    const int master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    grantpt(master);
    unlockpt(master);
    file = open(ptsname(master), O_RDWR | O_NOCTTY | O_NONBLOCK);
    /* Out of the range of the numbers that are taken below. */
    fcntl(master, F_DUPFD, 1000);
  }
  for (int i = 0; i < count && file >= 0; ++i) {
    if (was_open[i] != file) dup2(file, was_open[i]);
  }
}

/* The user's terminal must not have received a byte either. */
static int bytes_at_terminal(void) {
  char bytes[4096];
  const ssize_t count = read(1000, bytes, sizeof bytes);
  return count > 0 ? (int)count : 0;
}

/* Starts after the observer has had a second for its own actions. */
static int start_late(void) {
  sleep(1);
  const int code = cargobay_start(robot);
  if (code == 0) return until_the_end();
  (void)complain("start", code);
  return finish() != 0 || code != 0;
}

static int end_by(const char* way, const char* file) {
  if (strcmp(way, "return") == 0) return 0;
  if (strcmp(way, "exit") == 0) exit(3);
  if (strcmp(way, "_exit") == 0) _exit(3);
  if (strcmp(way, "abort") == 0) abort();
  if (strcmp(way, "segv") == 0) raise(SIGSEGV);
  if (strcmp(way, "until_the_end") == 0) return until_the_end();
  if (strcmp(way, "finish") == 0) return finish();
  if (strcmp(way, "start_late") == 0) return start_late();
  if (strcmp(way, "exec") == 0) execlp("sleep", "sleep", "20", (char*)NULL);
  if (strcmp(way, "close_range") == 0) {
    take_descriptors(NULL, 0);
    return until_the_end();
  }
  if (strcmp(way, "reuse") == 0) {
    take_descriptors(file, 0);
    return until_the_end();
  }
  if (strcmp(way, "reuse_terminal") == 0) {
    take_descriptors(NULL, 1);
    const int result = until_the_end();
    printf("terminal %d\n", bytes_at_terminal());
    return result;
  }
  if (strcmp(way, "endless") == 0) {
    endless = 1;
    return until_the_end();
  }
  if (strcmp(way, "fork") == 0 || strcmp(way, "fork_return") == 0) {
    const pid_t child = fork();
    if (child == 0) {
      sleep(20);
      _exit(0);
    }
    printf("child %d\n", (int)child);
    fflush(stdout);
    if (strcmp(way, "fork_return") == 0) return 0;
  }
  for (int frames;;) { /* "drive", "fork": until it is killed */
    if (drive(1000000, &frames) != 0) pause();
  }
}

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  const struct rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const struct cargobay_options options = {
      .size = sizeof options, .flags = CARGOBAY_FLAG_NO_CONFIG, .port = argv[1]};
  int code = cargobay_open(&options, &robot);
  if (code != 0) return complain("open", code);
  say("open");
  if (strcmp(argv[2], "driving") == 0) {
    has_control = strcmp(argv[3], "endless") == 0;
    if (has_control) cargobay_set_control(robot, control, NULL);
    int frames;
    code = cargobay_start(robot);
    if (code == 0) code = drive(40, &frames);
    if (code != 0) {
      (void)complain("drive", code);
      cargobay_close(robot);
      return 1;
    }
    say("driving");
  } else if (strcmp(argv[3], "drive") == 0) {
    for (;;) pause();
  }
  return end_by(argv[3], argc > 4 ? argv[4] : NULL);
}
