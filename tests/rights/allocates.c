/* A program that allocates memory and starts threads while its robot drives: all of it must be
   granted, whatever the limit on locked memory. Exit 0 if it was and the robot stopped in
   the end. */
#include <cargobay.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { kThreads = 8, kFrames = 60 };
static const size_t kBytes = (size_t)64 << 20;

static void* nothing(void* context) { return context; }

static const char* allocate(void) {
  pthread_t threads[kThreads];
  char* memory = malloc(kBytes);
  if (memory == NULL) return "no memory";
  memset(memory, 1, kBytes);
  free(memory);
  for (int i = 0; i < kThreads; ++i)
    if (pthread_create(&threads[i], NULL, nothing, NULL) != 0) return "no thread";
  for (int i = 0; i < kThreads; ++i) pthread_join(threads[i], NULL);
  return NULL;
}

int main(void) {
  struct cargobay_options options = {.size = sizeof options, .flags = CARGOBAY_FLAG_NO_CONFIG};
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_robot* robot = NULL;
  const char* wrong = NULL;
  char missing[1500];
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = cargobay_start(robot);
  if (error == 0 && cargobay_get_missing_rights(robot, missing, sizeof missing) > 0)
    fputs(missing, stderr);
  for (int frame = 0; frame < kFrames && error == 0 && wrong == NULL; ++frame) {
    error = cargobay_drive(robot, 200.0, 0.0);
    if (error == 0) error = cargobay_wait(robot, state.tick, 1000000000, &state);
    if (frame % 20 == 10) wrong = allocate();
  }
  if (wrong != NULL) fprintf(stderr, "%s\n", wrong);
  if (error == 0) error = cargobay_end(robot); /* fails unless it is seen to be Passive */
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  return error != 0 || wrong != NULL;
}
