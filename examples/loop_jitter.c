/* How regularly your own loop wakes, compared with the control thread that it follows. */
#include <cargobay.h>
#include <stdio.h>
#include <time.h>

static int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * (int64_t)1000000000 + now.tv_nsec;
}

static void show(const char* whose, struct cargobay_histogram* histogram) {
  struct cargobay_distribution held = {.size = sizeof held};
  if (cargobay_histogram_get(histogram, &held) == 0)
    printf("%s: period p50 %.3f ms, p99 %.3f ms, longest %.3f ms\n", whose,
           1e-6 * (double)held.p50_ns, 1e-6 * (double)held.p99_ns, 1e-6 * (double)held.max_ns);
}

static int measure(struct cargobay_robot* robot, struct cargobay_histogram* histogram) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  if (cargobay_start(robot) != 0 || cargobay_wait(robot, -1, -1, &state) != 0) return -1;
  for (int64_t before_ns = now_ns(); state.tick < 200;) {
    if (cargobay_wait(robot, state.tick, -1, &state) != 0) return -1;
    const int64_t woken_ns = now_ns();
    cargobay_histogram_record(histogram, woken_ns - before_ns);
    before_ns = woken_ns;
  }
  show("this thread", histogram);
  if (cargobay_copy_histogram(robot, CARGOBAY_MEASURE_PERIOD, histogram) != 0) return -1;
  show("control thread", histogram);
  return cargobay_end(robot);
}

int main(int argc, char** argv) {
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_histogram* histogram = NULL;
  struct cargobay_robot* robot = NULL;
  int error = cargobay_histogram_open(&histogram);
  if (error == 0) error = cargobay_open(&options, &robot);
  if (error == 0) error = measure(robot, histogram);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  cargobay_histogram_close(histogram);
  return error != 0;
}
