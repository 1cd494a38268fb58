/* What the comments of the header state about order and threads holds for each function that says
 * it. A new function needs no entry here. */
#include <stdbool.h>

#include "every_function.h"
#include "tests/capi/check.h"

static bool says(const struct function* function, const char* words) {
  return strstr(function->comment, words) != NULL;
}

static void gives(const struct function* function, void* handle, int wanted) {
  const int got = function->call(handle);
  if (got == wanted && strlen(cargobay_error_message()) > 20) return;
  fprintf(stderr, "%s gave %s (\"%s\"), not %s\n", function->name, cargobay_error_name(got),
          cargobay_error_message(), cargobay_error_name(wanted));
  exit(1);
}

/* Calls all of a robot's functions that say either of two things. */
static void all_give(struct cargobay_robot* robot, const char* words, const char* or_words,
                     int wanted) {
  int count = 0;
  for (int i = 0; i < kFunctionCount; ++i) {
    const struct function* function = &kFunctions[i];
    if (function->kind != of_robot || !(says(function, words) || says(function, or_words)))
      continue;
    gives(function, robot, wanted);
    ++count;
  }
  printf("%d functions: %s, as they say \"%s\"\n", count, cargobay_error_name(wanted), words);
  CHECK(count >= 2);
}

static const char kNotRunning[] = "CARGOBAY_E_STATE if the loop does not run";

static void keeps_to_the_order(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  all_give(robot, "CARGOBAY_E_STATE before cargobay_start()", kNotRunning, CARGOBAY_E_STATE);
  all_give(robot, "CARGOBAY_E_NO_FRAME before the first frame", "E_NO_FRAME before the first",
           CARGOBAY_E_NO_FRAME);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  all_give(robot, "after the loop has ended", kNotRunning, CARGOBAY_E_STATE);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* ---- while a second start brings the robot up again ---- */

struct again {
  struct cargobay_robot* robot; /* NULL during cargobay_open() */
  bool asked;
};

static int asks_meanwhile(void* context, const char* step, const char* detail) {
  struct again* self = context;
  (void)step;
  (void)detail;
  if (self->robot == NULL || self->asked) return 0;
  self->asked = true;
  all_give(self->robot, "CARGOBAY_E_STATE while cargobay_start()", "E_STATE while cargobay_start()",
           CARGOBAY_E_STATE);
  SIZED(cargobay_state, state);
  CHECK(cargobay_get_state(self->robot, &state) == CARGOBAY_OK && state.tick > 3); /* the last */
  return 0;
}

static void has_nothing_while_it_reconnects(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct again self = {NULL, false};
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  options.progress = asks_meanwhile;
  options.progress_context = &self;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK && run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  self.robot = robot;
  CHECK(cargobay_start(robot) == CARGOBAY_OK && self.asked);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* ---- in the control function ---- */

struct inside {
  void* handles[4]; /* by kind */
  int refused;
  int allowed;
};

/* Whether a function says that the control function may not call it. */
static bool is_for_others(const struct function* function) {
  return says(function, "Owner;") || says(function, "Owner.") ||
         says(function, "but the control thread") || says(function, "from the control function");
}

static int calls_everything(void* context, const struct cargobay_state* state,
                            struct cargobay_output* output) {
  struct inside* self = context;
  (void)output;
  if (state->tick < 3 || self->refused > 0) return 0;
  for (int i = 0; i < kFunctionCount; ++i) {
    const struct function* function = &kFunctions[i];
    if (!is_for_others(function)) continue;
    gives(function, self->handles[function->kind], CARGOBAY_E_THREAD);
    ++self->refused;
  }
  for (int i = 0; i < kFunctionCount; ++i) {
    const struct function* function = &kFunctions[i];
    if (is_for_others(function)) continue;
    if (strcmp(function->name, "cargobay_histogram_close") == 0) continue; /* any thread may */
    CHECK(function->call(self->handles[function->kind]) != CARGOBAY_E_THREAD);
    ++self->allowed;
  }
  return 0;
}

static void keeps_to_its_threads(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = robot_of(sim, 0);
  struct cargobay_histogram* histogram = NULL;
  struct inside self = {{NULL, robot, sim, NULL}, 0, 0};
  CHECK(cargobay_histogram_open(&histogram) == CARGOBAY_OK);
  self.handles[of_histogram] = histogram;
  CHECK(cargobay_set_control(robot, calls_everything, &self) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_ENDED); /* one of them was cargobay_request_end() */
  printf("in the control function: %d functions are refused, %d are not\n", self.refused,
         self.allowed);
  CHECK(self.refused >= 10 && self.allowed >= 30);
  CHECK(self.refused + self.allowed + 1 == kFunctionCount);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

int main(void) {
  keeps_to_the_order();
  has_nothing_while_it_reconnects();
  keeps_to_its_threads();
  return 0;
}
