#include "hal/cli/write_file.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <system_error>

#include <fmt/core.h>

namespace cargobay::cli {
namespace {

hal::Failure cannot_write(const std::string& path, int error) {
  const std::error_code code{error, std::generic_category()};
  return {fmt::format("cannot write {}: {}; name a file in a folder that exists and that you may "
                      "write to",
                      path, code.message()),
          code};
}

// A device or pipe is written in place; a temporary file beside /dev/null makes no sense.
bool is_special(const std::string& path) {
  struct stat status{};
  return stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode);
}

std::optional<hal::Failure> write_in_place(const std::string& path, const std::string& text) {
  std::ofstream file{path, std::ios::binary};
  file << text;
  file.close();
  if (!file) return cannot_write(path, errno);
  return std::nullopt;
}

}  // namespace

std::optional<hal::Failure> write_file(const std::string& path, const std::string& text) {
  if (path == "-") {
    fmt::print("{}", text);
    return std::nullopt;
  }
  if (is_special(path)) return write_in_place(path, text);
  const std::string temporary = path + ".part";
  int error = 0;
  if (const auto failure = write_in_place(temporary, text)) {
    error = failure->code.value();
  } else if (std::rename(temporary.c_str(), path.c_str()) != 0) {
    error = errno;
  } else {
    return std::nullopt;
  }
  (void)std::remove(temporary.c_str());  // may not even be there
  return cannot_write(path, error);
}

std::optional<hal::Failure> check_writable(const std::string& path) {
  if (path == "-" || is_special(path)) {
    struct stat status{};
    if (path != "-" && stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode))
      return cannot_write(path, EISDIR);
    return std::nullopt;
  }
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : path.substr(0, slash + 1);
  if (access(folder.c_str(), W_OK) != 0) return cannot_write(path, errno);
  return std::nullopt;
}

}  // namespace cargobay::cli
