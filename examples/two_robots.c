/* Two robots in one thread: whichever frame comes first is answered first. */
#include <cargobay.h>
#include <poll.h>
#include <stdio.h>
#include <unistd.h>

static const int64_t kEndNs = 2000000000;

/* The second robot drives as fast as the first one is seen to drive. */
static int follow(struct cargobay_robot** robots, struct cargobay_state* states) {
  struct pollfd fds[2] = {{.fd = cargobay_get_fd(robots[0]), .events = POLLIN},
                          {.fd = cargobay_get_fd(robots[1]), .events = POLLIN}};
  while (states[0].robot_time_ns < kEndNs || states[1].robot_time_ns < kEndNs) {
    if (poll(fds, 2, -1) < 0) return -1;
    for (int i = 0; i < 2; ++i) {
      uint64_t ignored = 0;
      if (read(fds[i].fd, &ignored, sizeof ignored) < 0) continue; /* nothing new */
      const int error = cargobay_wait(robots[i], states[i].tick, 0, &states[i]);
      if (error == CARGOBAY_E_TIMEOUT) continue; /* an event, and no frame */
      if (error != 0) return error;
      if (cargobay_drive(robots[i], i == 0 ? 200.0 : states[0].velocity_mm_s, 0.0) != 0) return -1;
    }
  }
  return 0;
}

int main(int argc, char** argv) {
  struct cargobay_robot* robots[2] = {NULL, NULL};
  struct cargobay_state states[2] = {{.size = sizeof states[0], .tick = -1},
                                     {.size = sizeof states[1], .tick = -1}};
  int error = 0;
  for (int i = 0; i < 2 && error == 0; ++i) {
    /* Without two ports: two virtual Creates. */
    struct cargobay_options options = {.size = sizeof options,
                                       .flags = argc > 2 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                       .port = argc > 2 ? argv[1 + i] : NULL};
    error = cargobay_open(&options, &robots[i]);
    if (error == 0) error = cargobay_start(robots[i]);
  }
  if (error == 0) error = follow(robots, states);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  for (int i = 0; i < 2; ++i) cargobay_close(robots[i]);
  if (error == 0)
    printf("%.0f and %.0f mm ahead after %lld and %lld frames\n", states[0].x_mm, states[1].x_mm,
           (long long)states[0].tick, (long long)states[1].tick);
  return error != 0;
}
