// A library to preload: it makes one system call on the robot's port fail, once. The program under
// test and its guard are the shipped ones; the C library functions that they call are wrapped here.
//
// Environment:
//   FAULT_PORT   path of the port; the calls are those on any descriptor of this device
//   FAULT_WHO    program (default) or guard: the process that meets the fault
//   FAULT_PHASE  bring_up, drive, leave: which calls are counted; all of them without it
//   FAULT_CALL   open read write poll ioctl fcntl flock close fstat dup tcgetattr tcsetattr tcflush
//                tcdrain isatty; nothing fails without it
//   FAULT_AT     the call that fails, from 1
//   FAULT_ERROR  an errno as a number; or SHORT (one byte), ZERO (returns 0), HUP, NVAL (poll's)
//   FAULT_LOG    file that gets a line for what happened
//
// A failing call is not made, except for close(), which frees the number even when it fails.
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <span>
#include <string_view>

namespace {

constexpr std::array<std::string_view, 15> kCalls{
    "open",  "read", "write",     "poll",      "ioctl",   "fcntl",   "flock", "close",
    "fstat", "dup",  "tcgetattr", "tcsetattr", "tcflush", "tcdrain", "isatty"};

consteval std::size_t call(std::string_view name) {
  return static_cast<std::size_t>(std::ranges::find(kCalls, name) - kCalls.begin());
}

// Recognised by what is written: the first command that turns a wheel begins the drive, the next
// that stops both ends it.
enum class Phase : std::uint8_t { bring_up, drive, leave };
constexpr std::array<std::string_view, 3> kPhases{"bring_up", "drive", "leave"};

std::size_t index(Phase phase) { return static_cast<std::size_t>(phase); }

enum class Kind : std::uint8_t { short_count, zero, hang_up, not_open, error };
constexpr std::array<std::string_view, 4> kKinds{"SHORT", "ZERO", "HUP", "NVAL"};

struct Plan {
  bool chosen = false;  // this process is to meet the fault
  bool guard = false;   // this process is a guard
  dev_t port = 0;       // 0: nothing is wrapped
  std::optional<Phase> phase{};
  std::optional<std::size_t> call{};
  std::uint64_t at = 0;
  Kind kind = Kind::error;
  int error = 0;
  const char* log = nullptr;
};

Plan plan;
std::atomic<Phase> phase{Phase::bring_up};
std::array<std::array<std::atomic<std::uint64_t>, kCalls.size()>, kPhases.size()> counts{};
std::atomic<std::uint64_t> seen{0};
std::atomic<bool> told_stop{false};

// The C library's own function, in a function of the same name.
#define CARGOBAY_NEXT(function) \
  static const auto real = reinterpret_cast<decltype(&(function))>(dlsym(RTLD_NEXT, #function))

// A line of the log: time, who, what, phase, call, number. Uses raw system calls, so that nothing
// it does comes by here again.
void note(const char* what, std::string_view when = "-", std::string_view which = "-",
          std::uint64_t number = 0) {
  if (plan.log == nullptr) return;
  const int error = errno;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  std::array<char, 200> line{};
  const int length = std::snprintf(
      line.data(), line.size(), "%ld.%09ld %s %s %.*s %.*s %llu\n", now.tv_sec, now.tv_nsec,
      plan.guard ? "guard" : "program", what, static_cast<int>(when.size()), when.data(),
      static_cast<int>(which.size()), which.data(), static_cast<unsigned long long>(number));
  const long file =
      syscall(SYS_openat, AT_FDCWD, plan.log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file >= 0) {
    syscall(SYS_write, file, line.data(), static_cast<std::size_t>(length));
    syscall(SYS_close, file);
  }
  errno = error;
}

bool is_port(int descriptor) {
  if (plan.port == 0 || descriptor < 0) return false;
  const int error = errno;
  struct stat file{};
  const bool found = syscall(SYS_newfstatat, descriptor, "", &file, AT_EMPTY_PATH) == 0 &&
                     S_ISCHR(file.st_mode) && file.st_rdev == plan.port;
  errno = error;
  return found;
}

bool is_port(const char* path) {
  if (plan.port == 0) return false;
  const int error = errno;
  struct stat file{};
  const bool found = syscall(SYS_newfstatat, AT_FDCWD, path, &file, 0) == 0 &&
                     S_ISCHR(file.st_mode) && file.st_rdev == plan.port;
  errno = error;
  return found;
}

// Whether this call, on the port, is the one.
bool fails(std::size_t call) {
  const Phase now = phase.load();
  const std::uint64_t count = ++counts[index(now)][call];
  if (!plan.chosen || plan.call != call || (plan.phase.value_or(now) != now)) return false;
  const std::uint64_t number = plan.phase ? count : ++seen;
  if (number != plan.at) return false;
  note("fault", kPhases[index(now)], kCalls[call], number);
  if (plan.kind == Kind::error) errno = plan.error;
  return true;
}

// What the log says about bytes: the phases, the guard's stop, and zeros before a command, which
// only complete one that was cut. The rest of a write does not begin a command.
void look_at(std::span<const std::uint8_t> bytes) {
  const auto first = std::ranges::find_if(bytes, [](std::uint8_t byte) { return byte != 0; });
  const auto zeros = static_cast<std::size_t>(first - bytes.begin());
  if (zeros > 0) note("fills", "-", "-", zeros);
  const auto command = bytes.subspan(zeros);
  constexpr std::uint8_t kDriveDirect = 145;
  if (command.size() < 5 || command[0] != kDriveDirect) return;
  const bool turns =
      std::ranges::any_of(command.subspan(1, 4), [](auto byte) { return byte != 0; });
  if (plan.guard && !turns && !told_stop.exchange(true)) note("stops");
  const Phase now = phase.load();
  if (turns && now == Phase::bring_up) phase = Phase::drive;
  if (!turns && now == Phase::drive) phase = Phase::leave;
}

// A wait on the port; sets what it returns then.
bool poll_fails(std::span<pollfd> files, int& result) {
  if (std::ranges::none_of(files, [](const pollfd& file) { return is_port(file.fd); }))
    return false;
  if (!fails(call("poll"))) return false;
  result = plan.kind == Kind::zero ? 0 : -1;
  if (plan.kind != Kind::hang_up && plan.kind != Kind::not_open) return true;
  result = 0;
  for (pollfd& file : files) {
    file.revents = 0;
    if (!is_port(file.fd)) continue;
    file.revents = plan.kind == Kind::hang_up ? POLLHUP : POLLNVAL;
    ++result;
  }
  return true;
}

// Empty if it is not set.
const char* setting(const char* name) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): before main()
  const char* const value = std::getenv(name);
  return value != nullptr ? value : "";
}

template <std::size_t kCount>
std::optional<std::size_t> find(const std::array<std::string_view, kCount>& names,
                                std::string_view wanted) {
  const auto* const found = std::ranges::find(names, wanted);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

int number(std::string_view text) {
  int value = 0;
  (void)std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

[[gnu::constructor]] void begin() {
  plan.guard = std::string_view{program_invocation_short_name} == "cargobay-guard";
  plan.chosen = plan.guard == (std::string_view{setting("FAULT_WHO")} == "guard");
  plan.log = *setting("FAULT_LOG") != '\0' ? setting("FAULT_LOG") : nullptr;
  if (const auto wanted = find(kPhases, setting("FAULT_PHASE"))) {
    plan.phase = static_cast<Phase>(*wanted);
  }
  plan.call = find(kCalls, setting("FAULT_CALL"));
  plan.at = static_cast<std::uint64_t>(number(setting("FAULT_AT")));
  const std::string_view error = setting("FAULT_ERROR");
  const auto kind = find(kKinds, error);
  plan.kind = kind ? static_cast<Kind>(*kind) : Kind::error;
  plan.error = number(error);
  struct stat file{};
  const char* const port = setting("FAULT_PORT");
  if (syscall(SYS_newfstatat, AT_FDCWD, port, &file, 0) == 0) plan.port = file.st_rdev;
}

[[gnu::destructor]] void end() {
  if (plan.port == 0) return;
  for (std::size_t when = 0; when < kPhases.size(); ++when) {
    for (std::size_t what = 0; what < kCalls.size(); ++what) {
      const std::uint64_t count = counts[when][what].load();
      if (count > 0) note("count", kPhases[when], kCalls[what], count);
    }
  }
}

}  // namespace

// The parameters' names in the C library are reserved ones.
// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name)
extern "C" {

// The mode argument may or may not be there; it is passed on either way.
#define CARGOBAY_WRAP_OPEN(function)                           \
  int function(const char* path, int flags, ...) {             \
    CARGOBAY_NEXT(function);                                   \
    va_list rest;                                              \
    va_start(rest, flags);                                     \
    const auto mode = va_arg(rest, mode_t);                    \
    va_end(rest);                                              \
    const bool failing = is_port(path) && fails(call("open")); \
    return failing ? -1 : real(path, flags, mode);             \
  }
CARGOBAY_WRAP_OPEN(open)
CARGOBAY_WRAP_OPEN(open64)

#define CARGOBAY_WRAP_FCNTL(function)                                 \
  int function(int descriptor, int command, ...) {                    \
    CARGOBAY_NEXT(function);                                          \
    va_list rest;                                                     \
    va_start(rest, command);                                          \
    void* const argument = va_arg(rest, void*);                       \
    va_end(rest);                                                     \
    const bool failing = is_port(descriptor) && fails(call("fcntl")); \
    return failing ? -1 : real(descriptor, command, argument);        \
  }
CARGOBAY_WRAP_FCNTL(fcntl)
CARGOBAY_WRAP_FCNTL(fcntl64)

ssize_t read(int descriptor, void* bytes, size_t count) {
  CARGOBAY_NEXT(read);
  if (!is_port(descriptor) || !fails(call("read"))) return real(descriptor, bytes, count);
  if (plan.kind == Kind::short_count) return real(descriptor, bytes, std::min<size_t>(count, 1));
  return plan.kind == Kind::zero ? 0 : -1;
}

ssize_t write(int descriptor, const void* bytes, size_t count) {
  CARGOBAY_NEXT(write);
  if (!is_port(descriptor)) return real(descriptor, bytes, count);
  look_at({static_cast<const std::uint8_t*>(bytes), count});
  if (!fails(call("write"))) return real(descriptor, bytes, count);
  if (plan.kind == Kind::short_count) return real(descriptor, bytes, std::min<size_t>(count, 1));
  return plan.kind == Kind::zero ? 0 : -1;
}

int poll(pollfd* files, nfds_t count, int timeout) {
  CARGOBAY_NEXT(poll);
  int result = 0;
  return poll_fails({files, count}, result) ? result : real(files, count, timeout);
}

int ppoll(pollfd* files, nfds_t count, const timespec* timeout, const sigset_t* mask) {
  CARGOBAY_NEXT(ppoll);
  int result = 0;
  return poll_fails({files, count}, result) ? result : real(files, count, timeout, mask);
}

int ioctl(int descriptor, unsigned long request, ...) noexcept {
  CARGOBAY_NEXT(ioctl);
  va_list rest;
  va_start(rest, request);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  return is_port(descriptor) && fails(call("ioctl")) ? -1 : real(descriptor, request, argument);
}

int flock(int descriptor, int operation) noexcept {
  CARGOBAY_NEXT(flock);
  return is_port(descriptor) && fails(call("flock")) ? -1 : real(descriptor, operation);
}

int close(int descriptor) {
  CARGOBAY_NEXT(close);
  const bool failing = is_port(descriptor) && fails(call("close"));
  const int result = real(descriptor);
  if (!failing) return result;
  errno = plan.error;
  return -1;
}

int fstat(int descriptor, struct stat* file) noexcept {
  CARGOBAY_NEXT(fstat);
  return is_port(descriptor) && fails(call("fstat")) ? -1 : real(descriptor, file);
}

int dup(int descriptor) noexcept {
  CARGOBAY_NEXT(dup);
  return is_port(descriptor) && fails(call("dup")) ? -1 : real(descriptor);
}

int dup2(int descriptor, int wanted) noexcept {
  CARGOBAY_NEXT(dup2);
  return is_port(descriptor) && fails(call("dup")) ? -1 : real(descriptor, wanted);
}

int dup3(int descriptor, int wanted, int flags) noexcept {
  CARGOBAY_NEXT(dup3);
  return is_port(descriptor) && fails(call("dup")) ? -1 : real(descriptor, wanted, flags);
}

int tcgetattr(int descriptor, termios* settings) noexcept {
  CARGOBAY_NEXT(tcgetattr);
  return is_port(descriptor) && fails(call("tcgetattr")) ? -1 : real(descriptor, settings);
}

int tcsetattr(int descriptor, int when, const termios* settings) noexcept {
  CARGOBAY_NEXT(tcsetattr);
  return is_port(descriptor) && fails(call("tcsetattr")) ? -1 : real(descriptor, when, settings);
}

int tcflush(int descriptor, int queue) noexcept {
  CARGOBAY_NEXT(tcflush);
  return is_port(descriptor) && fails(call("tcflush")) ? -1 : real(descriptor, queue);
}

int tcdrain(int descriptor) {
  CARGOBAY_NEXT(tcdrain);
  return is_port(descriptor) && fails(call("tcdrain")) ? -1 : real(descriptor);
}

int isatty(int descriptor) noexcept {
  CARGOBAY_NEXT(isatty);
  return is_port(descriptor) && fails(call("isatty")) ? 0 : real(descriptor);
}

}  // extern "C"
// NOLINTEND(readability-inconsistent-declaration-parameter-name)
