// Where the feed of a port is (docs/feed.md).
#pragma once

#include <string>
#include <vector>

#include "hal/result.hpp"

namespace cargobay::hal {

// The port's path from the root on. Its links stay: where they lead changes when an adapter is
// plugged in again. What is not a path keeps its name. Blocks for the file system.
std::string lasting_name(const std::string& port);

// The socket's name: that of the port without the first slash, others as `-`.
std::string feed_name(const std::string& port);

// The folder for feeds of this process, made if need be. A failure says which folder could not be
// used and what to do. Reads the environment; blocks for the file system.
Result<std::string> feed_folder();

// Removes the folder if feed_folder() may have made it and nothing is in it any longer.
void leave_folder(const std::string& folder);

// Whether what listens at `path`, the other end of `socket`, is a process of this user, of root, or
// of the user whom root has given the folder of a service, /run/cargobay or /run/cargobay-PORT.
bool is_trusted_peer(int socket, const std::string& path);

struct FoundFeed {
  std::string name{};  // of the port, as feed_name() makes it
  std::string socket{};
};
// The feeds that are published now where this user looks, in the order of the folders. Those of
// dead processes are left out, and those of simulators, which are hidden. Whom to trust
// is_trusted_peer() says.
std::vector<FoundFeed> find_feeds();

}  // namespace cargobay::hal
