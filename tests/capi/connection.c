/* A7: the errors of ports, pins, guards and descriptors, in real time: one code for each thing that
 * can be done about it. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"
#include "remedy.h"

struct port {
  struct cargobay_sim* sim;
  char path[64];
};

static struct port open_port(void) {
  struct port port;
  CHECK(cargobay_sim_open(NULL, &port.sim) == CARGOBAY_OK);
  CHECK(cargobay_sim_get_path(port.sim, port.path, sizeof port.path) > 5);
  return port;
}

static int open_at(const char* path, struct cargobay_robot** robot) {
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.port = path;
  return cargobay_open(&options, robot);
}

static void is_no_port(void) {
  char file[] = "/tmp/cargobay-capi-XXXXXX";
  struct cargobay_robot* robot = NULL;
  const int descriptor = mkstemp(file);
  CHECK(descriptor >= 0);
  GIVES(open_at("/dev/no-such-port", &robot), CARGOBAY_E_NO_PORT, "/dev/no-such-port");
  GIVES(open_at("/dev/null", &robot), CARGOBAY_E_NO_PORT, "/dev/null");
  GIVES(open_at(file, &robot), CARGOBAY_E_NO_PORT, file);
  GIVES(open_at("/tmp", &robot), CARGOBAY_E_NO_PORT, "/tmp");
  CHECK(robot == NULL && close(descriptor) == 0 && unlink(file) == 0);
}

static void is_busy(void) {
  struct port port = open_port();
  struct cargobay_robot* robot = NULL;
  struct cargobay_robot* second = NULL;
  SIZED(cargobay_options, options);
  CHECK(open_at(port.path, &robot) == CARGOBAY_OK);
  GIVES(open_at(port.path, &second), CARGOBAY_E_BUSY, port.path);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = port.sim;
  GIVES(cargobay_open(&options, &second), CARGOBAY_E_BUSY, "");
  CHECK(second == NULL && cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  GIVES(open_at(port.path, &second), CARGOBAY_E_BUSY, port.path);
  CHECK(second == NULL && cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(port.sim) == CARGOBAY_OK);
}

/* Runs in a child, as a user who owns nothing. */
static void is_not_allowed(void) {
  struct port port = open_port();
  int status = 0;
  CHECK(chmod(port.path, 0) == 0);
  const pid_t child = fork();
  CHECK(child >= 0);
  if (child == 0) {
    struct cargobay_robot* robot = NULL;
    if (geteuid() == 0) CHECK(setresgid(65534, 65534, 65534) == 0);
    if (geteuid() == 0) CHECK(setresuid(65534, 65534, 65534) == 0);
    GIVES(open_at(port.path, &robot), CARGOBAY_E_ACCESS, port.path);
    _exit(0);
  }
  CHECK(waitpid(child, &status, 0) == child && status == 0);
  CHECK(cargobay_sim_close(port.sim) == CARGOBAY_OK);
}

/* A pin that is not there, for the port that the settings name. */
static void has_no_pin(void) {
  struct port port = open_port();
  struct cargobay_robot* robot = NULL;
  char settings[300];
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  snprintf(settings, sizeof settings,
           "port = \"%s\"\n[pins.brc]\nchip = \"no-such-chip\"\nline = 17\n", port.path);
  options.settings = settings;
  GIVES(cargobay_open(&options, &robot), CARGOBAY_E_PIN, "no-such-chip");
  CHECK(robot == NULL && cargobay_sim_close(port.sim) == CARGOBAY_OK);
}

static struct cargobay_sim* sim_behind(const char* link) {
  struct cargobay_sim* sim = NULL;
  SIZED(cargobay_sim_options, options);
  options.link = link;
  CHECK(cargobay_sim_open(&options, &sim) == CARGOBAY_OK);
  return sim;
}

/* The adapter is pulled out during the drive, and plugged in again: a new port behind the same
 * link. Starting again reconnects, and ticks and odometry go on. */
static void is_unplugged(void) {
  char folder[] = "/tmp/cargobay-capi-XXXXXX";
  char link[64];
  struct cargobay_robot* robot = NULL;
  int error = CARGOBAY_OK;
  UNSEEN(state);
  SIZED(cargobay_end_report, end);
  CHECK(mkdtemp(folder) != NULL);
  snprintf(link, sizeof link, "%s/create", folder);
  struct cargobay_sim* sim = sim_behind(link);
  CHECK(open_at(link, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  for (int i = 0; i < 30; ++i) {
    CHECK(cargobay_drive(robot, 300.0, 0.0) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  while (error == CARGOBAY_OK) error = next_state(robot, &state);
  GIVES(error, CARGOBAY_E_UNPLUGGED, "");
  CHECK(cargobay_end(robot) < 0);
  CHECK(cargobay_get_end(robot, &end) == CARGOBAY_OK && end.code == CARGOBAY_E_UNPLUGGED);
  CHECK(names_a_remedy(end.message));
  GIVES(cargobay_start(robot), CARGOBAY_E_NO_PORT, link);
  sim = sim_behind(link);
  const struct cargobay_state before = state;
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  CHECK(state.tick > before.tick && state.x_mm >= before.x_mm - 1.0 && state.x_mm > 10.0);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK && rmdir(folder) == 0);
}

/* The child of this process with that name; 0 if there is none. */
static pid_t child_named(const char* name) {
  DIR* processes = opendir("/proc");
  pid_t found = 0;
  CHECK(processes != NULL);
  for (struct dirent* entry; found == 0 && (entry = readdir(processes)) != NULL;) {
    char path[300];
    char command[64] = "";
    int parent = 0;
    snprintf(path, sizeof path, "/proc/%s/stat", entry->d_name);
    FILE* stat = fopen(path, "r");
    if (stat == NULL) continue;
    if (fscanf(stat, "%*d (%63[^)]) %*c %d", command, &parent) == 2 && parent == getpid() &&
        strcmp(command, name) == 0)
      found = atoi(entry->d_name);
    fclose(stat);
  }
  closedir(processes);
  return found;
}

/* A17: its guard is a child of the program; if that dies, the loop stops the robot. */
static void loses_its_guard(void) {
  struct port port = open_port();
  struct cargobay_robot* robot = NULL;
  int error = CARGOBAY_OK;
  UNSEEN(state);
  SIZED(cargobay_end_report, end);
  CHECK(open_at(port.path, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  const pid_t guard = child_named("cargobay-guard");
  CHECK(guard > 0 && kill(guard, SIGKILL) == 0);
  while (error == CARGOBAY_OK) error = next_state(robot, &state);
  GIVES(error, CARGOBAY_E_GUARD, "guard");
  GIVES(cargobay_end(robot), CARGOBAY_E_GUARD, "guard");
  CHECK(cargobay_get_end(robot, &end) == CARGOBAY_OK);
  CHECK(end.code == CARGOBAY_E_GUARD && end.guard_lost == 1 && end.passive_seen == 1);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(port.sim) == CARGOBAY_OK);
}

/* A17: a program may wait for any of its children: it is told of the guard, and ignores it. */
static void* reaps_all_children(void* ended) {
  while (!atomic_load((atomic_bool*)ended)) {
    (void)waitpid(-1, NULL, WNOHANG);
    usleep(100);
  }
  return NULL;
}

static void survives_a_reaper(void) {
  atomic_bool ended;
  pthread_t reaper;
  atomic_init(&ended, 0);
  CHECK(pthread_create(&reaper, NULL, reaps_all_children, &ended) == 0);
  for (int i = 0; i < 3; ++i) {
    struct port port = open_port();
    struct cargobay_robot* robot = NULL;
    SIZED(cargobay_truth, truth);
    CHECK(open_at(port.path, &robot) == CARGOBAY_OK);
    CHECK(cargobay_start(robot) == CARGOBAY_OK);
    CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
    if (i == 1) CHECK(cargobay_end(robot) == CARGOBAY_OK);
    CHECK(cargobay_close(robot) == CARGOBAY_OK);
    CHECK(cargobay_sim_get_truth(port.sim, &truth) == CARGOBAY_OK);
    CHECK(truth.mode == CARGOBAY_MODE_PASSIVE);
    CHECK(cargobay_sim_close(port.sim) == CARGOBAY_OK);
  }
  atomic_store(&ended, 1);
  CHECK(pthread_join(reaper, NULL) == 0);
}

/* No descriptor is left. */
static void runs_out_of_descriptors(void) {
  struct cargobay_sim* sim = NULL;
  struct cargobay_robot* robot = NULL;
  struct rlimit before;
  struct rlimit few;
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(getrlimit(RLIMIT_NOFILE, &before) == 0);
  few = before;
  few.rlim_cur = 3;
  CHECK(setrlimit(RLIMIT_NOFILE, &few) == 0);
  GIVES(cargobay_sim_open(NULL, &sim), CARGOBAY_E_LIMIT, "");
  GIVES(cargobay_get_fd(robot), CARGOBAY_E_LIMIT, "");
  CHECK(setrlimit(RLIMIT_NOFILE, &before) == 0);
  CHECK(sim == NULL && cargobay_get_fd(robot) > 2);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

/* From here on, this process may not set any terminal up: EPROTO, which no kernel says. */
static bool refuse_terminals(void) {
  struct sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_ioctl, 0, 6),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, args[1])),
      BPF_STMT(BPF_ALU | BPF_AND | BPF_K, 0xffff),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0x5402, 2, 0), /* TCSETS */
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0x5403, 1, 0), /* TCSETSW */
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0x542b, 0, 1), /* TCSETS2 */
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPROTO),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const struct sock_fprog filter = {sizeof program / sizeof program[0], program};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

static void is_refused_by_the_system(void) {
  struct port port = open_port();
  int status = 0;
  const pid_t child = fork();
  CHECK(child >= 0);
  if (child == 0) {
    struct cargobay_robot* robot = NULL;
    if (!refuse_terminals()) _exit(0); /* a kernel without filters */
    CHECK_FAILS(open_at(port.path, &robot), CARGOBAY_E_SYSTEM, "Protocol error");
    CHECK(robot == NULL);
    _exit(0);
  }
  CHECK(waitpid(child, &status, 0) == child && status == 0);
  CHECK(cargobay_sim_close(port.sim) == CARGOBAY_OK);
}

int main(void) {
  is_no_port();
  is_busy();
  is_not_allowed();
  has_no_pin();
  is_unplugged();
  loses_its_guard();
  survives_a_reaper();
  runs_out_of_descriptors();
  is_refused_by_the_system();
  return 0;
}
