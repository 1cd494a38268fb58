/* A8: who opens a robot may give up; A7: the message of a failed open is in the caller's own
 * buffer; A14: what kind of robot it is; and a port that the program has opened itself. */
#define _GNU_SOURCE
#include <fcntl.h>
#include <math.h>
#include <stdbool.h>
#include <unistd.h>

#include "check.h"

/* ---- giving up ---- */

struct watcher {
  struct cargobay_sim* sim;
  int calls;
  int patience; /* calls until it gives up; 0: never does */
  int64_t last_ns;
  int64_t longest_ns; /* between two calls, of the virtual Create's time */
  bool steps_have_names;
};

static int64_t now_ns(struct cargobay_sim* sim) {
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK);
  return truth.sim_time_ns;
}

static int watches(void* context, const char* step, const char* detail) {
  struct watcher* self = context;
  const int64_t now = now_ns(self->sim);
  CHECK(step != NULL && detail != NULL);
  if (strlen(step) > 0) self->steps_have_names = true;
  if (self->calls > 0 && now - self->last_ns > self->longest_ns)
    self->longest_ns = now - self->last_ns;
  self->last_ns = now;
  ++self->calls;
  return self->calls == self->patience ? 5 : 0;
}

static int open_watched(struct watcher* watcher, struct cargobay_robot** robot, char* message,
                        uint32_t message_size) {
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = watcher->sim;
  options.progress = watches;
  options.progress_context = watcher;
  options.message = message;
  options.message_size = message_size;
  return cargobay_open(&options, robot);
}

/* A robot that does not answer: without patience, 40 s of trying everything; with it, at once. */
static void may_be_given_up(void) {
  struct cargobay_robot* robot = NULL;
  struct watcher watcher;
  int whole;
  memset(&watcher, 0, sizeof watcher);
  watcher.sim = virtual_sim();
  CHECK(cargobay_sim_inject(watcher.sim, "fault unplugged", NULL, 0) >= 0);
  int64_t began = now_ns(watcher.sim);
  CHECK(open_watched(&watcher, &robot, NULL, 0) == CARGOBAY_E_SILENT);
  whole = watcher.calls;
  CHECK(now_ns(watcher.sim) - began > SECONDS(5) && whole > 50 && watcher.steps_have_names);
  CHECK(watcher.longest_ns <= SECONDS(0.1));
  for (int patience = 1; patience < whole; patience += 1 + patience / 2) {
    watcher.calls = 0;
    watcher.patience = patience;
    CHECK_FAILS(open_watched(&watcher, &robot, NULL, 0), CARGOBAY_E_CANCELLED, "progress");
    CHECK(robot == NULL && watcher.calls == patience); /* not asked again */
    CHECK(now_ns(watcher.sim) - watcher.last_ns < SECONDS(1));
  }
  /* Nothing is left behind: it opens once it answers. */
  CHECK(cargobay_sim_inject(watcher.sim, "fault replugged", NULL, 0) >= 0);
  watcher.patience = watcher.calls = 0;
  CHECK(open_watched(&watcher, &robot, NULL, 0) == CARGOBAY_OK && watcher.calls > 1);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(watcher.sim) == CARGOBAY_OK);
}

/* It is also asked while a second start brings the robot up again. */
static void may_be_given_up_at_a_second_start(void) {
  struct cargobay_robot* robot = NULL;
  struct watcher watcher;
  UNSEEN(state);
  memset(&watcher, 0, sizeof watcher);
  watcher.sim = virtual_sim();
  CHECK(open_watched(&watcher, &robot, NULL, 0) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK && next_state(robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  watcher.calls = 0;
  watcher.patience = 1;
  CHECK_FAILS(cargobay_start(robot), CARGOBAY_E_CANCELLED, "progress");
  watcher.patience = 0;
  CHECK(cargobay_start(robot) == CARGOBAY_OK && next_state(robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(watcher.sim) == CARGOBAY_OK);
}

/* ---- the message ---- */

static void leaves_its_message(void) {
  char message[200];
  char first[10];
  struct cargobay_robot* robot = NULL;
  struct watcher watcher;
  memset(&watcher, 0, sizeof watcher);
  memset(message, 'x', sizeof message);
  memset(first, 'x', sizeof first);
  watcher.sim = virtual_sim();
  watcher.patience = 1;
  CHECK(open_watched(&watcher, &robot, message, sizeof message) == CARGOBAY_E_CANCELLED);
  CHECK(strlen(message) > 20 && strcmp(message, cargobay_error_message()) == 0);
  watcher.calls = 0;
  CHECK(open_watched(&watcher, &robot, first, 6) == CARGOBAY_E_CANCELLED);
  CHECK(strlen(first) == 5 && strncmp(first, message, 5) == 0 && first[6] == 'x');
  watcher.calls = 0;
  CHECK(open_watched(&watcher, &robot, first, 0) == CARGOBAY_E_CANCELLED);
  CHECK(strlen(first) == 5);

  /* Also if the options themselves are wrong. */
  {
    SIZED(cargobay_options, options);
    options.message = message;
    options.message_size = sizeof message;
    options.priority = 99;
    CHECK(cargobay_open(&options, &robot) == CARGOBAY_E_ARGUMENT);
    CHECK(strstr(message, "`priority`") != NULL);
  }
  watcher.patience = 0;
  CHECK(open_watched(&watcher, &robot, message, sizeof message) == CARGOBAY_OK);
  CHECK(strcmp(message, "") == 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(watcher.sim) == CARGOBAY_OK);
}

/* ---- what it is ---- */

static struct cargobay_info info_at(uint32_t baud, const char* settings) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_info, info);
  SIZED(cargobay_options, options);
  options.sim = sim;
  options.baud = baud;
  options.settings = settings;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_get_info(robot, &info) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  return info;
}

static void is_known(void) {
  const uint32_t every_feature = (1u << 7) - 1;
  struct cargobay_info info = info_at(0, NULL);
  struct cargobay_robot* robot = NULL;
  CHECK(strcmp(info.model, "iRobot Create") == 0);
  CHECK(info.tick_ns == 15000000 && info.wheel_base_mm == 258.0 && info.max_wheel_mm_s == 500.0);
  CHECK(info.song_slots == 16 && info.song_notes == 16 && info.script_bytes == 100);
  CHECK(info.baud == 57600 && info.spare_bytes == 52 && info.reserved == 0);
  CHECK(info.features == every_feature);
  info = info_at(19200, "robot.wheel_base_mm = 300");
  CHECK(info.baud == 19200 && info.spare_bytes == 12 && info.wheel_base_mm == 300.0);
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_get_info(robot, &info) == CARGOBAY_OK);
  CHECK(info.features == (every_feature & ~(uint32_t)CARGOBAY_FEATURE_VIRTUAL_TIME));
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

/* With the wheel base that this robot's settings state, and within its speed. */
static void knows_its_wheel_base(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  struct cargobay_wheels wheels;
  const struct cargobay_twist turn = {0.0, 1.0};
  const struct cargobay_twist fast = {500.0, 1.0}; /* 350 and 650 */
  UNSEEN(state);
  SIZED(cargobay_options, options);
  options.sim = sim;
  options.settings = "robot.wheel_base_mm = 300";
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_wheels_of(robot, turn, &wheels) == CARGOBAY_OK);
  CHECK(wheels.left_mm_s == -150.0 && wheels.right_mm_s == 150.0);
  CHECK(cargobay_wheels_of(robot, fast, &wheels) == CARGOBAY_OK);
  CHECK(fabs(wheels.right_mm_s - 500.0) < 1e-9);
  CHECK(fabs(wheels.left_mm_s - 350.0 * 500.0 / 650.0) < 1e-9);
  CHECK(cargobay_start(robot) == CARGOBAY_OK && next_state(robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_drive(robot, 500.0, 1.0) == CARGOBAY_OK);
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  /* As cargobay_drive() does. */
  CHECK(fabs(state.target.left_mm_s - wheels.left_mm_s) < 0.001);
  CHECK(fabs(state.target.right_mm_s - wheels.right_mm_s) < 0.001);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* ---- a port that is already open ---- */

static void takes_an_open_port(void) {
  char path[64];
  struct cargobay_sim* sim = NULL;
  struct cargobay_robot* robot = NULL;
  UNSEEN(state);
  SIZED(cargobay_options, options);
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_sim_open(NULL, &sim) == CARGOBAY_OK);
  CHECK(cargobay_sim_get_path(sim, path, sizeof path) > 5);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.port_fd = open(path, O_RDWR | O_NOCTTY);
  CHECK(options.port_fd > 2);
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(close(options.port_fd) == 0); /* it has its own */
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 30; ++i) {
    CHECK(cargobay_drive(robot, 200.0, 0.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK && truth.commanded_left_mm_s > 0);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  options.port_fd = open("/dev/null", O_RDWR);
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_NO_PORT, "terminal");
  CHECK(close(options.port_fd) == 0);
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_NO_PORT, ""); /* closed */
  options.port_fd = open(path, O_RDWR | O_NOCTTY);
  options.port = path;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_ARGUMENT, "`port_fd`");
  CHECK(close(options.port_fd) == 0 && robot == NULL);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

int main(void) {
  may_be_given_up();
  may_be_given_up_at_a_second_start();
  leaves_its_message();
  is_known();
  knows_its_wheel_base();
  takes_an_open_port();
  return 0;
}
