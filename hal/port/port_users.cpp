#include "hal/port/port_users.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <optional>
#include <span>
#include <sstream>

#include "hal/machine/task_list.hpp"
#include "hal/port/pty_transport.hpp"
#include "rt/kernel_file.hpp"

namespace cargobay::hal {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& path) {
  const std::string text = rt::kernel_file(path);
  return text.substr(0, text.find('\n'));
}

// A device, under whatever name; in tests, a file.
class Port {
 public:
  static std::optional<Port> at(const std::string& path) {
    Port port;
    if (stat(path.c_str(), &port.seen_) != 0) return std::nullopt;
    port.pty_ = hal::is_pty(path);
    return port;
  }

  bool is(const struct stat& other) const {
    if (!S_ISCHR(seen_.st_mode))
      return other.st_dev == seen_.st_dev && other.st_ino == seen_.st_ino;
    // Each devpts, such as a container's, numbers its terminals from 0.
    return S_ISCHR(other.st_mode) && other.st_rdev == seen_.st_rdev &&
           (!is_pty() || other.st_dev == seen_.st_dev);
  }
  bool is_pty() const { return pty_; }
  // Of a pseudo-terminal.
  std::string index() const { return std::to_string(minor(seen_.st_rdev)); }
  // In proc(5)'s numbering of the terminal that controls a process (kernel: new_encode_dev()).
  long terminal() const {
    const unsigned low = minor(seen_.st_rdev) & 0xffU;
    const unsigned high = (minor(seen_.st_rdev) & ~0xffU) << 12U;
    return S_ISCHR(seen_.st_mode) ? static_cast<long>(low | (major(seen_.st_rdev) << 8U) | high)
                                  : 0;
  }
  // The name of the file in /proc/locks.
  std::string lock_name() const {
    std::array<char, 64> name{};
    (void)std::snprintf(name.data(), name.size(), "%02x:%02x:%llu",  // it fits
                        major(seen_.st_dev), minor(seen_.st_dev),
                        static_cast<unsigned long long>(seen_.st_ino));
    return name.data();
  }

 private:
  struct stat seen_{};
  bool pty_ = false;
};

// What a look at one process's files shows.
enum class Holding : std::uint8_t { nothing, port, other_side, unseen };

// Looks only at what may be a terminal: a file on a network that is down would block.
bool may_be_terminal(std::string_view link) {
  return link.find("/dev/") != std::string_view::npos || link.find("tty") != std::string_view::npos;
}

// Whether descriptor `name` is the virtual Create's side (proc(5), fdinfo: tty-index).
bool is_master(const Port& port, const fs::path& process, const std::string& name) {
  std::istringstream lines{rt::kernel_file(process / "fdinfo" / name)};
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("tty-index:"))
      return line.substr(line.find_last_of(" \t") + 1) == port.index();
  }
  return false;
}

Holding look(const Port& port, const fs::path& process) {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder{opendir((process / "fd").c_str()), &closedir};
  if (!folder) return errno == EACCES || errno == EPERM ? Holding::unseen : Holding::nothing;
  const int descriptor = dirfd(folder.get());
  if (descriptor < 0) return Holding::nothing;
  Holding holding = Holding::nothing;
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the folder is this function's own
  while (const dirent* const entry = readdir(folder.get())) {
    const std::string name = static_cast<const char*>(entry->d_name);
    std::array<char, 256> target{};
    const ssize_t length = readlinkat(descriptor, name.c_str(), target.data(), target.size());
    if (length <= 0) continue;
    const std::string_view link{target.data(), static_cast<std::size_t>(length)};
    if (port.is_pty() && link.ends_with("ptmx") && is_master(port, process, name))
      return Holding::other_side;
    struct stat file{};
    if (may_be_terminal(link) && fstatat(descriptor, name.c_str(), &file, 0) == 0 && port.is(file))
      holding = Holding::port;
  }
  return holding;
}

// By flock(): proc(5), "1: FLOCK  ADVISORY  WRITE 412 00:06:93 0 EOF".
std::vector<pid_t> lockers(const Port& port, const fs::path& proc) {
  std::vector<pid_t> found;
  std::istringstream lines{rt::kernel_file(proc / "locks")};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words{line};
    std::string number;
    std::string kind;
    std::string advisory;
    std::string use;
    std::string file;
    pid_t process = 0;
    if (words >> number >> kind >> advisory >> use >> process >> file && kind == "FLOCK" &&
        file == port.lock_name())
      found.push_back(process);
  }
  return found;
}

// A guard is listed only if the program that it belongs to is not.
bool is_guard_name(std::string_view name) { return name == "cargobay-guard"; }

enum class Kind : std::uint8_t {
  login_prompt,
  session,
  terminal_program,
  modem_manager,
  brltty,
  cargobay,
  guard,
  other
};

Kind kind_of(std::string_view name) {
  constexpr std::array kSessions{"login", "bash", "sh",   "dash", "zsh", "fish", "ksh",
                                 "tcsh",  "csh",  "sudo", "su",   "ash", "sshd"};
  constexpr std::array kTerminals{"screen",   "SCREEN", "minicom", "picocom", "tio",    "cu",
                                  "microcom", "putty",  "gtkterm", "tmux",    "kermit", "cutecom"};
  const auto is_one_of = [&](const auto& names) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (name.find("getty") != std::string_view::npos) return Kind::login_prompt;
  if (is_one_of(kSessions)) return Kind::session;
  if (is_one_of(kTerminals)) return Kind::terminal_program;
  if (name == "ModemManager") return Kind::modem_manager;
  if (name.starts_with("brltty")) return Kind::brltty;
  if (is_guard_name(name)) return Kind::guard;
  if (name.starts_with("cargobay")) return Kind::cargobay;
  return Kind::other;
}

// "serial-getty@ttyAMA0.service"; empty if systemd did not start it as a service.
std::string service_of(const fs::path& process) {
  std::istringstream lines{rt::kernel_file(process / "cgroup")};
  for (std::string line; std::getline(lines, line);) {
    const std::string last = line.substr(line.rfind('/') + 1);
    if (last.ends_with(".service")) return last;
  }
  return "";
}

// Because of the kernel's command line, systemd starts a login prompt there, whatever is disabled.
std::string and_console(const std::string& service, const fs::path& root) {
  const std::size_t at = service.find('@');
  if (at == std::string::npos) return "";
  const std::string tty = service.substr(at + 1, service.rfind('.') - at - 1);
  const std::string words = " " + first_line(root / "proc/cmdline");
  if (words.find(" console=" + tty) == std::string::npos) return "";
  return ", and remove console=" + tty + " from the kernel's command line, which starts it again";
}

std::string no_login_prompt(const std::string& service, const fs::path& root) {
  if (service.find("getty") != std::string::npos)
    return "sudo systemctl disable --now " + service + and_console(service, root);
  std::error_code error;
  if (fs::exists(root / "run/systemd/system", error))
    return "turn off its login prompt: sudo systemctl disable --now serial-getty@NAME.service, "
           "NAME being the port's, without /dev/";
  return "remove its line from /etc/inittab, then: sudo telinit q";
}

}  // namespace

PortUsers find_port_users(const std::string& path, const fs::path& root) {
  PortUsers users;
  const auto port = Port::at(path);
  if (!port) return users;
  const fs::path proc = root / "proc";
  const std::vector<pid_t> locked = lockers(*port, proc);
  const pid_t own = getpid();
  std::vector<std::pair<pid_t, PortUser>> guards;  // listed after their parents
  for (const fs::path& process : processes(proc)) {
    const auto task = read_task(process);
    if (!task || task->of_kernel || task->id == own) continue;
    Holding holding = look(*port, process);
    const bool locks = std::ranges::find(locked, task->id) != locked.end();
    if (holding == Holding::unseen) {
      const bool controls =
          !port->is_pty() && task->terminal != 0 && task->terminal == port->terminal();
      if (controls || locks)
        holding = Holding::port;
      else
        ++users.unseen;
    }
    if (holding != Holding::port) continue;
    const PortUser user{.id = task->id, .name = task->name, .locks = locks};
    if (is_guard_name(task->name))
      guards.emplace_back(task->parent, user);
    else
      users.found.push_back(user);
  }
  for (const auto& [parent, guard] : guards) {
    if (parent != own && std::ranges::find(users.found, parent, &PortUser::id) == users.found.end())
      users.found.push_back(guard);
  }
  std::ranges::sort(users.found, {}, &PortUser::id);
  return users;
}

bool is_guard(const PortUser& user) { return is_guard_name(user.name); }

std::string describe(const PortUser& user) {
  return user.name + " (process " + std::to_string(user.id) + ")";
}

std::string describe(const std::vector<PortUser>& users) {
  std::string text;
  for (const PortUser& user : users) text += (text.empty() ? "" : ", ") + describe(user);
  return text;
}

std::string remedy(const PortUser& user, const fs::path& root) {
  const std::string service = service_of(root / "proc" / std::to_string(user.id));
  const std::string end = "end it (kill " + std::to_string(user.id) + ")";
  switch (kind_of(user.name)) {
    case Kind::login_prompt: return no_login_prompt(service, root);
    case Kind::session:
      return "a user is logged in on this terminal: log out there and turn off its login prompt, "
             "or name another port";
    case Kind::terminal_program: return "close it: one program at a time can talk to the robot";
    case Kind::modem_manager:
      return "sudo systemctl mask --now ModemManager.service; or set ID_MM_DEVICE_IGNORE for the "
             "adapter in a udev rule";
    case Kind::brltty:
      return "it takes the adapter for a Braille display: sudo apt remove brltty, or: sudo "
             "systemctl "
             "mask --now brltty-udev.service brltty.service";
    case Kind::guard: return "it stops the robot of a program that died: wait a few seconds";
    case Kind::cargobay: return "stop it (Ctrl-C there, or kill " + std::to_string(user.id) + ")";
    case Kind::other: break;
  }
  if (!service.empty() && !service.starts_with("user@"))
    return "end it (sudo systemctl stop " + service + "), or name another port";
  return end + ", or name another port";
}

std::string path_of(int descriptor) {
  if (descriptor < 0) return "";
  std::error_code error;
  const fs::path path = fs::read_symlink("/proc/self/fd/" + std::to_string(descriptor), error);
  return error ? "" : path.string();
}

std::string others_at(int descriptor) {
  const std::string path = path_of(descriptor);
  if (path.empty()) return "";
  const PortUsers users = find_port_users(path);
  if (users.found.empty()) return "";
  return describe(users.found.front()) +
         " also has the port open and takes bytes from it: " + remedy(users.found.front());
}

}  // namespace cargobay::hal
