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
  std::string name{};  // as the kernel stores it: 15 characters at most
  bool locks = false;  // it has locked the port, as this library does
};

struct PortUsers {
  std::vector<PortUser> found{};
  // Processes whose files this one may not look into. Those that have the port as their terminal,
  // or that locked it, are in `found` all the same.
  std::size_t unseen = 0;
};

// Which processes have the port at that path open, under whatever name, except this process, its
// guard and, for a pseudo-terminal, the program at its other side. None if there is no such port.
// Looks once at each open file of this machine: some ms, up to a few hundred; not for a real-time
// thread. Allocates. Tests pass another `root`.
PortUsers find_port_users(const std::string& path, const std::filesystem::path& root = "/");

// Whether it is a guard, going by its name.
bool is_guard(const PortUser& user);

// "agetty (process 412)".
std::string describe(const PortUser& user);
std::string describe(const std::vector<PortUser>& users);  // with commas
// What to do about it, for a user at a command line: one line. Looks at the process once more to
// find the service that it belongs to.
std::string remedy(const PortUser& user, const std::filesystem::path& root = "/");

// The path of an open descriptor of this process; empty if it has none.
std::string path_of(int descriptor);

// "agetty (process 412) also has the port open and takes bytes from it: " and the remedy, for the
// first of those that have this descriptor's port open; empty if there is none, or no descriptor
// (-1). Blocks as find_port_users() does.
std::string others_at(int descriptor);

}  // namespace cargobay::hal
