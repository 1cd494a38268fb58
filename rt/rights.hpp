// What the kernel allows this process: capabilities and limits, and who could grant more. The truth
// is what the kernel answers when it is asked; this only explains it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace cargobay::rt {

// As numbered by the kernel (capability.h).
enum class Capability : std::uint8_t {
  ipc_lock = 14,
  sys_admin = 21,
  sys_nice = 23,
  sys_resource = 24
};

struct Rights {
  // How this process was started, and so where its rights come from.
  enum class Origin : std::uint8_t { login, service, container };
  Origin origin = Origin::login;
  std::uint64_t effective = 0;  // capabilities of the calling thread, one bit each
  // Root of a user namespace: its capabilities count only inside, and not for what the loop needs.
  bool namespaced = false;
  bool filtered = false;                      // system calls are filtered (seccomp)
  bool no_realtime_budget = false;            // cpu.rt_runtime_us of its control group is 0
  std::optional<std::uint64_t> task_limit{};  // of a control group that has reached it
  // What is left of its address space in bytes (RLIMIT_AS); none: unlimited.
  std::optional<std::uint64_t> address_space_left{};
  // The most memory in bytes that a control group allows, if it is nearly used up.
  std::optional<std::uint64_t> memory_limit{};
  std::optional<std::uint64_t> process_limit{};  // RLIMIT_NPROC, if this user is held to it
  std::uint64_t priority_limit = 0;              // RLIMIT_RTPRIO
  std::optional<std::uint64_t> lock_limit{};     // RLIMIT_MEMLOCK in bytes; none: unlimited

  bool has(Capability capability) const {
    return !namespaced && ((effective >> static_cast<unsigned>(capability)) & 1U) != 0;
  }
};

// Of the calling thread. Reads a few files under `root`, which tests replace, and blocks for as
// long as that takes; allocates.
Rights own_rights(const std::filesystem::path& root = "/");

}  // namespace cargobay::rt
