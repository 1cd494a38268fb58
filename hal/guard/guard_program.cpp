#include "hal/guard/guard_program.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

namespace cargobay::hal {
namespace {

namespace fs = std::filesystem;

Failure cannot_run(const fs::path& path, const std::string& why) {
  return {"cannot run " + path.string() + ": " + why};
}
Failure will_not_run(const fs::path& guard, const std::string& why) {
  return {"will not run " + guard.string() + " as the guard: " + why,
          std::make_error_code(std::errc::operation_not_permitted)};
}

std::string owner_text(const fs::path& path, uid_t owner) {
  return path.string() + " belongs to user " + std::to_string(owner) +
         ", neither root nor you; install Cargobay, or build it as yourself";
}

// Objection to the file or folder itself. `owners` are those who may decide what runs.
std::optional<std::string> objection(const fs::path& path, const std::vector<uid_t>& owners) {
  struct stat file{};
  if (stat(path.c_str(), &file) != 0)
    return path.string() + ": " + std::generic_category().message(errno);
  bool trusted = false;
  for (const uid_t owner : owners) trusted = trusted || owner == file.st_uid;
  if (!trusted) return owner_text(path, file.st_uid);
  const bool sticky_folder = S_ISDIR(file.st_mode) && (file.st_mode & S_ISVTX) != 0;
  if ((file.st_mode & (S_IWGRP | S_IWOTH)) != 0 && !sticky_folder)
    return "others may write to " + path.string() + "; make it safe with: chmod go-w " +
           path.string();
  return std::nullopt;
}

// The guard's own folder must not be writable by others, sticky or not.
std::optional<std::string> objection_to_folder(const fs::path& folder) {
  struct stat file{};
  if (stat(folder.c_str(), &file) != 0 || (file.st_mode & (S_IWGRP | S_IWOTH)) == 0)
    return std::nullopt;
  return "others may write to its folder " + folder.string() +
         "; move it to one of your own, or: chmod go-w " + folder.string();
}

Result<std::string> trusted(const fs::path& named, const std::vector<uid_t>& owners) {
  std::error_code error;
  const fs::path path = fs::canonical(named, error);
  if (error) return cannot_run(named, error.message());
  if (!fs::is_regular_file(path, error)) return cannot_run(path, "not a program");
  if (access(path.c_str(), X_OK) != 0)
    return cannot_run(path, std::generic_category().message(errno));
  if (const auto why = objection(path, owners)) return will_not_run(path, *why);
  if (const auto why = objection_to_folder(path.parent_path())) return will_not_run(path, *why);
  for (fs::path folder = path.parent_path();; folder = folder.parent_path()) {
    if (const auto why = objection(folder, owners)) return will_not_run(path, *why);
    if (folder == folder.parent_path()) return path.string();
  }
}

// The file that this code was loaded from: the program or the shared library.
fs::path this_object() {
  const auto here = reinterpret_cast<std::uintptr_t>(&guard_program);
  std::ifstream maps{"/proc/self/maps"};
  for (std::string line; std::getline(maps, line);) {
    std::istringstream fields{line};
    std::uintptr_t begin = 0;
    std::uintptr_t end = 0;
    char dash = 0;
    std::string rights, offset, device, inode;
    std::string path;
    fields >> std::hex >> begin >> dash >> end >> rights >> offset >> device >> inode;
    if (here < begin || here >= end) continue;
    std::getline(fields >> std::ws, path);
    return path;
  }
  return {};
}

bool lies_in(const fs::path& path, const fs::path& folder) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// Empty if there is none.
std::string built(const fs::path& object) {
  std::error_code error;
  const fs::path tree = fs::canonical(CARGOBAY_BUILD_TREE, error);
  if (error || object.empty() || !lies_in(object, tree)) return "";
  return CARGOBAY_GUARD_BUILT;
}

// The prefix that the file was installed in, if it is in a folder of an installation.
std::optional<fs::path> prefix_of(const fs::path& object) {
  for (const fs::path folder : {CARGOBAY_LIBDIR, CARGOBAY_BINDIR}) {
    if (object.empty() || folder.is_absolute()) continue;
    fs::path prefix = object.parent_path();
    bool within = true;
    for (auto part = folder.end(); within && part != folder.begin(); prefix = prefix.parent_path())
      within = *--part == prefix.filename();
    if (within) return prefix;
  }
  return std::nullopt;
}

// That of the installation which the code belongs to, if others have no say in it.
Result<std::string> installed(const fs::path& object, const std::vector<uid_t>& owners) {
  const auto prefix = prefix_of(object);
  auto own =
      trusted(prefix ? *prefix / CARGOBAY_GUARD_IN_PREFIX : CARGOBAY_GUARD_INSTALLED, owners);
  if (own) return own;
  auto configured = trusted(CARGOBAY_GUARD_INSTALLED, owners);
  if (configured) return configured;
  // The one that is there, but may not be run, is the one to mend.
  return own.failure().code == std::errc::operation_not_permitted ? own : configured;
}

}  // namespace

Result<std::string> guard_program(const std::string& wanted) {
  std::vector<uid_t> owners{0, geteuid()};
  if (!wanted.empty()) return trusted(wanted, owners);
  // NOLINTNEXTLINE(concurrency-mt-unsafe): of those that only read
  const char* const named = secure_getenv("CARGOBAY_GUARD");
  if (named != nullptr && *named != '\0') return trusted(named, owners);
  const fs::path object = this_object();
  if (const std::string path = built(object); !path.empty()) {
    struct stat file{};
    if (stat(object.c_str(), &file) == 0) owners.push_back(file.st_uid);
    return trusted(path, owners);
  }
  auto found = installed(object, owners);
  if (found) return found;
  return Failure{found.failure().message +
                     "; install it, or name it in CARGOBAY_GUARD (which a program with the rights "
                     "of another user ignores)",
                 found.failure().code};
}

}  // namespace cargobay::hal
