// The files that one command was told to write, besides those that it reads.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/file/output_file.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

// Opens all of them before the command does anything else, and refuses what would destroy
// something: two names of one file, a file that is read, a port (hal/file/output_file.hpp has the
// whole rule). Ignores an empty path, which is an option that was not given.
class Outputs {
 public:
  // Registers a file that none of the outputs may be; `what` is its name in messages: "the
  // configuration". "-" is standard input.
  void protect(std::string what, const std::string& path);
  // "-" is standard output. `key` is the option, as passed to write() and take().
  [[nodiscard]] hal::Result<void> open(std::string key, const std::string& path);
  // For a file that is read and then written: it may be one of the protected ones.
  [[nodiscard]] hal::Result<void> open_to_edit(std::string key, const std::string& path);

  // Writes everything or nothing; ignored if the file was not opened.
  [[nodiscard]] hal::Result<void> write(std::string_view key, std::string_view text);
  // For output that is written piece by piece. Nothing if the file was not opened.
  std::optional<hal::OutputFile> take(std::string_view key);

 private:
  enum class Use : std::uint8_t { replace, edit };
  struct Entry {
    std::string key{};
    std::string what{};
    hal::FilePlace place{};
    bool input = false;
    Use use = Use::replace;
    std::optional<hal::OutputFile> file{};  // none for standard output
  };
  hal::Result<void> open(std::string key, const std::string& path, Use use);
  const Entry* same_as(const hal::FilePlace& place, Use use) const;
  Entry* find(std::string_view key);

  std::vector<Entry> entries_{};
};

}  // namespace cargobay::cli
