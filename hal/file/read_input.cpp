#include "hal/file/read_input.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "hal/file/descriptor.hpp"

namespace cargobay::hal {
namespace {

// How long to wait for input, in milliseconds.
constexpr int kPatienceMs = 10'000;
constexpr int kForever = -1;

bool at_once() { return true; }

constexpr const char* kNameAFile = "name a file";

Failure unreadable(int error, const std::string& remedy = "name a file that can be read") {
  const std::error_code code{error, std::generic_category()};
  return {code.message() + "; " + remedy, code};
}

Failure of_the_wrong_kind(const std::string& what) {
  return {"it is " + what + "; " + kNameAFile, std::make_error_code(std::errc::invalid_argument)};
}

bool is_null(const struct stat& status) {
  constexpr unsigned kMemory = 1;  // the kernel's major number of /dev/null and its kin
  constexpr unsigned kNull = 3;
  return S_ISCHR(status.st_mode) && status.st_rdev == makedev(kMemory, kNull);
}

// Files and pipes are read, and /dev/null; other kinds are a failure that says why.
Result<void> check_kind(const struct stat& status) {
  if (S_ISREG(status.st_mode) || S_ISFIFO(status.st_mode) || is_null(status)) return {};
  if (S_ISDIR(status.st_mode)) return unreadable(EISDIR, kNameAFile);
  if (S_ISSOCK(status.st_mode)) return of_the_wrong_kind("a socket");
  return of_the_wrong_kind("a device");
}

bool something_comes(int descriptor, int patience_ms) {
  pollfd waited{.fd = descriptor, .events = POLLIN, .revents = 0};
  return poll(&waited, 1, patience_ms) > 0;
}

std::string size_text(std::size_t bytes) { return std::to_string(bytes >> 20U) + " MiB"; }

Result<std::string> read_to_the_end(int descriptor, const InputLimits& limits, int patience_ms,
                                    const std::function<bool()>& comes) {
  std::string all;
  std::array<char, 65536> chunk{};
  for (;;) {
    if (!comes())
      return Failure{"interrupted", std::make_error_code(std::errc::operation_canceled)};
    const ssize_t count = read(descriptor, chunk.data(), chunk.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) {
      if (something_comes(descriptor, patience_ms)) continue;
      return Failure{"nothing came from it for " + std::to_string(patience_ms / 1000) +
                         " s; check what writes it, or name a file",
                     std::make_error_code(std::errc::timed_out)};
    }
    if (count < 0) return unreadable(errno);
    if (count == 0) return all;
    all.append(chunk.data(), static_cast<std::size_t>(count));
    if (all.size() > limits.most_bytes) {
      return Failure{"it is longer than " + size_text(limits.most_bytes) +
                         ", and no more is read; check that it is the right one",
                     std::make_error_code(std::errc::file_too_large)};
    }
    const std::string_view beginning = limits.begins_with;
    if (all.size() >= beginning.size() && !all.starts_with(beginning)) return all;
  }
}

}  // namespace

Result<std::string> read_input(const std::string& path, const InputLimits& limits) {
  struct stat status{};
  // By name first: opening a device may do something to it. Opening a port changes its lines, and
  // with them a robot's pins.
  if (stat(path.c_str(), &status) != 0) return unreadable(errno);
  if (const auto allowed = check_kind(status); !allowed) return allowed.failure();
  const Descriptor file{open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)};
  if (file.number() < 0) return unreadable(errno);
  if (fstat(file.number(), &status) != 0) return unreadable(errno);
  if (const auto allowed = check_kind(status); !allowed) return allowed.failure();
  auto text = read_to_the_end(file.number(), limits, kPatienceMs, at_once);
  if (text && text->empty() && S_ISFIFO(status.st_mode)) {
    return Failure{"it is a pipe that nothing writes to; start its writer first, or name a file",
                   std::make_error_code(std::errc::no_message)};
  }
  return text;
}

Result<std::string> read_standard_input(const InputLimits& limits,
                                        const std::function<bool()>& comes) {
  return read_to_the_end(STDIN_FILENO, limits, kForever, comes);
}

}  // namespace cargobay::hal
