// Which other processes have a port open, and how to get them off it: a login prompt, a shell, a
// terminal program, ModemManager. Each of them takes bytes that the robot sent to us.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace cargobay::hal {

struct PortUser {
  pid_t id = 0;
  std::string name{};  // as the kernel has it: 15 characters at most
};

struct PortUsers {
  std::vector<PortUser> found{};
  // Processes whose files this one may not look into. Those among them whose terminal the port is,
  // or that locked it, are in `found` all the same.
  std::size_t unseen = 0;
};

// Who has the port of that path open, by whatever name, beside this process, its guard and, of a
// pseudo-terminal, the program at its other side. None where there is no such port. One look at
// each open file of this machine: some ms, up to some hundred; not for a real-time thread.
// Allocates. `root` is another for tests.
PortUsers find_port_users(const std::string& path, const std::filesystem::path& root = "/");

// Whether it is a guard, by its name.
bool is_guard(const PortUser& user);

// "agetty (process 412)".
std::string describe(const PortUser& user);
std::string describe(const std::vector<PortUser>& users);  // with commas
// What to do about it, for somebody at a command line: one line. Looks at the process once more for
// the service that it belongs to.
std::string remedy(const PortUser& user, const std::filesystem::path& root = "/");

}  // namespace cargobay::hal
