// The threads of this machine, as /proc lists them.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cargobay::hal {

struct Task {
  pid_t id = 0;
  std::string name{};
  pid_t parent = 0;
  long terminal = 0;  // the number of its controlling terminal (proc(5), tty_nr); 0: none
  long priority = 0;  // of SCHED_FIFO and SCHED_RR; 0 for others
  bool of_kernel = false;

  // One of the kworkers that are not bound to a CPU: they hand the bytes of terminals to their
  // readers, among everything else that the kernel defers (kernel: flush_to_ldisc()).
  bool is_unbound_kworker() const { return of_kernel && name.starts_with("kworker/u"); }
};

// The folder of one thread, such as /proc/1/task/1; nothing if it has ended.
std::optional<Task> read_task(const std::filesystem::path& folder);

// The folders of all processes under `proc`, in any order.
std::vector<std::filesystem::path> processes(const std::filesystem::path& proc);

// The threads of the kernel under `proc`: one read a process, so a few ms; allocates.
std::vector<Task> kernel_threads(const std::filesystem::path& proc);

}  // namespace cargobay::hal
