#include "hal/file/output_name.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <optional>
#include <string_view>

namespace cargobay::hal {
namespace {

constexpr int kMostLinks = 40;  // as the kernel

OutputName refuse(const std::string& what) {
  return {.kind = OutputName::Kind::refused, .refusal = what + "; name a file of your own"};
}
OutputName fail(int error) { return {.kind = OutputName::Kind::failed, .error = error}; }

// N in /dev/fd/N and its other names.
std::optional<int> descriptor_named(std::string_view path) {
  if (path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(folder)) continue;
    path.remove_prefix(folder.size());
    int number = -1;
    const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), number);
    if (error == std::errc{} && end == path.data() + path.size()) return number;
    return std::nullopt;
  }
  return std::nullopt;
}

std::string folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "." : path.substr(0, slash + 1);
}

// What others put into a folder open to all belongs to them: this is the kernel's own rule for
// links and files there (fs.protected_symlinks, fs.protected_regular), which not every kernel
// enables.
bool belongs_to_others(const std::string& path, const struct stat& status) {
  struct stat folder{};
  if (stat(folder_of(path).c_str(), &folder) != 0) return false;
  const bool open_to_all = (folder.st_mode & S_ISVTX) != 0 && (folder.st_mode & S_IWOTH) != 0;
  return open_to_all && status.st_uid != geteuid() && status.st_uid != folder.st_uid;
}

bool takes_everything(const struct stat& status) {
  constexpr unsigned kMemory = 1;  // the kernel's numbers of /dev/null and /dev/full
  constexpr unsigned kNull = 3;
  constexpr unsigned kFull = 7;
  return S_ISCHR(status.st_mode) &&
         (status.st_rdev == makedev(kMemory, kNull) || status.st_rdev == makedev(kMemory, kFull));
}

OutputName of_a_descriptor(int number) {
  struct stat status{};
  if (fstat(number, &status) != 0) return fail(errno);
  const bool standard = number == STDOUT_FILENO || number == STDERR_FILENO;
  const bool terminal = isatty(number) == 1;
  if (terminal && !standard) return refuse("it is a port or a terminal");
  if (S_ISBLK(status.st_mode) ||
      (S_ISCHR(status.st_mode) && !terminal && !takes_everything(status)))
    return refuse("it is a device");
  return {.kind = OutputName::Kind::descriptor, .descriptor = number};
}

// By what it is; not for links.
OutputName judge(const std::string& path, const struct stat& status) {
  if (S_ISDIR(status.st_mode)) return fail(EISDIR);
  if (S_ISSOCK(status.st_mode)) return refuse("it is a socket");
  if (S_ISBLK(status.st_mode)) return refuse("it is a disk");
  if (takes_everything(status)) return {.kind = OutputName::Kind::in_place, .path = path};
  if (S_ISCHR(status.st_mode)) return refuse("it is a port, a terminal or another device");
  if (belongs_to_others(path, status))
    return refuse("it belongs to another user, in a folder that is open to all");
  if (S_ISFIFO(status.st_mode)) return {.kind = OutputName::Kind::in_place, .path = path};
  if (faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) return fail(errno);
  return {.kind = OutputName::Kind::present, .path = path};
}

}  // namespace

OutputName find_output(const std::string& path) {
  std::string at = path;
  for (int links = 0; links < kMostLinks; ++links) {
    if (const auto number = descriptor_named(at)) return of_a_descriptor(*number);
    if (at.empty()) return fail(ENOENT);
    if (at.ends_with('/')) return fail(EISDIR);
    struct stat status{};
    if (lstat(at.c_str(), &status) != 0) {
      if (errno != ENOENT) return fail(errno);
      return {.kind = OutputName::Kind::absent, .path = at};
    }
    if (!S_ISLNK(status.st_mode)) return judge(at, status);
    if (belongs_to_others(at, status))
      return refuse("it is the link of another user, in a folder that is open to all");
    std::array<char, PATH_MAX> target{};
    const ssize_t size = readlink(at.c_str(), target.data(), target.size());
    if (size < 0) return fail(errno);
    const std::string to{target.data(), static_cast<std::size_t>(size)};
    at = to.starts_with('/') ? to : folder_of(at).append(to);
  }
  return fail(ELOOP);
}

}  // namespace cargobay::hal
