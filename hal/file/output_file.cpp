#include "hal/file/output_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <cstdio>
#include <system_error>

#include "hal/file/output_name.hpp"
#include "hal/file/quiet_signals.hpp"

namespace cargobay::hal {
namespace {

constexpr mode_t kRights = 0666;  // less the umask

// An unpredictable name: nothing waits under it.
std::string random_name(const std::string& beginning) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz012345";
  std::array<std::uint8_t, 12> random{};
  (void)!getrandom(random.data(), random.size(), 0);  // this few bytes always come whole
  std::string name = beginning;
  for (const std::uint8_t byte : random) name += kLetters[byte % kLetters.size()];
  return name;
}

}  // namespace

Failure OutputFile::cannot_write(int error) const {
  const std::error_code code{error, std::generic_category()};
  std::string remedy = "name a file in a folder that exists and that you may write to";
  if (error == ENXIO) remedy = "it is a pipe that nothing reads; start its reader first";
  if (error == ENOSPC || error == EDQUOT) remedy = "make room on the disk, or name another place";
  if (error == EFBIG) remedy = "raise the file size limit (ulimit -f)";
  if (error == EPIPE || error == ETIMEDOUT) remedy = "check what reads the pipe";
  return {"cannot write " + path_ + ": " + code.message() + "; " + remedy, code};
}

Result<OutputFile> OutputFile::open(const std::string& path) {
  OutputFile output{path};
  const OutputName name = find_output(path);
  Result<void> opened;
  switch (name.kind) {
    case OutputName::Kind::refused: return Failure{"cannot write " + path + ": " + name.refusal};
    case OutputName::Kind::failed: return output.cannot_write(name.error);
    case OutputName::Kind::descriptor: opened = output.open_descriptor(name.descriptor); break;
    case OutputName::Kind::in_place: opened = output.open_in_place(name.path); break;
    case OutputName::Kind::present: output.replaces_ = true; [[fallthrough]];
    case OutputName::Kind::absent: opened = output.open_temporary(name.path); break;
  }
  if (!opened) return opened.failure();
  return output;
}

OutputFile::~OutputFile() {
  if (!temporary_.empty()) unlinkat(folder_.number(), temporary_.c_str(), 0);
}

Result<void> OutputFile::open_descriptor(int named) {
  file_ = Descriptor{fcntl(named, F_DUPFD_CLOEXEC, STDERR_FILENO + 1)};
  if (file_.number() < 0) return cannot_write(errno);
  if ((fcntl(named, F_GETFL) & O_ACCMODE) == O_RDONLY) return cannot_write(EBADF);
  place_ = place_of(named);
  return {};
}

Result<void> OutputFile::open_in_place(const std::string& name) {
  constexpr int kFlags = O_WRONLY | O_NONBLOCK | O_NOCTTY | O_NOFOLLOW | O_CLOEXEC;
  file_ = Descriptor{::open(name.c_str(), kFlags)};
  if (file_.number() < 0) return cannot_write(errno);
  struct stat status{};
  // It may have been replaced since it was looked at.
  const bool as_before = fstat(file_.number(), &status) == 0 &&
                         (S_ISFIFO(status.st_mode) || S_ISCHR(status.st_mode)) &&
                         isatty(file_.number()) == 0;
  if (!as_before) return cannot_write(EAGAIN);
  place_ = place_of(file_.number());
  return {};
}

Result<void> OutputFile::open_temporary(const std::string& name) {
  const std::size_t slash = name.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : name.substr(0, slash + 1);
  name_ = slash == std::string::npos ? name : name.substr(slash + 1);
  place_ = place_of(name);
  folder_ = Descriptor{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (folder_.number() < 0) return cannot_write(errno);
  // Without a name, the file cannot be found before it is whole, nor left behind by a crash. It
  // gets a name through /proc.
  if (access("/proc/self/fd", X_OK) == 0)
    file_ = Descriptor{openat(folder_.number(), ".", O_TMPFILE | O_WRONLY | O_CLOEXEC, kRights)};
  if (file_.number() < 0) {  // not every file system supports that
    temporary_ = random_name(".cargobay-");
    constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
    file_ = Descriptor{openat(folder_.number(), temporary_.c_str(), kFlags, kRights)};
  }
  if (file_.number() < 0) {
    const int error = errno;
    temporary_.clear();
    return cannot_write(error);
  }
  if (replaces_) keep_rights_of(name);
  return {};
}

void OutputFile::keep_rights_of(const std::string& name) const {
  struct stat old{};
  if (lstat(name.c_str(), &old) != 0) return;
  constexpr mode_t kAll = 0777;
  constexpr mode_t kGroup = 070;
  const bool same_group =
      fchown(file_.number(), old.st_uid, old.st_gid) == 0 || old.st_gid == getegid();
  // Cannot fail for a file of one's own; if it does, the file has the umask's rights.
  (void)!fchmod(file_.number(), old.st_mode & (same_group ? kAll : kAll & ~kGroup));
}

Result<void> OutputFile::write(std::string_view bytes, std::optional<rt::Duration> patience) {
  constexpr rt::Duration kLongest = std::chrono::hours{24};
  const bool in_place = folder_.number() < 0;
  const timespec limit = rt::as_timespec(patience.value_or(kLongest));
  const QuietSignals quiet;
  while (!bytes.empty()) {
    std::size_t most = bytes.size();
    if (in_place) {
      // This many never block on a pipe that can be written at all.
      most = std::min<std::size_t>(most, PIPE_BUF);
      pollfd waited{.fd = file_.number(), .events = POLLOUT, .revents = 0};
      if (ppoll(&waited, 1, &limit, nullptr) == 0) return cannot_write(ETIMEDOUT);
    }
    const ssize_t count = ::write(file_.number(), bytes.data(), most);
    if (count > 0) bytes.remove_prefix(static_cast<std::size_t>(count));
    if (count < 0 && errno != EINTR && errno != EAGAIN) return cannot_write(errno);
  }
  return {};
}

Result<void> OutputFile::publish() {
  if (published_ || folder_.number() < 0) return {};
  published_ = true;
  if (move_into_place()) return {};
  const int error = errno;
  if (error != EEXIST) return cannot_write(error);
  const std::string aside = random_name(name_ + ".");
  if (!link_as(aside)) return cannot_write(errno);
  return Failure{"cannot write " + path_ + ": another file has appeared there; this one is in " +
                     path_.substr(0, path_.rfind('/') + 1) + aside,
                 {EEXIST, std::generic_category()}};
}

// Never replaces anything. On failure, errno is set.
bool OutputFile::link_as(const std::string& name) const {
  if (!temporary_.empty())
    return linkat(folder_.number(), temporary_.c_str(), folder_.number(), name.c_str(), 0) == 0;
  const std::string nameless = "/proc/self/fd/" + std::to_string(file_.number());
  return linkat(AT_FDCWD, nameless.c_str(), folder_.number(), name.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

bool OutputFile::move_into_place() {
  const int folder = folder_.number();
  if (!replaces_ && link_as(name_)) return true;  // the destructor removes the other name
  // A file system without links: FAT.
  const bool no_links = errno == EPERM || errno == EOPNOTSUPP;
  if (!replaces_ && !(no_links && !temporary_.empty())) return false;
  if (temporary_.empty()) {
    const std::string name = random_name(".cargobay-");
    if (!link_as(name)) return false;
    temporary_ = name;
  }
  const unsigned flags = replaces_ ? 0U : RENAME_NOREPLACE;
  if (renameat2(folder, temporary_.c_str(), folder, name_.c_str(), flags) != 0) return false;
  temporary_.clear();
  return true;
}

void OutputFile::sync() const { (void)fsync(file_.number()); }

}  // namespace cargobay::hal
