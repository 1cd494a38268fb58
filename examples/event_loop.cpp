// The robot in an event loop, beside a timer and signals: Ctrl-C ends the drive cleanly.
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> run(cargobay::Robot& robot, const sigset_t& signals) {
  constexpr itimerspec half_second{{0, 500'000'000}, {0, 500'000'000}};
  const auto frame = robot.fd();
  if (!frame) return cargobay::Unexpected{frame.error()};
  const int timer = timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC);
  const int signal = signalfd(-1, &signals, SFD_CLOEXEC);
  const int loop = epoll_create1(EPOLL_CLOEXEC);
  timerfd_settime(timer, 0, &half_second, nullptr);
  for (const int source : {*frame, timer, signal}) {
    epoll_event added{.events = EPOLLIN, .data = {.fd = source}};
    epoll_ctl(loop, EPOLL_CTL_ADD, source, &added);
  }
  cargobay::State state;
  for (;;) {
    char ignored[sizeof(signalfd_siginfo)];
    epoll_event ready{};
    if (epoll_wait(loop, &ready, 1, -1) < 1) continue;
    if (read(ready.data.fd, ignored, sizeof ignored) < 0) continue;
    if (ready.data.fd == signal) return robot.end();
    if (ready.data.fd == timer) std::printf("%.0f mm ahead\n", state.x_mm);
    if (ready.data.fd != *frame) continue;
    const auto next = robot.wait(state.tick, 0s);
    if (next.code() == cargobay::ErrorCode::timeout) continue;  // an event, and no frame
    if (!next) return next.outcome();
    state = *next;
    if (auto set = robot.drive(150.0, 0.0); !set) return set;
  }
}

int main(int argc, char** argv) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGALRM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // they come through the descriptor only
  auto robot =
      cargobay::Robot::open(argc > 1 ? cargobay::Options{.port = argv[1]}
                                     : cargobay::Options{.flags = cargobay::Flag::no_config});
  const auto started = robot ? robot->start() : cargobay::Unexpected{robot.error()};
  if (argc < 2) alarm(3);  // without a port: not until Ctrl-C
  const auto done = started ? run(*robot, signals) : started;
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
