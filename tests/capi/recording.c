/* A recording that is started beforehand, and one that is saved afterwards or while the loop runs;
 * the command replays each. */
#define _POSIX_C_SOURCE 200809L
#include <sys/stat.h>
#include <unistd.h>

#include "check.h"

static char folder[] = "/tmp/cargobay-capi-XXXXXX";
static char file[64];

static int64_t size_of_file(void) {
  struct stat status;
  return stat(file, &status) == 0 ? (int64_t)status.st_size : -1;
}

/* The same again, bit for bit. */
static void is_replayed(void) {
  char command[300];
  const char* cargobay = getenv("CARGOBAY_COMMAND");
  CHECK(cargobay != NULL);
  snprintf(command, sizeof command, "%s replay %s > /dev/null", cargobay, file);
  CHECK(system(command) == 0);
}

static void drive(struct cargobay_robot* robot, double seconds) {
  UNSEEN(state);
  for (int i = 0; i < (int)(seconds / 0.015); ++i) {
    CHECK(cargobay_drive(robot, 200.0, 0.3) == CARGOBAY_OK);
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
}

static void is_saved_at_any_time(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  CHECK_FAILS(cargobay_save_recording(robot, file), CARGOBAY_E_STATE, "start");
  CHECK(size_of_file() == -1);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  drive(robot, 2.0);
  CHECK(cargobay_save_recording(robot, file) == CARGOBAY_OK);
  const int64_t first = size_of_file();
  CHECK(first > 1000);
  is_replayed();
  drive(robot, 2.0);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_save_recording(robot, file) == CARGOBAY_OK); /* replaces it */
  CHECK(size_of_file() > first);
  is_replayed();
  const int64_t second = size_of_file();
  CHECK_FAILS(cargobay_save_recording(robot, folder), CARGOBAY_E_FILE, folder);
  CHECK_FAILS(cargobay_save_recording(robot, "/dev/full/none"), CARGOBAY_E_FILE, "/dev/full");
  CHECK(size_of_file() == second);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* While the loop runs on its own thread; it is not disturbed. */
static void is_saved_under_the_loop(void) {
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  UNSEEN(state);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  drive(robot, 0.5);
  for (int i = 0; i < 3; ++i) {
    CHECK(cargobay_save_recording(robot, file) == CARGOBAY_OK);
    is_replayed();
    CHECK(next_state(robot, &state) == CARGOBAY_OK);
  }
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
}

/* From the start on; a second start does not record, and leaves the recording alone. */
static void is_started_beforehand(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  options.record = file;
  CHECK(remove(file) == 0);
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(size_of_file() == -1); /* it gets its name once the loop runs */
  CHECK(cargobay_start(robot) == CARGOBAY_OK && size_of_file() >= 0);
  drive(robot, 2.0);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  const int64_t whole = size_of_file();
  CHECK(whole > 1000);
  is_replayed();
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  drive(robot, 1.0);
  CHECK(cargobay_end(robot) == CARGOBAY_OK && size_of_file() == whole);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  is_replayed();
}

int main(void) {
  CHECK(mkdtemp(folder) != NULL);
  snprintf(file, sizeof file, "%s/drive.rec", folder);
  is_saved_at_any_time();
  is_saved_under_the_loop();
  is_started_beforehand();
  CHECK(remove(file) == 0 && rmdir(folder) == 0);
  return 0;
}
