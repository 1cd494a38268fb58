// What the kernel lets this process have: capabilities and limits, and who could give it more. What
// the kernel answers when it is asked is the truth; this only explains it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace cargobay::rt {

// As numbered by the kernel (capability.h).
enum class Capability : std::uint8_t { ipc_lock = 14, sys_nice = 23 };

struct Rights {
  // Where this process comes from, and so where its rights do.
  enum class Origin : std::uint8_t { login, service, container };
  Origin origin = Origin::login;
  std::uint64_t effective = 0;  // capabilities of the calling thread, a bit each
  // Root of a user namespace: its capabilities count only inside, and not for what the loop needs.
  bool namespaced = false;
  bool filtered = false;                      // system calls are (seccomp)
  bool no_realtime_budget = false;            // cpu.rt_runtime_us of its control group is 0
  std::optional<std::uint64_t> task_limit{};  // of a control group that has as many tasks already
  std::uint64_t priority_limit = 0;           // RLIMIT_RTPRIO
  std::optional<std::uint64_t> lock_limit{};  // RLIMIT_MEMLOCK in bytes; none: unlimited

  bool has(Capability capability) const {
    return !namespaced && ((effective >> static_cast<unsigned>(capability)) & 1U) != 0;
  }
};

// Of the calling thread. Reads a few files under `root`, which is another for tests: blocks for as
// long as that takes; allocates.
Rights own_rights(const std::filesystem::path& root = "/");

}  // namespace cargobay::rt
