// The virtual Create that a program starts for itself if no port is named: on a pseudo-terminal, in
// real time, with its pins wired to the bring-up.
#pragma once

#include <memory>

#include "hal/bring_up/bring_up.hpp"
#include "hal/result.hpp"
#include "hal/sim/line/server.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/robot/pins.hpp"

namespace cargobay::hal::sim {

class VirtualCreate {
 public:
  // For 19200 baud it starts switched off, with BRC pin, power toggle and indicator wired, so that
  // the bring-up has everything to do. For other rates it is on and talks at 57600.
  static Result<std::unique_ptr<VirtualCreate>> start(Parameters robot, std::uint32_t wanted_baud,
                                                      int priority);

  Server& server() { return *server_; }
  // Valid as long as this object.
  RobotPins pins();

 private:
  explicit VirtualCreate(std::unique_ptr<Server> server);

  std::unique_ptr<Server> server_;
  Pins pins_;
  bool wired_ = false;
};

}  // namespace cargobay::hal::sim
