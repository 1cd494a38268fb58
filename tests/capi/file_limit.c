/* A limit on the file size, and a pipe whose reader has gone: errors of the recording, not signals
 * to the program. */
#define _POSIX_C_SOURCE 200809L
#include <fcntl.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "check.h"

/* Drives for some seconds of virtual time, then returns what came of the recording. */
static int record_to(const char* file, struct cargobay_sim* sim, struct cargobay_robot** robot) {
  SIZED(cargobay_options, options);
  UNSEEN(state);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  options.record = file;
  CHECK(cargobay_open(&options, robot) == CARGOBAY_OK);
  CHECK(cargobay_start(*robot) == CARGOBAY_OK);
  CHECK(cargobay_drive(*robot, 200.0, 0.0) == CARGOBAY_OK);
  for (int i = 0; i < 400; ++i) CHECK(next_state(*robot, &state) == CARGOBAY_OK);
  return cargobay_end(*robot);
}

int main(void) {
  char folder[] = "/tmp/cargobay-capi-XXXXXX";
  char file[64];
  struct cargobay_sim* sim = NULL;
  struct cargobay_robot* robot = NULL;
  struct rlimit before;
  struct rlimit little;
  struct stat status;
  int reader;
  SIZED(cargobay_sim_options, create);
  CHECK(mkdtemp(folder) != NULL);
  create.time = CARGOBAY_SIM_TIME_VIRTUAL;
  CHECK(cargobay_sim_open(&create, &sim) == CARGOBAY_OK);

  snprintf(file, sizeof file, "%s/drive.rec", folder);
  CHECK(getrlimit(RLIMIT_FSIZE, &before) == 0);
  little = before;
  little.rlim_cur = 8192;
  CHECK(setrlimit(RLIMIT_FSIZE, &little) == 0);
  CHECK_FAILS(record_to(file, sim, &robot), CARGOBAY_E_FILE, "File too large");
  CHECK(setrlimit(RLIMIT_FSIZE, &before) == 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(stat(file, &status) == 0 && status.st_size == 8192);
  CHECK(remove(file) == 0);

  CHECK(mkfifo(file, 0600) == 0);
  reader = open(file, O_RDONLY | O_NONBLOCK);
  CHECK(reader >= 0);
  {
    SIZED(cargobay_options, options);
    options.flags = CARGOBAY_FLAG_NO_CONFIG;
    options.sim = sim;
    options.record = file;
    CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  }
  CHECK(close(reader) == 0);
  CHECK_FAILS(cargobay_start(robot), CARGOBAY_E_FILE, "Broken pipe");
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(remove(file) == 0);

  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  CHECK(rmdir(folder) == 0);
  return 0;
}
