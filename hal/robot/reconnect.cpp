#include "hal/robot/reconnect.hpp"

#include <algorithm>
#include <optional>
#include <thread>
#include <utility>

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFirstPause{50};
constexpr milliseconds kLongestPause{400};
constexpr milliseconds kLook{20};  // a cancellation is noticed within this time

class Attempts {
 public:
  explicit Attempts(const ReconnectRequest& request)
      : request_{request},
        until_{request.surroundings.now() + request.patience},
        robot_{request.robot} {
    robot_.cancelled = [this] { return over(); };
  }

  Result<Reconnection> run() {
    BackOff back_off;
    for (;;) {
      pause(back_off.next());
      if (over()) return given_up();
      auto reconnection = attempt();
      if (reconnection) return reconnection;
      // Our own cancellation when time is up: what failed before it says more.
      if (reconnection.failure().code != std::errc::operation_canceled)
        last_failure_ = reconnection.failure();
    }
  }

 private:
  Result<Reconnection> attempt() {
    const auto path = find_port(request_.port, request_.surroundings.ports);
    if (!path) {
      tell(path.failure());
      return path.failure();
    }
    auto port = request_.surroundings.open(*path, request_.baud);
    if (!port) return port.failure();
    auto robot = Robot::open(std::move(port->stream), robot_);
    if (!robot) return robot.failure();
    return Reconnection{.robot = std::move(*robot), .path = *path, .remark = port->remark};
  }

  // What is there instead of the port, each once.
  void tell(const Failure& failure) {
    const bool gone = failure.code == std::errc::no_such_device;
    if (gone || failure.message == told_ || !request_.tell) return;
    told_ = failure.message;
    request_.tell(told_);
  }

  void pause(rt::Duration duration) {
    const rt::TimePoint end = request_.surroundings.now() + duration;
    while (!over()) {
      const rt::Duration left = end - request_.surroundings.now();
      if (left <= rt::Duration::zero()) return;
      sleep(std::min<rt::Duration>(left, kLook));
    }
  }

  void sleep(rt::Duration duration) const {
    if (request_.surroundings.sleep) {
      request_.surroundings.sleep(duration);
    } else {
      std::this_thread::sleep_for(duration);
    }
  }

  bool over() {
    cancelled_ = cancelled_ || (request_.robot.cancelled && request_.robot.cancelled());
    return cancelled_ || request_.surroundings.now() >= until_;
  }

  Failure given_up() const {
    if (cancelled_) {
      return {"interrupted while waiting for " + request_.port.path + " to come back",
              std::make_error_code(std::errc::interrupted)};
    }
    const auto waited = std::chrono::duration_cast<std::chrono::seconds>(request_.patience);
    return {"no robot came back within " + std::to_string(waited.count()) +
                " s: " + last_failure_.message,
            last_failure_.code};
  }

  const ReconnectRequest& request_;
  rt::TimePoint until_;
  RobotOptions robot_;
  bool cancelled_ = false;
  std::string told_{};
  Failure last_failure_{"it did not answer in time"};
};

}  // namespace

bool may_reconnect(CycleEnd end) { return end == CycleEnd::hung_up || end == CycleEnd::link_lost; }

rt::Duration BackOff::next() {
  const rt::Duration now = next_;
  next_ = now == rt::Duration::zero() ? rt::Duration{kFirstPause}
                                      : std::min<rt::Duration>(2 * now, kLongestPause);
  return now;
}

Result<Reconnection> reconnect(const ReconnectRequest& request) { return Attempts{request}.run(); }

}  // namespace cargobay::hal
