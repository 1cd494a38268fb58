/* A logger, a display and a safety monitor read events side by side; each sees them all. */
#include <cargobay.h>
#include <pthread.h>
#include <stdio.h>

struct reader {
  struct cargobay_robot* robot;
  const char* name;
  int (*at_bump)(struct cargobay_robot* robot); /* or NULL */
};

static void* read_events(void* context) {
  const struct reader* reader = context;
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_event event = {.size = sizeof event};
  for (int error = 0; error == 0;) {
    error = cargobay_wait(reader->robot, state.tick, -1, &state);
    /* What was seen is this reader's own affair: nothing is taken from the others. */
    while (cargobay_next_event(reader->robot, event.sequence, &event) == 1) {
      printf("%s: %lld %s\n", reader->name, (long long)event.sequence,
             cargobay_event_name(event.kind));
      if (event.kind == CARGOBAY_EVENT_BUMP_BEGAN && reader->at_bump != NULL)
        reader->at_bump(reader->robot);
    }
  }
  return NULL;
}

static int drive_until_bump(struct cargobay_robot* robot) {
  struct reader readers[] = {{robot, "logger", NULL},
                             {robot, "display", NULL},
                             {robot, "safety monitor", cargobay_request_end}};
  pthread_t threads[3];
  int count = 0;
  int error = cargobay_start(robot);
  while (error == 0 && count < 3) {
    error = pthread_create(&threads[count], NULL, read_events, &readers[count]);
    count += error == 0;
  }
  if (error == 0)
    error = cargobay_drive(robot, 200.0, 0.0); /* once: it lapses, an event */
  else if (count > 0)
    cargobay_request_end(robot);
  while (count > 0) pthread_join(threads[--count], NULL);
  return error != 0 ? error : cargobay_end(robot);
}

int main(int argc, char** argv) {
  /* Without a port: a virtual Create that is bumped into after two seconds. */
  struct cargobay_options options = {.size = sizeof options, .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_robot* robot = NULL;
  int error = argc > 1 ? 0 : cargobay_sim_open(NULL, &options.sim);
  if (error == 0 && argc < 2) error = cargobay_sim_inject(options.sim, "at 2 bump left", NULL, 0);
  if (error >= 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = drive_until_bump(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_sim_close(options.sim);
  return error != 0;
}
