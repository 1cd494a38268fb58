/* A7: every error that can be provoked in virtual time, with its code and a message that says what
 * to do about it. connection.c has those of ports, stalled.c, real_time.c and file_limit.c the
 * rest. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdatomic.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "remedy.h"

static struct cargobay_options options_of(struct cargobay_sim* sim) {
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  return options;
}

static void refuses_a_wrong_order(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* second = NULL;
  const struct cargobay_options options = options_of(sim);
  struct cargobay_robot* robot = robot_of(sim, 0);
  SIZED(cargobay_state, state);
  GIVES(cargobay_open(&options, &second), CARGOBAY_E_BUSY, "another robot");
  CHECK(second == NULL);
  GIVES(cargobay_sim_close(sim), CARGOBAY_E_STATE, "close it first");
  GIVES(cargobay_get_state(robot, &state), CARGOBAY_E_NO_FRAME, "no frame");
  GIVES(cargobay_wait(robot, -1, 0, &state), CARGOBAY_E_STATE, "not started");
  GIVES(cargobay_end(robot), CARGOBAY_E_STATE, "not started");
  GIVES(cargobay_drive(robot, 0.0, 0.0), CARGOBAY_E_STATE, "not started");
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  GIVES(cargobay_get_state(robot, &state), CARGOBAY_E_NO_FRAME, "no frame");
  GIVES(cargobay_start(robot), CARGOBAY_E_STATE, "cargobay_end");
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "fault stalled-stream 300", NULL, 0) >= 0);
  GIVES(cargobay_wait(robot, state.tick, SECONDS(0.1), &state), CARGOBAY_E_TIMEOUT, "in time");
  CHECK(run_for(robot, 0.5) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK);
  CHECK(cargobay_wait(robot, state.tick, 0, &state) == CARGOBAY_ENDED);
  CHECK(cargobay_wait(robot, state.tick, -1, &state) == CARGOBAY_ENDED);
  GIVES(cargobay_drive(robot, 0.0, 0.0), CARGOBAY_E_STATE, "ended");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  GIVES(cargobay_close(robot), CARGOBAY_E_HANDLE, "closed");
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void has_no_such_thing(void) {
  const uint32_t no_packets[] = {43, 58, 106};
  char path[64];
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  struct cargobay_reading reading;
  GIVES(cargobay_sim_get_path(sim, path, sizeof path), CARGOBAY_E_UNSUPPORTED, "virtual time");
  GIVES(cargobay_get_fd(robot), CARGOBAY_E_UNSUPPORTED, "virtual time");
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  for (int i = 0; i < 3; ++i) {
    const uint32_t* packet = &no_packets[i];
    GIVES(cargobay_get_readings(robot, packet, 1, &reading), CARGOBAY_E_UNSUPPORTED, "packet");
    GIVES(cargobay_subscribe(robot, packet, 1), CARGOBAY_E_UNSUPPORTED, "packet");
    GIVES(cargobay_query(robot, *packet, 0, &reading), CARGOBAY_E_UNSUPPORTED, "packet");
  }
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* What the world does to a drive. */
static void ends_by_what_happens(const char* injected, int code, const char* words) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  SIZED(cargobay_truth, truth);
  SIZED(cargobay_end_report, end);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.3) == CARGOBAY_OK);
  CHECK(cargobay_get_end(robot, &end) == CARGOBAY_OK);
  CHECK(end.ended == 0 && end.code == 0 && strcmp(end.message, "") == 0);
  CHECK(cargobay_sim_inject(sim, injected, NULL, 0) >= 0);
  GIVES(run_for(robot, 5.0), code, words);
  GIVES(cargobay_end(robot), code, words);
  GIVES(cargobay_end(robot), code, words); /* a second call returns the same */
  CHECK(cargobay_get_end(robot, &end) == CARGOBAY_OK);
  CHECK(end.ended == 1 && end.code == code && end.control_result == 0);
  CHECK(strstr(end.message, words) != NULL && names_a_remedy(end.message));
  CHECK((end.hazards == CARGOBAY_HAZARD_WHEEL_DROP_LEFT) == (code == CARGOBAY_E_MODE));
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK && truth.left_mm_s == 0.0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* It was told to stop, and all of it was lost on the way: it may be moving. */
static void does_not_confirm(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  SIZED(cargobay_end_report, end);
  SIZED(cargobay_truth, truth);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(cargobay_drive(robot, 200.0, 0.0) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.4) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "fault lost 1 both", NULL, 0) >= 0);
  GIVES(cargobay_end(robot), CARGOBAY_E_UNCONFIRMED, "may be moving");
  CHECK(cargobay_sim_get_truth(sim, &truth) == CARGOBAY_OK && truth.commanded_left_mm_s > 0);
  CHECK(cargobay_get_end(robot, &end) == CARGOBAY_OK);
  CHECK(end.ended == 1 && end.code == CARGOBAY_E_UNCONFIRMED && end.passive_seen == 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void finds_no_file(void) {
  struct cargobay_robot* robot = NULL;
  struct cargobay_sim* sim = NULL;
  struct cargobay_options options = options_of(NULL);
  SIZED(cargobay_sim_options, create);
  options.flags = 0;
  options.config = "/no/such/cargobay.toml";
  GIVES(cargobay_open(&options, &robot), CARGOBAY_E_CONFIG, "/no/such/cargobay.toml");
  create.world = "/no/such.world";
  GIVES(cargobay_sim_open(&create, &sim), CARGOBAY_E_FILE, "/no/such.world");
  create.world = NULL;
  create.link = "/no/such/folder/link";
  GIVES(cargobay_sim_open(&create, &sim), CARGOBAY_E_FILE, "/no/such/folder");
  CHECK(sim == NULL);
  sim = virtual_sim();
  options = options_of(sim);
  options.record = "/no/such/folder/file";
  GIVES(cargobay_open(&options, &robot), CARGOBAY_E_FILE, "/no/such/folder/file");
  CHECK(robot == NULL);
  robot = robot_of(sim, 0);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  GIVES(cargobay_save_recording(robot, "/no/such/folder/file"), CARGOBAY_E_FILE, "/no/such/folder");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void finds_no_robot(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  const struct cargobay_options options = options_of(sim);
  CHECK(cargobay_sim_inject(sim, "fault unplugged", NULL, 0) >= 0);
  GIVES(cargobay_open(&options, &robot), CARGOBAY_E_SILENT, "");
  CHECK(robot == NULL);
  CHECK(cargobay_sim_inject(sim, "fault replugged", NULL, 0) >= 0);
  CHECK(cargobay_sim_inject(sim, "wheeldrop left on", NULL, 0) >= 0);
  GIVES(cargobay_open(&options, &robot), CARGOBAY_E_MODE, "mode");
  CHECK(cargobay_sim_inject(sim, "wheeldrop left off", NULL, 0) >= 0);
  robot = robot_of(sim, 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* Another thread is in a function of the owner's. */
struct crowd {
  struct cargobay_robot* robot;
  atomic_bool inside;
  atomic_bool go_on;
};

static int waits_for_the_other(void* context, const struct cargobay_state* state,
                               struct cargobay_output* output) {
  struct crowd* self = context;
  (void)state;
  (void)output;
  atomic_store(&self->inside, 1);
  while (!atomic_load(&self->go_on)) usleep(1000);
  return 0;
}

static void* steps_once(void* context) {
  struct crowd* self = context;
  CHECK(cargobay_wait(self->robot, -1, SECONDS(1), NULL) == CARGOBAY_OK);
  return NULL;
}

static void has_one_owner(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct crowd crowd = {robot_of(sim, 0), 0, 0};
  pthread_t thread;
  CHECK(cargobay_set_control(crowd.robot, waits_for_the_other, &crowd) == CARGOBAY_OK);
  CHECK(cargobay_start(crowd.robot) == CARGOBAY_OK);
  CHECK(pthread_create(&thread, NULL, steps_once, &crowd) == 0);
  while (!atomic_load(&crowd.inside)) usleep(1000);
  GIVES(cargobay_end(crowd.robot), CARGOBAY_E_THREAD, "another thread");
  GIVES(cargobay_wait(crowd.robot, 1000, 0, NULL), CARGOBAY_E_THREAD, "another thread");
  atomic_store(&crowd.go_on, 1);
  CHECK(pthread_join(thread, NULL) == 0);
  CHECK(cargobay_end(crowd.robot) == CARGOBAY_OK);
  CHECK(cargobay_close(crowd.robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static int fails(void* context, const struct cargobay_state* state,
                 struct cargobay_output* output) {
  (void)context;
  (void)output;
  return state->tick < 10 ? 0 : -7;
}

static int gives_up(void* context, const char* step, const char* detail) {
  (void)context;
  (void)step;
  (void)detail;
  return 1;
}

/* Someone gave up: the control function, or who watches the bring-up. */
static void is_given_up(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  struct cargobay_options options = options_of(sim);
  options.progress = gives_up;
  GIVES(cargobay_open(&options, &robot), CARGOBAY_E_CANCELLED, "progress");
  CHECK(robot == NULL);
  robot = robot_of(sim, 0);
  CHECK(cargobay_set_control(robot, fails, NULL) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK_FAILS(run_for(robot, 1.0), CARGOBAY_E_CONTROL, "-7"); /* what to do, only it knows */
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void runs_out_of_handles(void) {
  struct cargobay_histogram* all[64];
  struct cargobay_histogram* more = NULL;
  struct cargobay_sim* sims[64];
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_sim_options, create);
  create.time = CARGOBAY_SIM_TIME_VIRTUAL;
  for (int i = 0; i < 64; ++i) CHECK(cargobay_histogram_open(&all[i]) == CARGOBAY_OK);
  GIVES(cargobay_histogram_open(&more), CARGOBAY_E_LIMIT, "64 histograms");
  for (int i = 0; i < 64; ++i) CHECK(cargobay_histogram_close(all[i]) == CARGOBAY_OK);
  CHECK(cargobay_histogram_open(&more) == CARGOBAY_OK && more != all[0]);
  CHECK(cargobay_histogram_close(more) == CARGOBAY_OK);
  for (int i = 0; i < 64; ++i) sims[i] = virtual_sim();
  GIVES(cargobay_sim_open(&create, &sim), CARGOBAY_E_LIMIT, "64 virtual Creates");
  CHECK(sim == NULL);
  for (int i = 0; i < 64; ++i) CHECK(cargobay_sim_close(sims[i]) == CARGOBAY_OK);
}

/* In a child, since nothing gives memory back to a process that has taken it all. */
static void runs_out_of_memory(void) {
  int status = 0;
  if (getenv("CARGOBAY_SANITIZED") != NULL) return; /* a sanitizer's allocator never fails */
  const pid_t child = fork();
  CHECK(child >= 0);
  if (child == 0) {
    const struct rlimit no_more = {1, 1};
    struct cargobay_histogram* histogram = NULL;
    struct cargobay_sim* sim = NULL;
    SIZED(cargobay_sim_options, create);
    create.time = CARGOBAY_SIM_TIME_VIRTUAL;
    CHECK(setrlimit(RLIMIT_AS, &no_more) == 0);
    for (size_t size = 1 << 20; size >= 16; size /= 2) {
      while (malloc(size) != NULL) {
      }
    }
    GIVES(cargobay_histogram_open(&histogram), CARGOBAY_E_MEMORY, "memory");
    GIVES(cargobay_sim_open(&create, &sim), CARGOBAY_E_MEMORY, "memory");
    CHECK(histogram == NULL && sim == NULL);
    _exit(0);
  }
  CHECK(waitpid(child, &status, 0) == child && status == 0);
}

static void has_no_room_on_the_line(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, CARGOBAY_FLAG_HOLD_ON_MODE_LOSS);
  int error = CARGOBAY_OK;
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  for (int i = 0; i < 40 && error == CARGOBAY_OK; ++i) error = cargobay_send_ir(robot, 1);
  GIVES(error, CARGOBAY_E_FULL, "32");
  CHECK(run_for(robot, 1.0) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(sim, "wheeldrop left on", NULL, 0) >= 0);
  CHECK(run_for(robot, 0.5) == CARGOBAY_OK);
  GIVES(cargobay_drive(robot, 100.0, 0.0), CARGOBAY_E_MODE, "cargobay_rearm");
  GIVES(cargobay_set_leds(robot, 0, 0, 0), CARGOBAY_E_MODE, "passive");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void* last_message(void* seen) {
  char** message = seen;
  *message = strdup(cargobay_error_message());
  return NULL;
}

/* Each thread has its own message. */
static void keeps_messages_apart(void) {
  char* message = NULL;
  pthread_t thread;
  CHECK(cargobay_start(NULL) == CARGOBAY_E_HANDLE);
  CHECK(pthread_create(&thread, NULL, last_message, &message) == 0);
  CHECK(pthread_join(thread, NULL) == 0);
  CHECK(strcmp(message, "") == 0 && strlen(cargobay_error_message()) > 0);
  free(message);
}

int main(void) {
  keeps_messages_apart();
  refuses_a_wrong_order();
  has_no_such_thing();
  finds_no_file();
  finds_no_robot();
  ends_by_what_happens("wheeldrop left on", CARGOBAY_E_MODE, "the left wheel is off the floor");
  ends_by_what_happens("fault stalled-stream 9000", CARGOBAY_E_SILENT, "silent");
  does_not_confirm();
  has_one_owner();
  is_given_up();
  runs_out_of_handles();
  runs_out_of_memory();
  has_no_room_on_the_line();
  return 0;
}
