#include "gpio/chip_files.hpp"

#include <grp.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>

namespace cargobay::gpio {

std::vector<std::string> chip_files() {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator{"/dev", error}) {
    const std::string name = entry.path().filename().string();
    std::error_code ignored;
    if (name.starts_with("gpiochip") &&
        entry.symlink_status(ignored).type() == std::filesystem::file_type::character)
      paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return paths;
}

std::string owning_group(const std::string& path) {
  struct stat file{};
  if (stat(path.c_str(), &file) != 0) return "";
  group entry{};
  group* found = nullptr;
  std::array<char, 4096> text{};
  if (getgrgid_r(file.st_gid, &entry, text.data(), text.size(), &found) != 0) return "";
  return found == nullptr ? "" : entry.gr_name;
}

}  // namespace cargobay::gpio
