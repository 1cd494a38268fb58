#include "hal/file/left_behind.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <ctime>

namespace cargobay::hal {

namespace {

// A short name in the same folder: a socket's address has little room.
std::string aside(const std::string& path) {
  std::uint32_t random = 0;
  (void)!getrandom(&random, sizeof random, GRND_NONBLOCK);  // NOREPLACE guards the name anyway
  return path.substr(0, path.rfind('/') + 1) + "." + std::to_string(random);
}

// Never overwrites another file.
bool move(const std::string& from, const std::string& to) {
  return renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0;
}

std::error_code remove_at(const std::string& path) {
  if (unlink(path.c_str()) == 0 || errno == ENOENT) return {};
  return {errno, std::generic_category()};
}

}  // namespace

std::error_code remove_if(const std::string& path,
                          const std::function<bool(const std::string&)>& removable) {
  struct stat file{};
  if (lstat(path.c_str(), &file) != 0 && errno == ENOENT) return {};
  if (!removable(path)) return std::make_error_code(std::errc::file_exists);
  const std::string moved = aside(path);
  if (!move(path, moved)) {
    if (errno == ENOENT) return {};
    // The file system cannot do it, or there is no room for the longer name.
    if (errno == EINVAL || errno == ENAMETOOLONG) return remove_at(path);
    return {errno, std::generic_category()};
  }
  if (removable(moved)) return remove_at(moved);
  (void)move(moved, path);  // fails only if a third file has taken the place; the file is not lost
  return std::make_error_code(std::errc::file_exists);
}

FolderTurn::FolderTurn(const std::string& path) {
  constexpr int kLooks = 200;
  constexpr timespec kPause{.tv_sec = 0, .tv_nsec = 5'000'000};
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  folder_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  for (int i = 0; folder_ >= 0 && i < kLooks; ++i) {
    if (flock(folder_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    nanosleep(&kPause, nullptr);
  }
}

// Closing its only descriptor releases the lock.
FolderTurn::~FolderTurn() {
  if (folder_ >= 0) close(folder_);
}

std::string link_target(const std::string& link) {
  std::array<char, 4096> target{};
  const ssize_t length = readlink(link.c_str(), target.data(), target.size());
  return length < 0 ? std::string{} : std::string{target.data(), static_cast<std::size_t>(length)};
}

std::string remedy_for(int error, std::string otherwise) {
  if (error == EMFILE || error == ENFILE) return "raise the limit of open files (ulimit -n)";
  return otherwise;
}

}  // namespace cargobay::hal
