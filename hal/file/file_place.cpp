#include "hal/file/file_place.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>

namespace cargobay::hal {
namespace {

FilePlace::Inode inode(const struct stat& status) { return {status.st_dev, status.st_ino}; }

void set_file(FilePlace& place, const struct stat& status) {
  constexpr unsigned kMemory = 1;  // the kernel's numbers of /dev/null
  constexpr unsigned kNull = 3;
  place.file = inode(status);
  place.discards = S_ISCHR(status.st_mode) && status.st_rdev == makedev(kMemory, kNull);
}

}  // namespace

FilePlace place_of(const std::string& path) {
  FilePlace place;
  struct stat status{};
  if (stat(path.c_str(), &status) == 0) set_file(place, status);
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  place.name = slash == std::string::npos ? path : path.substr(slash + 1);
  if (stat(folder.c_str(), &status) == 0) place.folder = inode(status);
  return place;
}

FilePlace place_of(int descriptor) {
  FilePlace place;
  struct stat status{};
  if (fstat(descriptor, &status) == 0) set_file(place, status);
  return place;
}

bool same_file(const FilePlace& a, const FilePlace& b) {
  if (a.discards || b.discards) return false;
  if (a.file && a.file == b.file) return true;
  return a.folder && a.folder == b.folder && a.name == b.name;
}

}  // namespace cargobay::hal
