// From a lost link to a robot under control again, as soon as its port is back.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/port/open_port.hpp"
#include "hal/port/port_identity.hpp"
#include "hal/result.hpp"
#include "hal/robot/robot.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

// Whether to reconnect after a cycle that ended like this. Not after a lost mode: a person should
// look at why the robot stopped.
bool may_reconnect(CycleEnd end);

// How long to wait before the next attempt: none before the first, 50 ms before the second, then
// twice as long each time, 400 ms at most, so that a port that is back is found within that time.
class BackOff {
 public:
  rt::Duration next();

 private:
  rt::Duration next_{0};
};

// The machine as reconnect() sees it; tests replace it.
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
  rt::Duration patience = std::chrono::seconds{30};  // for everything together
  PortSurroundings surroundings{};
  // Called with what is there instead of the port, whenever that changes; may be empty.
  std::function<void(const std::string&)> tell{};
};

struct Reconnection {
  Robot::Owned robot{};  // brought up, not started
  std::string path{};    // of the port, where it is now
  std::string remark{};  // as in OpenedPort
};

// Looks for the port, opens it and brings the robot up, again and again until that succeeds. The
// stream of the former link must be closed by now: while it is open, the kernel does not give its
// name to the port that comes back. Blocks for up to `patience`, not on a real-time thread; waits
// without using the CPU; allocates. After a failure, which says what was tried last, no port is
// open.
//
// A robot that plays a script with a wait in it is silent but not gone: announce that to its cycle
// with ControlCycle::expect_silence(), or allow for it in link_timeout.
Result<Reconnection> reconnect(const ReconnectRequest& request);

}  // namespace cargobay::hal
