#include "hal/feed/feed_place.hpp"

#include <dirent.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "hal/file/unix_listener.hpp"

namespace cargobay::hal {

namespace {

constexpr mode_t kOwnersAlone = S_IRWXU;
// Of the service; those of others, one for each of several robots, have a name after it. Only root
// can have made them.
constexpr const char* kFolderOfService = "/run/cargobay";
constexpr const char* kFolderOfServices = "/run";

std::optional<std::string> environment(const char* name) {
  const char* const value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): only read
  if (value == nullptr || *value == '\0') return std::nullopt;
  return value;
}

// The first of those that systemd made. It puts colons between them, and a backslash before each
// colon and backslash in their names.
std::optional<std::string> folder_of_this_service() {
  const auto folders = environment("RUNTIME_DIRECTORY");
  if (!folders) return std::nullopt;
  std::string first;
  for (std::size_t i = 0; i < folders->size() && (*folders)[i] != ':'; ++i) {
    if ((*folders)[i] == '\\' && i + 1 < folders->size()) ++i;
    first += (*folders)[i];
  }
  return first;
}

std::string folder_in_tmp(uid_t user) { return "/tmp/cargobay-" + std::to_string(user); }

// Of this user or root, and no other may write to it.
bool is_trustworthy(const std::string& folder) {
  struct stat status{};
  if (lstat(folder.c_str(), &status) != 0) return false;
  return S_ISDIR(status.st_mode) && (status.st_uid == geteuid() || status.st_uid == 0) &&
         (status.st_mode & S_IWOTH) == 0;
}

bool can_write(const std::string& folder) {
  return is_trustworthy(folder) && access(folder.c_str(), W_OK | X_OK) == 0;
}

// In the order of preference; made by whoever publishes there.
std::vector<std::string> own_folders() {
  std::vector<std::string> folders;
  if (auto named = environment("CARGOBAY_FEED_DIR")) return {*named};
  if (auto of_service = folder_of_this_service()) folders.push_back(std::move(*of_service));
  if (auto of_user = environment("XDG_RUNTIME_DIR")) folders.push_back(*of_user + "/cargobay");
  if (geteuid() == 0) folders.emplace_back(kFolderOfService);
  folders.push_back(folder_in_tmp(geteuid()));
  return folders;
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  const std::unique_ptr<DIR, int (*)(DIR*)> listing{opendir(folder.c_str()), closedir};
  if (!listing) return names;
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the listing is this thread's own
  while (const dirent* entry = readdir(listing.get())) {
    if (entry->d_name[0] != '.') names.emplace_back(entry->d_name);
  }
  std::ranges::sort(names);
  return names;
}

// "/run/cargobay", "/run/cargobay-ttyUSB0".
bool is_of_service(const std::string& folder) {
  const std::string first = kFolderOfService;
  return folder == first ||
         (folder.starts_with(first + "-") && folder.find('/', first.size()) == std::string::npos);
}

std::vector<std::string> folders_of_services() {
  std::vector<std::string> folders;
  for (const std::string& name : names_in(kFolderOfServices)) {
    std::string folder = std::string{kFolderOfServices} + "/" + name;
    if (is_of_service(folder)) folders.push_back(std::move(folder));
  }
  return folders;
}

std::vector<std::string> folders_to_search() {
  std::vector<std::string> folders = own_folders();
  if (environment("CARGOBAY_FEED_DIR")) return folders;
  std::vector<std::string> others = folders_of_services();
  others.push_back(folder_in_tmp(0));
  for (const std::string& other : others) {
    if (std::ranges::find(folders, other) == folders.end()) folders.push_back(other);
  }
  return folders;
}

}  // namespace

std::string lasting_name(const std::string& port) {
  std::error_code error;
  const bool is_path = port.find('/') != std::string::npos || std::filesystem::exists(port, error);
  if (!is_path) return port;
  // Of a descriptor's path only this process knows the file.
  const bool of_this_process = port.starts_with("/proc/");
  const std::filesystem::path path = of_this_process ? std::filesystem::canonical(port, error)
                                                     : std::filesystem::absolute(port, error);
  return error ? port : path.lexically_normal().string();
}

std::string feed_name(const std::string& port) {
  std::string name = lasting_name(port);
  if (name.starts_with('/')) name.erase(0, 1);
  std::ranges::replace(name, '/', '-');
  return name;
}

Result<std::string> feed_folder() {
  for (const std::string& folder : own_folders()) {
    if (mkdir(folder.c_str(), kOwnersAlone) != 0 && errno != EEXIST) continue;
    if (can_write(folder)) return folder;
  }
  return Failure{.message = "no folder for the feed: " + own_folders().back() +
                            " is not this user's, or others may write to it; remove it, or name "
                            "a folder in CARGOBAY_FEED_DIR",
                 .code = std::make_error_code(std::errc::permission_denied)};
}

void leave_folder(const std::string& folder) {
  // These are there for more than one feed.
  if (environment("CARGOBAY_FEED_DIR") == folder) return;
  if (folder_of_this_service() == folder) return;
  (void)rmdir(folder.c_str());  // unless others publish there too
}

bool is_trusted_peer(int socket, const std::string& path) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return false;
  if (peer.uid == geteuid() || peer.uid == 0) return true;
  const std::string folder = path.substr(0, path.rfind('/'));
  struct stat status{};
  return is_of_service(folder) && lstat(folder.c_str(), &status) == 0 && S_ISDIR(status.st_mode) &&
         (status.st_mode & (S_IWGRP | S_IWOTH)) == 0 && peer.uid == status.st_uid;
}

std::vector<FoundFeed> find_feeds() {
  std::vector<FoundFeed> feeds;
  for (const std::string& folder : folders_to_search()) {
    if (!is_trustworthy(folder) && !is_of_service(folder)) continue;
    for (const std::string& name : names_in(folder)) {
      std::string path = folder;
      (path += '/') += name;
      struct stat status{};
      if (lstat(path.c_str(), &status) != 0 || !S_ISSOCK(status.st_mode)) continue;
      const Descriptor socket = connect_to(path);
      if (socket.number() >= 0) feeds.push_back({.name = name, .socket = path});
    }
  }
  return feeds;
}

}  // namespace cargobay::hal
