// Where what was learnt of a robot is kept, by the identity of its port.
#pragma once

#include <optional>
#include <string>

#include "hal/port/port_identity.hpp"

namespace cargobay::hal {

// What a Robot is to use and to keep (hal/learnt/learnt_keeper.hpp).
struct LearntPlace {
  std::string file{};   // empty: nothing is used or kept
  std::string port{};   // what the file says it is of
  bool forget = false;  // begin from nothing, whatever the file says, and replace it
};

// As the port is told apart, on one line: "usb 0403:6001 A9048VXM", or its absolute path.
std::string port_name(const PortIdentity& identity);

// The folder for state of whoever runs this: $STATE_DIRECTORY of a systemd service, else
// $XDG_STATE_HOME/cargobay, else ~/.local/state/cargobay, else, without a home, /var/lib/cargobay.
// A program with the rights of another user is not led by its environment.
std::string state_folder();

// By `wish`, as the setting `learnt` has it: empty for a file of the port in state_folder(),
// "none", or a file. Without a port, and at a pseudo-terminal, the robot is a virtual Create,
// another one each time: it has a file only if one is named. Looks at the ports of the machine if
// it must: some ms; allocates.
LearntPlace learnt_place(const std::string& wish, const std::string& port);

}  // namespace cargobay::hal
