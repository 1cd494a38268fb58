/* Every function of the header, with a handle that is not open, of another kind or of the parent
 * process: CARGOBAY_E_HANDLE, with words that say which. A new function needs no entry here. */
#define _POSIX_C_SOURCE 200809L
#include <stdbool.h>
#include <sys/wait.h>
#include <unistd.h>

#include "every_function.h"
#include "tests/capi/check.h"

static bool says(const struct function* function, const char* words) {
  return strstr(function->comment, words) != NULL;
}

static void refuses(const struct function* function, void* handle, const char* words) {
  const bool quiet = says(function, "CARGOBAY_E_HANDLE, without a message");
  const int wanted =
      handle == NULL && says(function, "NULL: nothing happens") ? CARGOBAY_OK : CARGOBAY_E_HANDLE;
  (void)cargobay_get_setting(0, NULL); /* another message, if this one leaves none */
  const int got = function->call(handle);
  const char* message = cargobay_error_message();
  if (got == wanted && (wanted == CARGOBAY_OK || quiet || strstr(message, words) != NULL)) return;
  fprintf(stderr, "%s gave %s (\"%s\"), not %s (\"...%s...\")\n", function->name,
          cargobay_error_name(got), message, cargobay_error_name(wanted), words);
  exit(1);
}

/* All functions of a kind of handle. */
static void all_refuse(enum handle_of kind, void* handle, const char* words) {
  int count = 0;
  for (int i = 0; i < kFunctionCount; ++i) {
    if (kFunctions[i].kind != kind) continue;
    refuses(&kFunctions[i], handle, words);
    ++count;
  }
  CHECK(count >= 4);
}

static void refuses_what_was_never_open(void) {
  static char here[64];
  all_refuse(of_robot, NULL, "this robot is NULL");
  all_refuse(of_sim, NULL, "this virtual Create is NULL");
  all_refuse(of_histogram, NULL, "this histogram is NULL");
  all_refuse(of_robot, here + ((uintptr_t)here & 1u), "not a handle");
  all_refuse(of_robot, (void*)(uintptr_t)1, "not a handle");
  all_refuse(of_sim, (void*)UINTPTR_MAX, "virtual Create");
  all_refuse(of_sim, (void*)(uintptr_t)2, "not a handle");
  all_refuse(of_histogram, (void*)(UINTPTR_MAX - 1), "not a handle");
}

struct open_ones {
  struct cargobay_sim* sim;
  struct cargobay_robot* robot;
  struct cargobay_histogram* histogram;
};

static struct open_ones open_all(void) {
  struct open_ones all = {virtual_sim(), NULL, NULL};
  all.robot = robot_of(all.sim, 0);
  CHECK(cargobay_histogram_open(&all.histogram) == CARGOBAY_OK);
  return all;
}

static void close_all(struct open_ones all) {
  CHECK(cargobay_close(all.robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(all.sim) == CARGOBAY_OK);
  CHECK(cargobay_histogram_close(all.histogram) == CARGOBAY_OK);
}

static void refuses_other_kinds(void) {
  struct cargobay_robot* second = NULL;
  const struct open_ones all = open_all();
  SIZED(cargobay_options, options);
  all_refuse(of_robot, all.sim, "handle of a virtual Create, not of a robot");
  all_refuse(of_robot, all.histogram, "handle of a histogram, not of a robot");
  all_refuse(of_sim, all.robot, "handle of a robot, not of a virtual Create");
  all_refuse(of_sim, all.histogram, "handle of a histogram, not of a virtual Create");
  all_refuse(of_histogram, all.robot, "handle of a robot, not of a histogram");
  all_refuse(of_histogram, all.sim, "handle of a virtual Create, not of a histogram");
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = (void*)all.robot;
  CHECK_FAILS(cargobay_open(&options, &second), CARGOBAY_E_HANDLE, "not of a virtual Create");
  for (unsigned bit = 0; bit < 8 * sizeof(void*); ++bit) {
    const uintptr_t forged = (uintptr_t)all.robot ^ ((uintptr_t)1 << bit);
    CHECK(cargobay_request_end((void*)forged) == CARGOBAY_E_HANDLE);
  }
  /* None of that has affected the real ones. */
  CHECK(cargobay_start(all.robot) == CARGOBAY_OK && run_for(all.robot, 0.1) == CARGOBAY_OK);
  close_all(all);
}

static void refuses_closed_ones(void) {
  const struct open_ones all = open_all();
  struct cargobay_robot* second = NULL;
  SIZED(cargobay_options, options);
  close_all(all);
  all_refuse(of_robot, all.robot, "this robot is closed");
  all_refuse(of_sim, all.sim, "this virtual Create is closed");
  all_refuse(of_histogram, all.histogram, "this histogram is closed");
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = all.sim;
  CHECK_FAILS(cargobay_open(&options, &second), CARGOBAY_E_HANDLE, "virtual Create is closed");
}

/* A child has no robot: nothing that it does reaches the parent's. */
static void is_not_inherited(void) {
  const struct open_ones all = open_all();
  int status = 0;
  CHECK(cargobay_start(all.robot) == CARGOBAY_OK);
  CHECK(run_for(all.robot, 0.1) == CARGOBAY_OK);
  const pid_t child = fork();
  CHECK(child >= 0);
  if (child == 0) {
    all_refuse(of_robot, all.robot, "this robot is closed");
    all_refuse(of_sim, all.sim, "this virtual Create is closed");
    all_refuse(of_histogram, all.histogram, "this histogram is closed");
    /* But it may have its own. */
    struct cargobay_sim* own = virtual_sim();
    struct cargobay_robot* mine = robot_of(own, 0);
    CHECK(cargobay_start(mine) == CARGOBAY_OK && run_for(mine, 0.1) == CARGOBAY_OK);
    CHECK(cargobay_close(mine) == CARGOBAY_OK && cargobay_sim_close(own) == CARGOBAY_OK);
    _exit(0);
  }
  CHECK(waitpid(child, &status, 0) == child && status == 0);
  CHECK(run_for(all.robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_end(all.robot) == CARGOBAY_OK);
  close_all(all);
}

/* A7: closing what is not there is no failure, so the message of the one before is still there. */
static void closes_nothing(void) {
  CHECK_FAILS(cargobay_open(NULL, NULL), CARGOBAY_E_ARGUMENT, "`robot`");
  CHECK(cargobay_close(NULL) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(NULL) == CARGOBAY_OK);
  CHECK(cargobay_histogram_close(NULL) == CARGOBAY_OK);
  CHECK(strstr(cargobay_error_message(), "`robot`") != NULL);
}

int main(void) {
  closes_nothing();
  refuses_what_was_never_open();
  refuses_other_kinds();
  refuses_closed_ones();
  is_not_inherited();
  return 0;
}
