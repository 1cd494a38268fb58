/* The robot in an event loop, beside a timer and signals: Ctrl-C ends the drive cleanly. */
#include <cargobay.h>
#include <signal.h>
#include <stdio.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

static int run(struct cargobay_robot* robot, const sigset_t* signals) {
  const struct itimerspec half_second = {{0, 500000000}, {0, 500000000}};
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  const int frame = cargobay_get_fd(robot);
  const int timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC);
  const int sources[] = {frame, timer, signalfd(-1, signals, SFD_CLOEXEC)};
  const int loop = epoll_create1(EPOLL_CLOEXEC);
  int error = timerfd_settime(timer, 0, &half_second, NULL);
  for (int i = 0; i < 3 && error == 0; ++i) {
    struct epoll_event added = {.events = EPOLLIN, .data = {.fd = sources[i]}};
    error = epoll_ctl(loop, EPOLL_CTL_ADD, sources[i], &added);
  }
  while (error == 0) {
    char ignored[sizeof(struct signalfd_siginfo)];
    struct epoll_event ready;
    if (epoll_wait(loop, &ready, 1, -1) < 1) continue;
    if (read(ready.data.fd, ignored, sizeof ignored) < 0) continue;
    if (ready.data.fd == sources[2]) return cargobay_end(robot);
    if (ready.data.fd == timer) printf("%.0f mm ahead\n", state.x_mm);
    if (ready.data.fd != frame) continue;
    error = cargobay_wait(robot, state.tick, 0, &state);
    if (error == CARGOBAY_E_TIMEOUT) error = 0; /* an event, and no frame */
    if (error == 0) error = cargobay_drive(robot, 150.0, 0.0);
  }
  return error;
}

int main(int argc, char** argv) {
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_robot* robot = NULL;
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGALRM);
  pthread_sigmask(SIG_BLOCK, &signals, NULL); /* they come through the descriptor only */
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = cargobay_start(robot);
  if (argc < 2) alarm(3); /* without a port: not until Ctrl-C */
  if (error == 0) error = run(robot, &signals);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  return error != 0;
}
