#include "rt/rights.hpp"

#include <linux/capability.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "rt/kernel_file.hpp"

namespace cargobay::rt {
namespace {

namespace fs = std::filesystem;

std::optional<std::int64_t> number(const fs::path& path) {
  std::int64_t value = 0;
  std::istringstream text{kernel_file(path)};
  if (text >> value) return value;
  return std::nullopt;  // "max" too
}

std::uint64_t effective_capabilities() {
  __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  std::array<__user_cap_data_struct, 2> sets{};
  if (syscall(SYS_capget, &header, sets.data()) != 0) return 0;
  return sets[0].effective | (std::uint64_t{sets[1].effective} << 32U);
}

// Whether a program started by this process could still be given it.
bool within_bounds(Capability capability) {
  return prctl(PR_CAPBSET_READ, static_cast<unsigned long>(capability), 0, 0, 0) == 1;
}

// cgroups(7): "ID:CONTROLLERS:PATH", one line a hierarchy; the unified one lists no controllers.
struct Group {
  std::string controllers;
  std::string path;
};
std::vector<Group> groups(const fs::path& root) {
  std::vector<Group> found;
  std::istringstream lines{kernel_file(root / "proc/self/cgroup")};
  for (std::string line; std::getline(lines, line);) {
    const std::size_t first = line.find(':');
    const std::size_t second = line.find(':', first + 1);
    if (second == std::string::npos) continue;
    found.push_back({line.substr(first + 1, second - first - 1), line.substr(second + 1)});
  }
  return found;
}

// The folders that may hold a group's files, its own first.
std::vector<fs::path> folders(const fs::path& root, const Group& group) {
  const fs::path mounts = root / "sys/fs/cgroup";
  const fs::path below = fs::path{group.path}.relative_path();
  std::vector<fs::path> found;
  for (const fs::path& mount : {mounts / group.controllers, mounts / "unified"}) {
    for (fs::path folder = below;; folder = folder.parent_path()) {
      found.push_back(mount / folder);
      if (folder.empty() || folder == folder.parent_path()) break;
    }
  }
  return found;
}

bool lists(const Group& group, std::string_view controller) {
  return ("," + group.controllers + ",").find("," + std::string{controller} + ",") !=
         std::string::npos;
}

// Only kernels with CONFIG_RT_GROUP_SCHED have the file.
bool lacks_realtime_budget(const fs::path& root) {
  for (const Group& group : groups(root)) {
    if (lists(group, "cpu"))
      return number(root / "sys/fs/cgroup" / group.controllers /
                    fs::path{group.path}.relative_path() / "cpu.rt_runtime_us") == 0;
  }
  return false;
}

std::optional<std::uint64_t> reached_task_limit(const fs::path& root) {
  for (const Group& group : groups(root)) {
    if (!group.controllers.empty() && !lists(group, "pids")) continue;
    for (const fs::path& folder : folders(root, group)) {
      const auto most = number(folder / "pids.max");
      const auto now = number(folder / "pids.current");
      if (most && now && *now >= *most) return static_cast<std::uint64_t>(*most);
    }
  }
  return std::nullopt;
}

std::optional<std::uint64_t> nearly_reached_memory_limit(const fs::path& root) {
  constexpr std::int64_t kNearly = 4L << 20;
  for (const Group& group : groups(root)) {
    if (!group.controllers.empty() && !lists(group, "memory")) continue;
    for (const fs::path& folder : folders(root, group)) {
      const bool unified = group.controllers.empty();
      const auto most = number(folder / (unified ? "memory.max" : "memory.limit_in_bytes"));
      const auto now = number(folder / (unified ? "memory.current" : "memory.usage_in_bytes"));
      if (most && now && *now >= *most - kNearly) return static_cast<std::uint64_t>(*most);
    }
  }
  return std::nullopt;
}

// statm, proc(5): its first figure is the size of the address space, in pages.
std::optional<std::uint64_t> address_space_left(const fs::path& root) {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return std::nullopt;
  const auto pages = number(root / "proc/self/statm");
  if (!pages) return std::nullopt;
  const std::uint64_t used =
      static_cast<std::uint64_t>(*pages) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  return limit.rlim_cur - std::min<std::uint64_t>(used, limit.rlim_cur);
}

// Neither root nor whoever has one of these capabilities is held to it (kernel: copy_process()).
std::optional<std::uint64_t> process_limit(const Rights& rights) {
  rlimit limit{};
  const bool exempt = (getuid() == 0 && !rights.namespaced) ||
                      rights.has(Capability::sys_resource) || rights.has(Capability::sys_admin);
  if (exempt || getrlimit(RLIMIT_NPROC, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return std::nullopt;
  return limit.rlim_cur;
}

bool is_service(const fs::path& root) {
  for (const Group& group : groups(root)) {
    const bool of_systemd = group.controllers.empty() || group.controllers == "name=systemd";
    if (of_systemd && group.path.ends_with(".service")) return true;
  }
  return false;
}

// Docker, podman, and systemd in any container each leave a sign.
bool has_container_sign(const fs::path& root) {
  std::error_code error;
  for (const char* const sign : {".dockerenv", "run/.containerenv", "run/systemd/container"}) {
    if (fs::exists(root / sign, error)) return true;
  }
  return false;
}

Rights::Origin origin(const fs::path& root) {
  if (has_container_sign(root)) return Rights::Origin::container;
  if (is_service(root)) return Rights::Origin::service;
  // Not even root can get a capability that the bounding set lacks; only the outside can grant it.
  const bool bounded = !within_bounds(Capability::sys_nice) || !within_bounds(Capability::ipc_lock);
  return bounded ? Rights::Origin::container : Rights::Origin::login;
}

// user_namespaces(7): only the first namespace maps all numbers.
bool is_namespaced(const fs::path& root) {
  constexpr std::uint64_t kAll = 4294967295;
  std::istringstream map{kernel_file(root / "proc/self/uid_map")};
  std::uint64_t inside = 0;
  std::uint64_t outside = 0;
  std::uint64_t count = 0;
  if (!(map >> inside >> outside >> count)) return false;
  return inside != 0 || outside != 0 || count != kAll;
}

bool is_filtered(const fs::path& root) {
  const std::string status = kernel_file(root / "proc/self/status");
  return status.find("\nSeccomp:\t2") != std::string::npos;
}

}  // namespace

Rights own_rights(const fs::path& root) {
  Rights rights{.origin = origin(root),
                .effective = effective_capabilities(),
                .namespaced = is_namespaced(root),
                .filtered = is_filtered(root),
                .no_realtime_budget = lacks_realtime_budget(root),
                .task_limit = reached_task_limit(root),
                .address_space_left = address_space_left(root),
                .memory_limit = nearly_reached_memory_limit(root)};
  rights.process_limit = process_limit(rights);
  rlimit limit{};
  if (getrlimit(RLIMIT_RTPRIO, &limit) == 0) rights.priority_limit = limit.rlim_cur;
  if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    rights.lock_limit = limit.rlim_cur;
  return rights;
}

}  // namespace cargobay::rt
