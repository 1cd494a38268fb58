// The robot in Qt's event loop, beside a timer: 5.15 or 6, no more than its core.
#include <unistd.h>

#include <QCoreApplication>
#include <QSocketNotifier>
#include <QTimer>
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

// Drives ahead for two seconds.
static cargobay::Expected<void> drive(cargobay::Robot& robot) {
  const auto fd = robot.fd();
  if (!fd) return cargobay::Unexpected{fd.error()};
  cargobay::State state{.tick = -1};
  cargobay::Expected<void> done;
  QSocketNotifier frames{*fd, QSocketNotifier::Read};
  QObject::connect(&frames, &QSocketNotifier::activated, [&] {
    std::uint64_t ignored = 0;
    if (read(*fd, &ignored, sizeof ignored) < 0) return;  // nothing new
    const auto next = robot.wait(state.tick, 0s);
    if (next.code() == cargobay::ErrorCode::timeout) return;  // an event, and no frame
    if (next) state = *next;
    done = next ? robot.drive(150.0, 0.0) : next.outcome();
    if (!done || state.robot_time >= 2s) QCoreApplication::quit();
  });
  QTimer reports;
  QObject::connect(&reports, &QTimer::timeout,
                   [&state] { std::printf("%.0f mm ahead\n", state.x_mm); });
  reports.start(500ms);
  QCoreApplication::exec();
  return done ? robot.end() : done;
}

int main(int argc, char** argv) {
  const QCoreApplication application{argc, argv};
  cargobay::Options options{.flags = cargobay::Flag::no_config};
  if (argc > 1) options = {.port = argv[1]};
  auto robot = cargobay::Robot::open(options);
  auto done =
      robot ? robot->start() : cargobay::Expected<void>{cargobay::Unexpected{robot.error()}};
  if (done) done = drive(*robot);
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
