// A name that only this process uses, in the folder for temporary files.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>

namespace cargobay::hal::sim::test {

inline std::string temporary_path(const std::string& name) {
  return (std::filesystem::temp_directory_path() /
          ("cargobay-" + std::to_string(getpid()) + "-" + name))
      .string();
}

}  // namespace cargobay::hal::sim::test
