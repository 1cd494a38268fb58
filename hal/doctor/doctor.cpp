#include "hal/doctor/doctor.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <iomanip>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "gpio/line.hpp"
#include "hal/machine/task_list.hpp"
#include "hal/port/port_users.hpp"
#include "rt/kernel_file.hpp"

namespace cargobay::hal {
namespace {

namespace fs = std::filesystem;
using Verdict = Finding::Verdict;

constexpr long kLeastRealtimePercent = 80;  // the loop needs 2, other threads may take some
constexpr int kLongestTimerMs = 2;
constexpr int kLongestWakeUs = 100;  // from sleep: a hundredth of the period or less

std::string contents(const fs::path& path) {
  std::string text = rt::kernel_file(path);
  while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) text.pop_back();
  return text;
}

std::optional<long> number(std::string_view text) {
  long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// The entries of a folder by name; empty if it cannot be read.
std::vector<fs::path> entries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (fs::directory_iterator entry{folder, error}, end; !error && entry != end;
       entry.increment(error)) {
    found.push_back(entry->path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string joined(const std::set<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

// "0-3,5" is five CPUs.
int count_cpus(std::string_view list) {
  int count = 0;
  while (!list.empty()) {
    const std::string_view range = list.substr(0, list.find(','));
    list.remove_prefix(std::min(list.size(), range.size() + 1));
    const std::size_t dash = std::min(range.find('-'), range.size());
    const auto first = number(range.substr(0, dash));
    const auto last = dash == range.size() ? first : number(range.substr(dash + 1));
    if (first && last) count += static_cast<int>(*last - *first) + 1;
  }
  return count;
}

Finding kernel(const fs::path& root) {
  const std::string version = contents(root / "proc/sys/kernel/version");
  const bool realtime = contents(root / "sys/kernel/realtime") == "1" ||
                        version.find("PREEMPT_RT") != std::string::npos;
  if (realtime) return {"kernel", Verdict::good, "the kernel is PREEMPT_RT"};
  return {
      "kernel", Verdict::advice, "the kernel is not PREEMPT_RT: " + version,
      "install Debian's linux-image-rt-arm64 (-amd64), or linux-image-rpi-v8-rt on Raspberry Pi "
      "OS"};
}

// explain() puts the remedy after a colon.
Finding refusal(std::string_view check, Verdict verdict, const rt::Refusal& refusal,
                const rt::Rights& rights) {
  const std::string text = rt::explain(refusal, rights);
  const std::size_t colon = text.find(": ");
  Finding finding{check, verdict, text.substr(0, colon)};
  if (colon != std::string::npos) finding.remedy = text.substr(colon + 2);
  return finding;
}

std::vector<Finding> rights(const Examination& examination) {
  const rt::RealtimeGrant& grant = examination.grant;
  std::vector<Finding> findings;
  if (grant.fifo)
    findings.push_back({"fifo", Verdict::good,
                        "SCHED_FIFO priority " + std::to_string(grant.priority) + " is granted"});
  if (grant.memory_locked && grant.lock_limit_bytes == 0)
    findings.push_back({"memory", Verdict::good, "memory can be locked"});
  if (grant.dma_latency_held)
    findings.push_back({"sleep", Verdict::good, "the CPU is kept from deep sleep"});
  for (const rt::Refusal& refused : grant.refusals) {
    switch (refused.right) {
      case rt::Refusal::Right::fifo:
        findings.push_back(refusal("fifo", Verdict::bad, refused, examination.rights));
        break;
      case rt::Refusal::Right::memory_lock:
        findings.push_back(refusal("memory", Verdict::bad, refused, examination.rights));
        break;
      case rt::Refusal::Right::whole_memory:
        findings.push_back(refusal("memory", Verdict::advice, refused, examination.rights));
        break;
      case rt::Refusal::Right::dma_latency:
        findings.push_back(refusal("sleep", Verdict::advice, refused, examination.rights));
        break;
      case rt::Refusal::Right::affinity:
      case rt::Refusal::Right::stack:
      case rt::Refusal::Right::thread:
        findings.push_back(refusal("thread", Verdict::bad, refused, examination.rights));
        break;
    }
  }
  return findings;
}

Finding throttling(const fs::path& root) {
  const auto runtime = number(contents(root / "proc/sys/kernel/sched_rt_runtime_us"));
  const auto period = number(contents(root / "proc/sys/kernel/sched_rt_period_us"));
  if (!runtime || !period || *period <= 0 || *runtime < 0)
    return {"throttling", Verdict::good, "real-time threads are not throttled"};
  const long percent = 100 * *runtime / *period;
  const std::string what = "real-time threads may use " + std::to_string(percent) + " % of a CPU";
  if (percent >= kLeastRealtimePercent) return {"throttling", Verdict::good, what};
  return {"throttling", Verdict::bad, what,
          "sudo sysctl kernel.sched_rt_runtime_us=" + std::to_string(*period / 100 * 95)};
}

Finding governor(const fs::path& root) {
  std::set<std::string> slow;
  bool scaled = false;
  for (const fs::path& cpu : entries(root / "sys/devices/system/cpu")) {
    const std::string chosen = contents(cpu / "cpufreq/scaling_governor");
    scaled = scaled || !chosen.empty();
    if (!chosen.empty() && chosen != "performance") slow.insert(chosen);
  }
  if (!scaled) return {"governor", Verdict::good, "the clock is not scaled by the kernel"};
  if (slow.empty()) return {"governor", Verdict::good, "the clock stays at its highest"};
  return {"governor", Verdict::advice, "the clock follows the load (" + joined(slow) + ")",
          "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor"};
}

// Only matters if the request at /dev/cpu_dma_latency is refused.
std::optional<Finding> deep_sleep(const Examination& examination, const fs::path& root) {
  if (examination.grant.dma_latency_held) return std::nullopt;
  std::set<std::string> deep;
  for (const fs::path& state : entries(root / "sys/devices/system/cpu/cpu0/cpuidle")) {
    const auto latency = number(contents(state / "latency"));
    if (latency && *latency > kLongestWakeUs && contents(state / "disable") != "1")
      deep.insert(contents(state / "name") + " (" + std::to_string(*latency) + " us)");
  }
  if (deep.empty()) return std::nullopt;
  return Finding{"idle", Verdict::advice, "the CPU may sleep this deeply: " + joined(deep),
                 "see the line about /dev/cpu_dma_latency; or boot with cpuidle.off=1"};
}

// The real-time threads of other programs, at any priority. A guard, of any robot, takes the CPU
// only for a moment, at the end.
std::vector<Task> realtime_programs(const fs::path& root) {
  std::vector<Task> found;
  for (const fs::path& process : processes(root / "proc")) {
    if (process.filename() == std::to_string(getpid())) continue;
    for (const fs::path& thread : entries(process / "task")) {
      const auto task = read_task(thread);
      if (task && !task->of_kernel && task->priority > 0 && task->name != "cargobay-guard")
        found.push_back(*task);
    }
  }
  return found;
}

// "audio (10), hog (20)", each once.
std::string joined(const std::vector<Task>& tasks) {
  std::set<std::string> words;
  for (const Task& task : tasks)
    words.insert(task.name + " (" + std::to_string(task.priority) + ")");
  return joined(words);
}

// Bytes of a terminal reach their reader through a kworker with ordinary priority.
Finding kworkers(const fs::path& root, const std::vector<Task>& programs) {
  std::set<std::string> raised;
  for (const Task& task : kernel_threads(root / "proc")) {
    if (task.is_unbound_kworker() && task.priority > 0)
      raised.insert(std::to_string(task.priority));
  }
  if (!raised.empty()) {
    return {
        "kworkers", Verdict::advice,
        "the kworkers that hand over the port's bytes have real-time priority " + joined(raised) +
            ", as a drive with --boost-kworkers gives them",
        "if that drive was killed: for p in $(pgrep '^kworker/u'); do sudo chrt --other --pid 0 "
        "$p; done"};
  }
  if (!programs.empty()) {
    return {"kworkers", Verdict::advice,
            "real-time programs may keep the kworkers that hand over the port's bytes from the "
            "CPU: " +
                joined(programs),
            "keep a CPU free of them (taskset), or drive with --boost-kworkers"};
  }
  const int cpus = count_cpus(contents(root / "sys/devices/system/cpu/online"));
  if (cpus > 1) {
    return {"kworkers", Verdict::good,
            "of " + std::to_string(cpus) +
                " CPUs, one can be left to the kworkers that hand over the port's bytes"};
  }
  return {"kworkers", Verdict::advice,
          "the one CPU is shared with the kworkers that hand over the port's bytes",
          "run no other real-time program on it, or use a board with more CPUs"};
}

// Ordinary programs delay the kworkers too, if they want more than all CPUs.
std::optional<Finding> load(const fs::path& root) {
  double busy = 0.0;  // programs, averaged over the last minute (proc_loadavg(5))
  if (!(std::istringstream{contents(root / "proc/loadavg")} >> busy)) return std::nullopt;
  const int cpus = count_cpus(contents(root / "sys/devices/system/cpu/online"));
  if (cpus == 0) return std::nullopt;
  std::ostringstream what;
  what << std::fixed << std::setprecision(1) << busy << " busy programs in the last minute, on "
       << cpus << (cpus == 1 ? " CPU" : " CPUs");
  if (busy < cpus) return Finding{"load", Verdict::good, what.str()};
  return Finding{"load", Verdict::advice,
                 what.str() + ": they keep the kworkers that hand over the port's bytes waiting",
                 "stop what is busy (top shows it), or drive with --boost-kworkers"};
}

Finding rivals(const Examination& examination, std::vector<Task> programs) {
  std::erase_if(programs, [&](const Task& task) { return task.priority < examination.priority; });
  if (programs.empty())
    return {"rivals", Verdict::good, "no other program has as high a real-time priority"};
  return {"rivals", Verdict::advice,
          "other programs have as high a real-time priority: " + joined(programs),
          "lower theirs with chrt, or raise the loop's with --priority (98 at most)"};
}

// --- The port ---

// By its rights alone: to open it would disturb a drive.
Finding reachable(const std::string& port, const PortUsers& users) {
  if (access(port.c_str(), R_OK | W_OK) == 0) {
    const auto locked = std::ranges::find_if(users.found, &PortUser::locks);
    if (locked == users.found.end()) return {"port", Verdict::good, "you may open " + port};
    return {"port", Verdict::advice,
            "you have the permission to open " + port + ", but not now: " + describe(*locked) +
                " holds it for itself alone",
            "wait until it has ended"};
  }
  if (errno == ENOENT)
    return {"port", Verdict::bad, "there is no " + port,
            "plug the cable in, or list the ports with: cargobay ports"};
  return {"port", Verdict::bad, "no permission to open " + port,
          "sudo adduser $USER dialout, and log in again"};
}

std::optional<Finding> mini_uart(const fs::path& root, const std::string& tty) {
  const std::string model = contents(root / "proc/device-tree/model");
  if (tty != "ttyS0" || model.find("Raspberry Pi") == std::string::npos) return std::nullopt;
  return Finding{"uart", Verdict::bad,
                 "ttyS0 is the mini-UART: its rate follows the core's clock, and it holds bytes "
                 "back",
                 "use the PL011: dtoverlay=disable-bt in config.txt, then /dev/ttyAMA0"};
}

std::optional<Finding> console(const fs::path& root, const std::string& tty) {
  std::istringstream lines{contents(root / "proc/consoles")};
  for (std::string line; std::getline(lines, line);) {
    if (line.substr(0, line.find(' ')) != tty) continue;
    return Finding{"console", Verdict::bad, "the kernel prints to " + tty,
                   "remove console=" + tty + " (or serial0) from cmdline.txt, and boot again"};
  }
  return std::nullopt;
}

// One finding per user. An ordinary user does not see all of them.
std::vector<Finding> describe_users(const std::string& path, const PortUsers& users,
                                    const fs::path& root) {
  std::vector<Finding> findings;
  findings.reserve(users.found.size());
  for (const PortUser& user : users.found) {
    findings.push_back(
        {"users", Verdict::bad, describe(user) + " has " + path + " open", remedy(user, root)});
  }
  if (!findings.empty()) return findings;
  std::string what = "no other process has it open";
  if (users.unseen > 0) {
    what = "no process of yours has it open; " + std::to_string(users.unseen) +
           " of others cannot be inspected: run as root to see them";
  }
  return {{"users", Verdict::good, what}};
}

std::optional<Finding> latency_timer(const fs::path& root, const std::string& tty) {
  const fs::path file = fs::path{"sys/class/tty"} / tty / "device/latency_timer";
  const auto timer_ms = number(contents(root / file));
  if (!timer_ms || *timer_ms <= kLongestTimerMs) return std::nullopt;
  return Finding{"adapter", Verdict::bad,
                 "the adapter holds bytes back for " + std::to_string(*timer_ms) +
                     " ms, more than the robot's period allows",
                 "echo 1 | sudo tee /" + file.string()};
}

std::vector<Finding> port(const Examination& examination, const fs::path& root) {
  const PortUsers users = find_port_users(examination.port, root);
  std::vector<Finding> findings{reachable(examination.port, users)};
  std::error_code error;
  const std::string tty = fs::weakly_canonical(examination.port, error).filename().string();
  for (auto&& finding : {mini_uart(root, tty), console(root, tty), latency_timer(root, tty)}) {
    if (finding) findings.push_back(*finding);
  }
  if (fs::exists(examination.port, error))
    std::ranges::copy(describe_users(examination.port, users, root), std::back_inserter(findings));
  return findings;
}

Finding pins() {
  std::set<std::string> refused;
  const std::vector<gpio::ChipInfo> chips = gpio::chips();
  for (const gpio::ChipInfo& chip : chips) {
    if (chip.error != 0) refused.insert(chip.path);
  }
  if (chips.empty()) return {"gpio", Verdict::good, "no GPIO chip here; none is needed for USB"};
  if (refused.empty()) return {"gpio", Verdict::good, "the GPIO chips may be used"};
  return {"gpio", Verdict::advice, "no permission to use " + joined(refused),
          "join the group that owns them, or see the udev rule that cargobay bringup names"};
}

}  // namespace

std::vector<Finding> examine(const Examination& examination) {
  const fs::path root = examination.root + "/";
  std::vector<Finding> findings{kernel(root)};
  std::ranges::copy(rights(examination), std::back_inserter(findings));
  findings.push_back(throttling(root));
  findings.push_back(governor(root));
  if (auto finding = deep_sleep(examination, root)) findings.push_back(*finding);
  const std::vector<Task> programs = realtime_programs(root);
  findings.push_back(kworkers(root, programs));
  if (auto finding = load(root)) findings.push_back(*finding);
  findings.push_back(rivals(examination, programs));
  if (!examination.port.empty())
    std::ranges::copy(port(examination, root), std::back_inserter(findings));
  findings.push_back(pins());
  return findings;
}

std::string_view name(Finding::Verdict verdict) {
  switch (verdict) {
    case Verdict::good: return "good";
    case Verdict::advice: return "advice";
    case Verdict::bad: return "bad";
  }
  return "";
}

bool all_well(const std::vector<Finding>& findings) {
  return std::ranges::none_of(
      findings, [](const Finding& finding) { return finding.verdict == Verdict::bad; });
}

}  // namespace cargobay::hal
