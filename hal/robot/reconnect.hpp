// From a link that was lost to a robot that is under control again, as soon as its port is back.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/cycle/control_cycle.hpp"
#include "hal/port/open_port.hpp"
#include "hal/port/port_identity.hpp"
#include "hal/result.hpp"
#include "hal/robot/robot.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

// Whether another link may come after a cycle that ended so. Not after a mode that was lost: why
// the robot stopped is for somebody to look at.
bool may_reconnect(CycleEnd end);

// How long to wait before the next attempt: the first comes at once, the next after 50 ms, then
// after twice as long each time, 400 ms at most: a port that is back is found within that.
class BackOff {
 public:
  rt::Duration next();

 private:
  rt::Duration next_{0};
};

// The machine, as reconnect() sees it; tests have another.
struct PortSurroundings {
  std::function<std::vector<PortInfo>()> ports = serial_ports;
  std::function<Result<OpenedPort>(const std::string& path, std::uint32_t baud)> open = open_port;
  std::function<rt::TimePoint()> now = rt::Clock::now;
  std::function<void(rt::Duration)> sleep{};  // empty: the thread sleeps
};

struct ReconnectRequest {
  PortIdentity port{};  // taken while the port was there
  std::uint32_t baud = 0;
  RobotOptions robot{};                              // `cancelled` ends the waiting as well
  rt::Duration patience = std::chrono::seconds{30};  // with everything that it takes
  PortSurroundings surroundings{};
};

struct Reconnection {
  Robot::Owned robot{};  // brought up, not started
  std::string path{};    // of the port, where it is now
  std::string remark{};  // of OpenedPort
};

// Looks for the port, opens it and brings the robot up, again and again until that is done. The
// stream of the former link must be closed by now: while it is open the kernel does not give its
// name to the port that comes back. Blocks for up to `patience`, not on a real-time thread; waits
// without using the CPU; allocates. After a failure, which says what was tried last, no port is
// open.
//
// A robot that plays a script with a wait in it is silent without being gone: for its cycle that is
// announced by ControlCycle::expect_silence(), or allowed for by its link_timeout.
Result<Reconnection> reconnect(const ReconnectRequest& request);

}  // namespace cargobay::hal
